#include "accel/accel.h"

#include <fmt/core.h>

#include "accel/instances.h"
#include "accel/structures.h"
#include "base/executor.h"

namespace raio::core {
namespace {

AccelResult make_accel(Geometry&& geometry, const AccelOptions& options) {
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

// Includes the primitives of its objects, once each.
uint64_t primitives_to_build(const Object& scene) {
  uint64_t count = 0;
  for_each_pool([&](auto pool) { count += (scene.*pool.shapes).size(); });
  for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
  for (const Object& object : scene.prototypes) count += primitives_to_build(object);
  return count;
}

}  // namespace

void Accel::closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const {
  find_closest(rays, hits, context);
  std::fill_n(hits.instance.begin(), rays.size(), 0);
  if (instances_) instances_->closest(rays, hits, context);
}

void Accel::occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const {
  find_any(rays, hit, context);
  if (instances_) instances_->occluded(rays, hit, context);
}

std::optional<std::string> Accel::add_instances(std::unique_ptr<const Instances> instances) {
  instances_ = std::move(instances);
  return geometry_.add_objects(instances_->objects());
}

std::unique_ptr<Accel> Accel::shared_with(Geometry& geometry) const {
  auto accel = share(geometry);
  if (accel) accel->transparent_ = transparent_;
  return accel;
}

const Accel* Accel::prototype(size_t number) const {
  return instances_ ? instances_->object(number) : nullptr;
}

AccelInfo Accel::info() const {
  AccelInfo info = describe();
  if (instances_) instances_->add_to(info);
  return info;
}

std::optional<TraceLog> Accel::log(const Ray&, bool) const { return std::nullopt; }

void Accel::boxes(int, const std::function<void(const AccelBox&)>&) const {}

std::expected<std::unique_ptr<Accel>, Error> build_object(const Scene& scene, const Object& object,
                                                          const AccelOptions& options,
                                                          bool one_sided, bool with_sources,
                                                          const Accel* like) {
  if (options.kind == AccelKind::embree && options.counters)
    return std::unexpected(
        bad_option("counters", "Embree does not count tests and steps; leave it out"));
  const double bytes = Geometry::bytes_to_bake(scene, object);
  if (const AvailableMemory available = available_memory(); bytes > 0.9 * double(available.bytes))
    return std::unexpected(
        Error{ErrorKind::no_resource, "",
              fmt::format("preparing the scene for tracing would take {:.1f} GB and {}",
                          bytes * 1e-9, available.text())});
  Geometry geometry(scene, object, one_sided, with_sources, options.opacity);
  AccelResult accel;
  if (like && geometry.traces_like(like->geometry())) accel = like->shared_with(geometry);
  if (!*accel) {
    accel = make_accel(std::move(geometry), options);
    if (!accel) return std::unexpected(Error{ErrorKind::no_resource, "", std::move(accel.error())});
    if (options.kind != AccelKind::none)
      if (auto error = (*accel)->build_transparent())
        return std::unexpected(Error{ErrorKind::no_resource, "", std::move(*error)});
  }
  if (!object.instances.empty()) {
    auto instances = Instances::build(**accel, options, one_sided, with_sources, like);
    if (!instances) return std::unexpected(std::move(instances.error()));
    if (auto error = (*accel)->add_instances(std::move(*instances)))
      return std::unexpected(Error{ErrorKind::no_resource, "", std::move(*error)});
  }
  return std::move(*accel);
}

std::expected<std::unique_ptr<Accel>, Error> build_accel(const Scene& scene,
                                                         const AccelOptions& options,
                                                         bool one_sided, bool with_sources,
                                                         const Accel* like) try {
  begin_stage(Stage::building, kBuildPasses * primitives_to_build(scene));
  check_stop();
  return build_object(scene, scene, options, one_sided, with_sources, like);
} catch (const Stopped&) {
  return std::unexpected(stopped_error());
}

}  // namespace raio::core
