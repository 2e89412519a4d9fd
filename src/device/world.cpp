#include "device/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <utility>

#include "base/box.h"
#include "base/exact_math.h"

namespace raio::device {

namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr double kPi = std::numbers::pi;
using core::Vec3d;

// Three rows of four numbers, from ANARI's columns.
using Rows = std::array<float, 12>;
constexpr Rows kInPlace = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

Rows rows_of(const std::byte* columns) {
  std::array<float, 16> m;
  std::memcpy(m.data(), columns, sizeof m);
  Rows out;
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 4; ++column) out[4 * row + column] = m[4 * column + row];
  return out;
}

Vec3d placed(const Rows& m, const Vec3d& v, bool is_point) {
  const auto row = [&](size_t r) {
    const float* const x = &m[4 * r];
    return dot(Vec3d(x[0], x[1], x[2]), v) + (is_point ? double(x[3]) : 0);
  };
  return {row(0), row(1), row(2)};
}

// The placements of an instance.
std::vector<Rows> placements(const Object& instance) {
  const Value* const value = instance.find("transform");
  if (!value) return {kInPlace};
  if (!value->object) return {rows_of(value->bytes.data())};
  const auto& array = dynamic_cast<const Array&>(*value->object);
  std::vector<Rows> all;
  all.reserve(array.count());
  for (uint64_t i = 0; i < array.count(); ++i) all.push_back(rows_of(array.at(i)));
  return all;
}

uint32_t instance_id(const Object& instance, uint64_t place) {
  if (const auto ids = instance.object<Array>("id"))
    return place < ids->count() ? uint32_t(ids->vector(place)[0]) : kNone;
  return instance.get("id", kNone);
}

std::vector<std::shared_ptr<Object>> members(const Object& object, std::string_view name) {
  std::vector<std::shared_ptr<Object>> out;
  const auto array = object.object<Array>(name);
  for (uint64_t i = 0; array && i < array->count(); ++i)
    if (const auto& member = array->objects()[array->first() + i]) out.push_back(member);
  return out;
}

bool has_own_attributes(const Object& instance) {
  for (const char* name : {"color", "attribute0", "attribute1", "attribute2", "attribute3"})
    if (instance.find(name)) return true;
  return false;
}

class Translation {
 public:
  Translation(const Object& world, ShownWorld& shown) : world_(world), shown_(shown) {
    shown.scene.set_figure(true);
    for (const auto& instance : members(world, "instance"))
      if (const auto group = instance->object("group")) ++uses_[group.get()];
  }

  void run() {
    add_contents(world_, nullptr, shown_.scene, shown_.own);
    add_lights(world_, kInPlace);
    for (const auto& instance : members(world_, "instance")) add_instance(*instance);
    number_meshes(shown_.own);
  }

 private:
  static void add_contents(const Object& group, const Object* instance, Scene& scene, Part& part) {
    for (const auto& surface : members(group, "surface"))
      add_surface(*surface, instance, surface->get("id", kNone), scene, part);
    if (!members(group, "volume").empty()) group.warn("volumes are not supported and left out");
  }

  void add_instance(const Object& instance) {
    const auto group = instance.object("group");
    if (!group) return instance.warn("an instance has no 'group' and is left out");
    const std::vector<Rows> places = placements(instance);
    for (const Rows& place : places) add_lights(*group, place);
    // Rays reach primitives outside of instances faster.
    if (places == std::vector{kInPlace} && uses_[group.get()] == 1) {
      const size_t before = shown_.own.ranges.size();
      add_contents(*group, &instance, shown_.scene, shown_.own);
      for (size_t i = before; i < shown_.own.ranges.size(); ++i)
        shown_.own.ranges[i].instance_id = instance_id(instance, 0);
      return;
    }
    const auto key = std::pair(group.get(), has_own_attributes(instance) ? &instance : nullptr);
    auto found = prototypes_.find(key);
    if (found == prototypes_.end()) {
      Scene scene;
      Part part;
      add_contents(*group, &instance, scene, part);
      number_meshes(part);
      found = prototypes_.emplace(key, kNone).first;
      if (scene.primitive_count() > 0) {
        found->second = shown_.scene.add_prototype(scene);
        shown_.parts.push_back(std::move(part));
      }
    }
    if (found->second == kNone) return;
    for (size_t i = 0; i < places.size(); ++i) {
      try {
        shown_.scene.add_instances(found->second, {places[i].data(), 1});
        shown_.instances.push_back({found->second, instance_id(instance, i)});
      } catch (const Error& error) {
        world_.device.report(&instance, Severity::error, Status::invalid_argument,
                             fmt::format("{}; it is left out", error.what()));
      }
    }
  }

  void add_lights(const Object& group, const Rows& place) {
    for (const auto& light : members(group, "light"))
      if (light->info) add_light(*light, place);
  }

  void add_light(const Object& object, const Rows& place) {
    const std::string& kind = object.subtype;
    Vec3d color = object.vec3("color", {1, 1, 1});
    const auto scaled = [&](double by) { color = max(color * by, Vec3d()); };
    const auto number = [&](const char* name, double otherwise) {
      return double(object.get(name, float(otherwise)));
    };
    if (kind == "hdri") return add_environment(object, place, color);
    Light light;
    light.position = triple(placed(place, object.vec3("position", {0, 0, 0}), true));
    light.direction = triple(placed(place, object.vec3("direction", {0, 0, -1}), false));
    light.opening = std::clamp(number("openingAngle", kPi) * 180 / kPi, 0.0, 360.0);
    light.falloff = std::clamp(number("falloffAngle", 0.1) * 180 / kPi, 0.0, light.opening / 2);
    const bool has_power = object.find("power") != nullptr,
               has_radiance = object.find("radiance") != nullptr;
    const double radius = std::abs(number("radius", 0));
    if (object.find("visible") && object.is_on("visible", true) && kind != "directional")
      object.warn("eye rays do not see lights");
    if (kind == "directional") {
      light.kind = Light::Kind::directional;
      light.angular_diameter = std::clamp(number("angularDiameter", 0) * 180 / kPi, 0.0, 170.0);
      const double half = number("angularDiameter", 0) / 2;
      scaled(has_radiance && half > 0
                 ? number("radiance", 0) * kPi * core::exact_sin(half) * core::exact_sin(half)
                 : number("irradiance", 1));
    } else if (kind == "point") {
      // All of a sphere's light, from its centre.
      if (radius > 0) object.warn("the size of a point light is ignored: its shadows are sharp");
      scaled(has_radiance ? number("radiance", 0) * kPi * radius * radius
             : has_power  ? number("power", 0) / (4 * kPi)
                          : number("intensity", 1));
    } else if (kind == "spot") {
      light.kind = Light::Kind::spot;
      const double solid = 2 * kPi * (1 - core::exact_cos(number("openingAngle", kPi) / 2));
      scaled(has_power ? number("power", 0) / std::max(solid, 1e-9) : number("intensity", 1));
    } else if (kind == "quad") {
      light.kind = Light::Kind::quad;
      const Vec3d u = placed(place, object.vec3("edge1", {1, 0, 0}), false);
      const Vec3d v = placed(place, object.vec3("edge2", {0, 1, 0}), false);
      const double area = length(cross(u, v));
      light.edge1 = triple(u), light.edge2 = triple(v);
      const std::string_view side = object.word("side");
      light.front = side != "back", light.back = side != "front";
      if (!(area > 0)) return object.warn("a quad light has no area and is left out");
      const double sides = side == "both" ? 2 : 1;
      scaled(has_radiance ? number("radiance", 0)
             : has_power  ? number("power", 0) / (kPi * area * sides)
                          : number("intensity", 1) / area);
    } else {
      light.kind = Light::Kind::ring;
      light.radius = radius, light.inner_radius = std::abs(number("innerRadius", 0));
      const double area =
          kPi * (light.radius * light.radius - light.inner_radius * light.inner_radius);
      if (radius > 0 && !(area > 0)) return object.warn("a ring light has no area and is left out");
      if (radius > 0)
        scaled(has_radiance ? number("radiance", 0)
               : has_power  ? number("power", 0) / (kPi * area)
                            : number("intensity", 1) / area);
      else
        scaled(has_power ? number("power", 0) / kPi : number("intensity", 1));
    }
    light.color = triple(color);
    try {
      shown_.scene.add_light(light);
      shown_.has_lights = true;
    } catch (const Error& error) {
      world_.device.report(&object, Severity::error, Status::invalid_argument,
                           fmt::format("{}; the light is left out", error.what()));
    }
  }

  void add_environment(const Object& object, const Rows& place, const Vec3d& color) {
    const auto image = object.object<Array>("radiance");
    if (!image || image->count() == 0)
      return object.warn("an hdri light has no 'radiance' and is left out");
    if (shown_.has_environment) return object.warn("only the first hdri light counts");
    const double scale = double(object.get("scale", 1.0f));
    std::vector<float> pixels;
    // ANARI's first row is the lowest.
    for (uint64_t y = image->size[1]; y-- > 0;)
      for (uint64_t x = 0; x < image->size[0]; ++x) {
        const auto v = image->vector(y * image->size[0] + x);
        for (size_t k = 0; k < 3; ++k)
          pixels.push_back(float(std::max(v[k] * color[int(k)] * scale, 0.0)));
      }
    try {
      shown_.scene.set_environment(
          uint32_t(image->size[0]), uint32_t(image->size[1]), pixels.data(),
          triple(placed(place, object.vec3("up", {0, 0, 1}), false)),
          triple(placed(place, object.vec3("direction", {1, 0, 0}), false)),
          object.is_on("visible", true));
      shown_.has_environment = true, shown_.environment_visible = object.is_on("visible", true);
    } catch (const Error& error) {
      world_.device.report(&object, Severity::error, Status::invalid_argument,
                           fmt::format("{}; the light is left out", error.what()));
    }
  }

  const Object& world_;
  ShownWorld& shown_;
  std::map<const Object*, int> uses_;  // of groups
  std::map<std::pair<const Object*, const Object*>, uint32_t> prototypes_;
};

}  // namespace

const Accel& ShownWorld::accel(const Settings& settings) {
  const std::lock_guard lock(mutex_);
  if (!accel_) {
    const auto old = std::exchange(before, nullptr);
    accel_.emplace(scene, settings, old && old->accel_ ? &*old->accel_ : nullptr);
  }
  return *accel_;
}

std::array<uint32_t, 3> ShownWorld::numbers_of(Kind kind, int64_t index, int64_t instance) const {
  if (index < 0) return {kNone, kNone, kNone};
  const Part& part = instance < 0 ? own : parts[instances[size_t(instance)].part];
  const Range* const range = part.find(kind, uint32_t(index));
  if (!range) return {kNone, kNone, kNone};
  const auto i = uint32_t(index) - range->first;
  return {range->object_id, range->primitives.empty() ? i : range->primitives[i],
          instance < 0 ? range->instance_id : instances[size_t(instance)].instance_id};
}

std::shared_ptr<ShownWorld> World::shown() {
  const uint64_t now = stamp();
  if (shown_ && shown_->stamp == now) return shown_;
  auto next = std::make_shared<ShownWorld>();
  next->stamp = now;
  Translation(*this, *next).run();
  next->before = std::exchange(shown_, next);
  if (next->before) next->before->before = nullptr;
  return next;
}

namespace {

// The box of an object's surfaces and, in a world, of its instances: boxes around boxes, as other
// devices have them, since applications place cameras by them.
core::Box3d box_of(const Object& object) {
  core::Box3d box;
  if (object.type == DataType::instance) {
    const auto group = object.object("group");
    const core::Box3d inner = group ? box_of(*group) : core::Box3d();
    for (const Rows& place : placements(object))
      for (int corner = 0; corner < 8 && !inner.empty(); ++corner) {
        const auto side = [&](int axis) {
          return corner >> axis & 1 ? inner.hi[axis] : inner.lo[axis];
        };
        box.extend(placed(place, {side(0), side(1), side(2)}, true));
      }
    return box;
  }
  Scene scene;
  Part part;
  for (const auto& surface : members(object, "surface"))
    add_surface(*surface, nullptr, kNone, scene, part, true);
  if (const auto own = scene.bounds())
    for (const Triple& corner : *own) box.extend(Vec3d(corner[0], corner[1], corner[2]));
  for (const auto& instance : members(object, "instance")) box.extend(box_of(*instance));
  return box;
}

}  // namespace

std::optional<std::array<float, 6>> bounds_of(const Object& object) {
  const core::Box3d box = box_of(object);
  if (box.empty()) return std::nullopt;
  const core::Box3f out = core::rounded_out(box);
  return std::array{out.lo.x, out.lo.y, out.lo.z, out.hi.x, out.hi.y, out.hi.z};
}

}  // namespace raio::device
