// Lights of KHR_lights_punctual, for reader and writer. Their photometric numbers are taken as
// radiometric ones of the same size.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "io/mesh/gltf.h"
#include "io/mesh/gltf_json.h"
#include "io/mesh/gltf_place.h"

namespace raio::core::gltf {

inline constexpr const char* kLights = "KHR_lights_punctual";

Lamp lamp_of(const Value& value);

/// The light in the scene, relative to the origin; nothing if a scale of 0 leaves no direction.
std::optional<PhysicalLight> placed_light(PhysicalLight light, const Transform& place,
                                          Vec3d origin);

/// About how many times as bright as a display's white a white surface in the middle of the box is,
/// as a power of two. Cones and shadows do not count.
int stops_above_white(const Array<PhysicalLight>& lights, const Box3f& box);

/// Whether glTF has such lights.
bool is_punctual(const PhysicalLight& light);
/// A punctual light, and its node with its place, without the light's number.
Json json_of(const PhysicalLight& light);
NodePlace place_of(const PhysicalLight& light);

}  // namespace raio::core::gltf
