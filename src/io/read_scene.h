// What readers of scene files take and give, whatever the format.
#pragma once

#include <array>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/colormaps.h"
#include "io/diagnostics.h"
#include "scene/scene.h"

namespace raio {

class TextBuffer;  // io/nff/text_cursor.h

/// How atoms are drawn: spheres of their van der Waals radii; smaller ones with their bonds as
/// cylinders; bonds alone; or all as points of one size.
enum class AtomStyle { space_filling, ball_and_stick, sticks, points };

/// Copies of a cell along one of its sides.
inline constexpr int kMaxImages = 1000;

/// What a reader keeps of a text from one frame to the next; only it knows what that is.
struct FrameCache {
  std::shared_ptr<void> found;
};

/// What a user may ask of files that leave it open: atoms, points and meshes.
struct ReadOptions {
  // NOLINTBEGIN(readability-redundant-member-init): so that some can be left out
  std::optional<AtomStyle> style = {};
  std::string color_by = {};  // element, chain, residue, index or a column; empty: as usual
  std::string colormap = {};  // of numbers; empty: viridis
  std::optional<std::array<double, 2>> color_range = {};  // the numbers at its ends; none: theirs
  std::optional<float> smooth =
      {};            // the angle, in degrees, up to which edges of meshes look round
  float radius = 0;  // of points that have none, scene units; 0: from their spacing
  std::optional<int> assembly = {};  // biological; 0: none; without: 1 where there is one
  int frame = 0;                     // of a trajectory, or model, from 0; negative: from the end
  std::string atom_style = {};       // of the atoms of LAMMPS data; empty: as the file has it
  // Whether the edges of the box that repeats are drawn, of small cells with all atoms on its
  // border; none: if the file is of a crystal or a simulation.
  std::optional<bool> cell = false;
  std::array<int, 3> images = {1, 1, 1};  // copies along its sides
  // Which atoms are drawn (io/atoms/select.h); empty: all.
  std::string only = {}, hide = {}, show = {};
  bool hide_solvent = false;  // water and ions around a space-filling protein or nucleic acid
  bool instances = false;     // copies stay such; else they become primitives of their own
  std::optional<std::filesystem::path> folder = {};  // of other files that it names; none: nowhere
  FrameCache* cache = nullptr;  // of the text, where frame after frame is read of it
  // NOLINTEND(readability-redundant-member-init)

  friend bool operator==(const ReadOptions&, const ReadOptions&) = default;
};

/// The usual ones of pictures; conversions and counts are of the atoms alone.
inline const ReadOptions kForPictures{.cell = std::nullopt, .hide_solvent = true};

/// What a colour of the scene stands for: an element, a type, a chain, a residue.
struct LegendEntry {
  std::string name;
  Rgb color;  // linear
};

struct ReadScene {
  Scene scene;
  Diagnostics notices;                    // no errors
  size_t frames = 0;                      // that the file has; 0: it is of a kind that has none
  std::optional<ColorScale> colors = {};  // where numbers are shown as colours
  // NOLINTBEGIN(readability-redundant-member-init): so that some can be left out
  std::vector<LegendEntry> legend = {};  // where names are
  std::string unit = {};                 // of lengths; empty: unknown
  // NOLINTEND(readability-redundant-member-init)
};

/// Reads what is in memory, `file` by its name in messages.
using SceneReader = std::expected<ReadScene, Diagnostics> (*)(const TextBuffer& bytes,
                                                              std::string_view file,
                                                              const ReadOptions& options);

}  // namespace raio
