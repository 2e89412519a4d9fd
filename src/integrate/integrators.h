// The list of integrators, which provides the command line's names. To add one: its source file
// (see the recipe in ARCHITECTURE.md), a word and a name here, a line in integrators.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

namespace raio::core {

enum class IntegratorKind : uint8_t { classic, views, ambient };

inline constexpr std::array<std::string_view, 3> kIntegratorNames = {"classic", "views", "ambient"};
inline constexpr std::string_view kIntegratorHelp =
    "How rays become colours: classic, the shading of Whitted and Phong; ambient, for figures, "
    "with the light of a sky and a key light; or views, which shows what eye rays intersect";

class TileRenderer;
struct PreparedScene;
struct WorkControl;
struct RenderSettings;
struct Scene;

struct Integrator {
  /// An upper bound of a sample's value in this scene.
  double (*bound)(const Scene&, const RenderSettings&);
  /// Renders tiles with the machine's best instruction set.
  std::unique_ptr<TileRenderer> (*make)(const PreparedScene&, WorkControl&);
};

const Integrator& integrator(IntegratorKind kind);

}  // namespace raio::core
