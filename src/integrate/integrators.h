// The list of ways of shading, from which the command line takes their names. To add one: its file
// (ARCHITECTURE.md has the recipe), a word and a name here, a line in integrators.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

namespace raio {

enum class IntegratorKind : uint8_t { classic, views, ambient };

inline constexpr std::array<std::string_view, 3> kIntegratorNames = {"classic", "views", "ambient"};
inline constexpr std::string_view kIntegratorHelp =
    "How rays become colours: classic, the shading of Whitted and Phong; ambient, for figures, "
    "with "
    "the light of a sky and a key light; or views, which shows what eye rays intersect (default: "
    "classic; ambient for atoms, points and meshes; views with `view`)";

class TileRenderer;
struct PreparedScene;
struct RenderControl;
struct RenderSettings;
struct Scene;

struct Integrator {
  /// No sample of the scene brings more than this to a pixel.
  double (*bound)(const Scene&, const RenderSettings&);
  /// Renders tiles with the best instruction set that this machine has.
  std::unique_ptr<TileRenderer> (*make)(const PreparedScene&, RenderControl&);
};

const Integrator& integrator(IntegratorKind kind);

}  // namespace raio
