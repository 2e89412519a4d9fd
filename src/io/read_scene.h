// The common interface of readers of scene files.
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

namespace raio::core {

class TextBuffer;   // io/nff/text_cursor.h
struct AtomLabels;  // io/atoms/labels.h

/// Styles of atoms: spheres with van der Waals radii; smaller spheres with bonds as cylinders; only
/// bonds; or all as points of one size.
enum class AtomStyle { space_filling, ball_and_stick, sticks, points };

/// Images of a cell along one of its sides.
inline constexpr int kMaxImages = 1000;

/// State that a reader keeps between frames of a text; its type is private to the reader.
struct FrameCache {
  std::shared_ptr<void> found;
};

/// Atoms with a colour of their own.
struct AtomColor {
  std::string atoms;    // a selection (io/atoms/select.h)
  Rgb color;            // linear
  std::string written;  // the colour as text

  friend bool operator==(const AtomColor&, const AtomColor&) = default;
};
inline constexpr size_t kMaxAtomColors = 255;

/// Options for files that leave choices open: atoms, points and meshes.
struct ReadOptions {
  // NOLINTBEGIN(readability-redundant-member-init): so that some can be omitted
  std::optional<AtomStyle> style = {};
  std::string color_by = {};  // element, chain, residue, index or a column; empty: default
  std::string colormap = {};  // for numbers; empty: viridis
  std::optional<std::array<double, 2>> color_range =
      {};  // the numbers at its ends; none: automatic
  std::optional<float> smooth =
      {};  // the angle, in degrees, up to which edges of meshes are smoothed
  // At most kMaxAtomColors; where they overlap, the last one counts.
  std::vector<AtomColor> color_atoms = {};
  float radius = 0;                  // of points without one, scene units; 0: from their spacing
  std::optional<int> assembly = {};  // biological; 0: none; absent: 1 if there is one
  int frame = 0;                     // of a trajectory, or model, from 0; negative: from the end
  std::string atom_style = {};       // for LAMMPS data; empty: as in the file
  // Whether to draw the edges of the unit cell, and repeat atoms on the border of a small one;
  // absent: if the file is of a crystal or a simulation.
  std::optional<bool> cell = false;
  std::array<int, 3> images = {1, 1, 1};  // of the cell along its sides
  // Atoms to draw (io/atoms/select.h); empty: all.
  std::string only = {}, hide = {}, show = {};
  std::string environment = {};  // a picture of the light from all directions (io/environment.h)
  std::optional<std::array<float, 3>> sky =
      {};                          // turbidity, elevation, azimuth of the sun (io/clear_sky.h)
  float environment_rotation = 0;  // degrees, counterclockwise seen from above
  bool hide_solvent = false;       // water and ions around a space-filling protein or nucleic acid
  bool instances = false;          // keep instances; else they become primitives
  bool labels = false;             // keep what the file says about each atom
  std::optional<std::filesystem::path> folder = {};  // of referenced files; absent: none
  FrameCache* cache = nullptr;                       // for reading frame after frame of a text
  // NOLINTEND(readability-redundant-member-init)

  friend bool operator==(const ReadOptions&, const ReadOptions&) = default;
};

/// The defaults for pictures; conversions and counts take only the atoms.
inline const ReadOptions kForPictures{.cell = std::nullopt, .hide_solvent = true};

/// The meaning of a colour of the scene: an element, a type, a chain, a residue.
struct LegendEntry {
  std::string name;
  Rgb color;  // linear
};

/// The ReadOptions that apply to a file, and the values that were used.
struct ReadChoices {
  // Whether these have an effect: style, selections, cell and images; colours by a column; smooth.
  bool atoms = false, points = false, mesh = false;
  std::vector<std::string> columns;  // that `color_by` takes
  std::string color_by;              // in use; empty: the colours of the file
  AtomStyle style = AtomStyle::space_filling;
  bool has_cell = false, cell = false;  // drawn
  int assemblies = 0, assembly = 0;     // drawn; 0: none
};

struct ReadScene {
  Scene scene;
  Diagnostics notices;                    // no errors
  size_t frames = 0;                      // in the file; 0: the format has none
  std::optional<ColorScale> colors = {};  // if numbers are shown as colours
  // NOLINTBEGIN(readability-redundant-member-init): so that some can be omitted
  std::vector<LegendEntry> legend = {};          // if names are shown as colours
  std::string unit = {};                         // of lengths; empty: unknown
  std::shared_ptr<const AtomLabels> atoms = {};  // if asked for
  ReadChoices choices = {};
  // NOLINTEND(readability-redundant-member-init)
};

/// Reads a file in memory, with the name `file` for messages.
using SceneReader = std::expected<ReadScene, Diagnostics> (*)(const TextBuffer& bytes,
                                                              std::string_view file,
                                                              const ReadOptions& options);

}  // namespace raio::core
