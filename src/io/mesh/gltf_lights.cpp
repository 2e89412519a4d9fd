#include "io/mesh/gltf_lights.h"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <numbers>

#include "io/points.h"

namespace raio::core::gltf {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
// In the order of LightKind.
constexpr std::array<std::string_view, 3> kTypes = {"point", "directional", "spot"};

// The angles of the cone are from its axis.
void take_cone(const Value& spot, PhysicalLight& light) {
  const auto angle = [&](const char* key, double usual) {
    const auto value = spot.find(key);
    return value ? value->number(0, std::numbers::pi / 2 + 1e-6) : usual;
  };
  const double outer =
      std::min(angle("outerConeAngle", std::numbers::pi / 4), std::numbers::pi / 2);
  const double inner = angle("innerConeAngle", 0);
  light.opening = float(2 * outer * kDegrees);
  light.falloff = float(std::max(outer - inner, 0.0) * kDegrees);
}

}  // namespace

Lamp lamp_of(const Value& value) {
  Lamp lamp{{}, label(value)};
  const auto type = std::ranges::find(kTypes, value.at("type").string());
  if (type == kTypes.end()) value.at("type").fail_expected("directional, point or spot");
  lamp.light.kind = LightKind(type - kTypes.begin());
  lamp.light.color =
      color_or(Rgb(1), value, "color", kBrightest) * number_or(1, value, "intensity", kBrightest);
  if (lamp.light.kind == LightKind::spot) take_cone(value.at("spot"), lamp.light);
  return lamp;
}

std::optional<PhysicalLight> placed_light(PhysicalLight light, const Transform& place,
                                          Vec3d origin) {
  const Vec3d direction = place.vector({0, 0, -1});
  const double size = length(direction);
  light.position = Vec3f(place.point({}) - origin);
  if (!is_place(light.position) || !(size > 1e-30) || !std::isfinite(size)) return std::nullopt;
  light.direction = Vec3f(direction / size);
  return light;
}

int stops_above_white(const Array<PhysicalLight>& lights, const Box3f& box) {
  const Vec3d middle = (Vec3d(box.lo) + Vec3d(box.hi)) * 0.5, size = Vec3d(box.hi) - Vec3d(box.lo);
  double irradiance = 0;
  for (const PhysicalLight& light : lights) {
    const Vec3d way = Vec3d(light.position) - middle;
    // A light inside is as far away as half of the scene reaches.
    const double squared = std::max(dot(way, way), dot(size, size) / 4);
    const bool decreases = light.kind != LightKind::directional && squared > 0;
    irradiance += double(max_component(light.color)) / (decreases ? squared : 1);
  }
  return irradiance > 0 ? std::ilogb(irradiance / std::numbers::pi) : INT_MIN;
}

bool is_punctual(const PhysicalLight& light) {
  return light.kind == LightKind::point ||
         (light.kind == LightKind::directional && light.angular_diameter == 0) ||
         (light.kind == LightKind::spot && light.opening <= 180);
}

Json json_of(const PhysicalLight& light) {
  const double most = double(max_component(light.color));
  const Vec3d color = most > 0 ? Vec3d(light.color) / most : Vec3d(1);
  Json out = {{"type", kTypes[size_t(light.kind)]},
              {"color", {color.x, color.y, color.z}},
              {"intensity", most}};
  if (light.kind == LightKind::spot) {
    const double outer = std::max(double(light.opening) / 2, 1e-3);
    out["spot"] = {{"innerConeAngle", std::max(outer - double(light.falloff), 0.0) / kDegrees},
                   {"outerConeAngle", outer / kDegrees}};
  }
  return out;
}

NodePlace place_of(const PhysicalLight& light) {
  const Vec3d back = -normalize(Vec3d(light.direction));
  const Frame<double> frame(back);
  NodePlace place;
  place.shift = Vec3d(light.position), place.rotation = rotation_to(frame.u, frame.v, back);
  return place;
}

}  // namespace raio::core::gltf
