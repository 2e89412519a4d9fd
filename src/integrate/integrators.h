// The list of integrators, which provides the command line's names. To add one: its source file
// (see the recipe in ARCHITECTURE.md), a word and a name here, and lines in
// shadings-inl.h, wavefront.cpp and integrators.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace raio::core {

enum class IntegratorKind : uint8_t { classic, views, ambient, path };

inline constexpr std::array<std::string_view, 4> kIntegratorNames = {"classic", "views", "ambient",
                                                                     "path"};
inline constexpr std::string_view kIntegratorHelp =
    "How rays become colours: classic, the shading of Whitted and Phong; ambient, for figures, "
    "with the light of a sky and a key light; path, which follows light over many bounces; or "
    "views, which shows what eye rays intersect";

/// Whether the integrator's light comes from all directions, so that few samples are noisy.
constexpr bool lights_from_all_sides(IntegratorKind kind) {
  return kind == IntegratorKind::ambient || kind == IntegratorKind::path;
}

struct RenderSettings;
struct Scene;

/// An upper bound of a sample's value, whatever the integrator.
double sample_bound(const Scene& scene, const RenderSettings& settings);

}  // namespace raio::core
