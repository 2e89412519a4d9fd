#include "accel/accel.h"

#include "accel/structures.h"

namespace raio {

std::expected<std::unique_ptr<Accel>, std::string> build_accel(const Scene& scene,
                                                               const AccelOptions& options,
                                                               bool one_sided) {
  Geometry geometry(scene, one_sided);
  switch (options.kind) {
    case AccelKind::none:
      return make_none(std::move(geometry), options);
    case AccelKind::grid:
      return make_grid(std::move(geometry), options);
    case AccelKind::embree:
      return make_embree(std::move(geometry), options);
    case AccelKind::automatic:
    case AccelKind::bvh:
      break;
  }
  return make_bvh(std::move(geometry));
}

}  // namespace raio
