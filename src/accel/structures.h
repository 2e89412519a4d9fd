// The makers of each structure, for build_accel and for tests of one of them. Each stands in a file
// of its own with its walk.
#pragma once

#include "accel/accel.h"

namespace raio {

using AccelResult = std::expected<std::unique_ptr<Accel>, std::string>;

/// No structure: every ray against every primitive. The oracle of all others.
std::unique_ptr<Accel> make_none(Geometry geometry, const AccelOptions& options);

/// The uniform grid.
AccelResult make_grid(Geometry geometry, const AccelOptions& options);

/// The eight-wide tree of boxes: bvh.h.
AccelResult make_bvh(Geometry geometry);

/// Embree 3, as its documentation advises. It does not count, whatever the options say.
AccelResult make_embree(Geometry geometry, const AccelOptions& options);

}  // namespace raio
