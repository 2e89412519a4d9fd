// Constructors of the structures, for build_accel and for tests of single ones.
#pragma once

#include "accel/accel.h"

namespace raio::core {

using AccelResult = std::expected<std::unique_ptr<Accel>, std::string>;

/// No structure: every ray is tested with every primitive. The oracle of the others.
std::unique_ptr<Accel> make_none(Geometry geometry, const AccelOptions& options);

/// The uniform grid.
AccelResult make_grid(Geometry geometry, const AccelOptions& options);

/// The eight-wide tree of boxes: bvh.h.
AccelResult make_bvh(Geometry geometry);

/// Embree 3, used as its documentation advises. It never counts.
AccelResult make_embree(Geometry geometry, const AccelOptions& options);

/// build_accel() for the scene itself or an object of it, which must both outlive the result.
/// Throws Stopped.
std::expected<std::unique_ptr<Accel>, Error> build_object(const Scene& scene, const Object& object,
                                                          const AccelOptions& options,
                                                          bool one_sided, bool with_sources,
                                                          const Accel* like);

/// The progress of a build counts each primitive this often (add_work()): when it is assigned to a
/// leaf or a cell, and when its block is filled.
inline constexpr uint64_t kBuildPasses = 2;

}  // namespace raio::core
