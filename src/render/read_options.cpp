#include "render/read_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ranges>

#include "base/spelling.h"
#include "base/srgb.h"
#include "integrate/color_text.h"
#include "io/atoms/select.h"
#include "io/colormaps.h"
#include "render/options.h"

namespace raio::core {
namespace {

using ReadSet = std::expected<void, std::string>;

constexpr std::array<std::string_view, 4> kStyles = {"space-filling", "ball-and-stick", "sticks",
                                                     "points"};  // in the order of AtomStyle

template <auto member>
constexpr OptionValue<ReadOptions> kReadValue = kMember<ReadOptions, member>;

template <auto member>
constexpr OptionValue<ReadOptions> kSelection = {
    OptionType::text,
    [](ReadOptions& o, const ReadOptionSpec& spec, std::string_view text) -> ReadSet {
      if (auto why = selection_problem(text); !why.empty()) return std::unexpected(std::move(why));
      return kReadValue<member>.set(o, spec, text);
    },
    kReadValue<member>.text, kReadValue<member>.reset};

constexpr auto kColorRange = kReadValue<&ReadOptions::color_range>;
constexpr auto kSky = kReadValue<&ReadOptions::sky>;
constexpr auto kAssembly = kReadValue<&ReadOptions::assembly>;

ReadSet set_color_range(ReadOptions& o, const ReadOptionSpec& spec, std::string_view text) {
  ReadOptions asked;
  if (!kColorRange.set(asked, spec, text) || (*asked.color_range)[0] == (*asked.color_range)[1])
    return expected_but("two different numbers, as in 0,1.5", text);
  return o.color_range = asked.color_range, ReadSet();
}

ReadSet set_sky(ReadOptions& o, const ReadOptionSpec& spec, std::string_view text) {
  ReadOptions asked;
  const bool is_list = bool(kSky.set(asked, spec, text));
  const auto [turbidity, elevation, azimuth] = asked.sky.value_or(std::array<float, 3>{});
  if (!is_list || turbidity < 1 || turbidity > 10 || elevation < 0 || elevation > 90 ||
      std::abs(azimuth) > 360)
    return expected_but(
        "the turbidity from 1 to 10, and the sun's elevation from 0 to 90 and azimuth from -360 to "
        "360 degrees, as in 3,45,120",
        text);
  return o.sky = asked.sky, ReadSet();
}

ReadSet set_assembly(ReadOptions& o, const ReadOptionSpec&, std::string_view text) {
  const auto number = parse_number<int>(text);
  if (text != "none" && (!number || *number < 1))
    return expected_but("a number from 1, or none", text);
  return o.assembly = number.value_or(0), ReadSet();
}

std::string assembly_text(const ReadOptions& o, const ReadOptionSpec& spec) {
  return o.assembly == 0 ? "none" : kAssembly.text(o, spec);
}

ReadSet set_color_atoms(ReadOptions& o, const ReadOptionSpec&, std::string_view text) {
  constexpr size_t kLongest = 60;  // of what a message repeats
  std::vector<AtomColor> colors;
  for (const auto part : std::views::split(text, ';')) {
    const std::string_view entry = trimmed({part.begin(), part.end()});
    if (entry.empty()) continue;
    const size_t colon = entry.rfind(':');
    if (colon == std::string_view::npos)
      return expected_but("a selection, a colon and a colour, as in \"chain A: navy\"",
                          cut_text(entry, kLongest));
    const std::string_view atoms = trimmed(entry.substr(0, colon)),
                           written = trimmed(entry.substr(colon + 1));
    if (auto why = selection_problem(atoms); !why.empty())
      return std::unexpected(fmt::format("'{}', {}", cut_text(atoms, kLongest), why));
    const auto color = parse_color(written, {.transparent = false, .brightest = 1});
    if (!color) return std::unexpected(color.error());
    if (colors.size() == kMaxAtomColors)
      return std::unexpected(fmt::format("expected at most {} selections", kMaxAtomColors));
    colors.push_back({std::string(atoms),
                      color->encoded ? linear_from_srgb(color->color) : color->color,
                      std::string(written)});
  }
  if (colors.empty()) return expected_but("a selection, a colon and a colour", text);
  return o.color_atoms = std::move(colors), ReadSet();
}

std::string color_atoms_text(const ReadOptions& o, const ReadOptionSpec&) {
  std::string text;
  for (const auto& [atoms, color, written] : o.color_atoms)
    text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", atoms, written);
  return text;
}

using enum OptionGroup;
using table::option, table::usual, table::range, table::one_of, table::excludes;

constexpr auto kReadTable = std::to_array<ReadOptionSpec>({
    option(figures, "style", "NAME", "Atom style: space-filling, ball-and-stick, sticks or points",
           kReadValue<&ReadOptions::style>,
           usual("space-filling; ball-and-stick for up to 300 atoms"), one_of(kStyles)),
    option(figures, "color-by", "NAME",
           "Colour by a property: element, chain, residue, type, index, bfactor, occupancy or a "
           "numeric column of the file",
           kReadValue<&ReadOptions::color_by>, usual("element; chain for large assemblies")),
    option(figures, "colormap", "NAME",
           "Colour map for numbers: viridis, plasma, cividis or coolwarm",
           kReadValue<&ReadOptions::colormap>, usual("viridis"), one_of(kColormaps)),
    option(figures, "color-range", "LO,HI", "Values at the two ends of the colour map",
           OptionValue<ReadOptions>{OptionType::list, set_color_range, kColorRange.text,
                                    kColorRange.reset},
           usual("the smallest and the largest")),
    option(figures, "color-atoms", "SEL:COLOR;...",
           "Colour these atoms, whatever `color-by` says, as in \"chain A: navy; ligand: "
           "#c02020\"; the last one counts",
           OptionValue<ReadOptions>{OptionType::text, set_color_atoms, color_atoms_text,
                                    [](ReadOptions& o) { o.color_atoms.clear(); }}),
    option(figures, "radius", "R",
           "Radius of points without one and of space-filling atoms; ball-and-stick uses 0.27 of "
           "it",
           kReadValue<&ReadOptions::radius>,
           usual("half the spacing of points; van der Waals radii of atoms"),
           range(1e-30, 1e30, "scene units")),
    option(input, "smooth", "DEG",
           "Smooth the edges of meshes without normals that bend by less than DEG degrees; 0 keeps "
           "faces flat",
           kReadValue<&ReadOptions::smooth>, usual("40; 0 for glTF, as its specification says"),
           range(0, 180, "degrees")),
    option(input, "assembly", "N|none", "Biological assembly of a molecule",
           OptionValue<ReadOptions>{OptionType::text, set_assembly, assembly_text, kAssembly.reset},
           usual("1 for space-filling, if the file has one")),
    option(input, "atom-style", "NAME", "Atom style of a LAMMPS data file, such as full",
           kReadValue<&ReadOptions::atom_style>,
           usual("from its section Atoms, else from its columns")),
    option(input, "only", "SEL",
           "Draw only these atoms: water, hydrogen, ion, ligand, protein, nucleic, element C,N, "
           "type 1,3-5, chain A, residue ALA,5-12 or index 0-99, joined by and, or, not and "
           "parentheses",
           kSelection<&ReadOptions::only>),
    option(input, "hide", "SEL", "Hide these atoms", kSelection<&ReadOptions::hide>),
    option(input, "show", "SEL",
           "Draw these atoms even if hidden, for example water around a protein",
           kSelection<&ReadOptions::show>),
    option(input, "cell", "",
           "Draw the edges of the unit cell; in a small one, repeat the atoms on its border on all "
           "sides",
           kReadValue<&ReadOptions::cell>, usual("on in pictures of crystals and simulations")),
    option(input, "images", "NA,NB,NC", "Repeat the unit cell along its sides, as in 2,2,1",
           kReadValue<&ReadOptions::images>, usual("1,1,1"), range(1, kMaxImages)),
    option(input, "frame", "N",
           "Frame of a trajectory or model of a molecule, from 0; negative counts from the end",
           kReadValue<&ReadOptions::frame>, usual("0")),
    option(
        input, "environment", "FILE",
        "Light the scene by this picture of all directions: an equirectangular .exr, .hdr, .pfm, "
        ".png or .jpg, twice as wide as high",
        kReadValue<&ReadOptions::environment>, usual("the file's")),
    option(input, "sky", "TURBIDITY,ELEVATION,AZIMUTH",
           "Light the scene by the sun and a clear sky; the turbidity is 2 for very clear, 3 for "
           "clear and 6 for hazy air, the sun's azimuth clockwise from -Z, or from +Y if Z is up",
           OptionValue<ReadOptions>{OptionType::list, set_sky, kSky.text, kSky.reset},
           excludes("environment")),
    option(input, "env-rotate", "DEG",
           "Turn the environment or the sky counterclockwise, seen from above",
           kReadValue<&ReadOptions::environment_rotation>, usual("0"), range(-360, 360, "degrees")),
});

}  // namespace

std::span<const ReadOptionSpec> read_option_table() { return kReadTable; }

const ReadOptionSpec& read_option_of(std::string_view name) {
  return *std::ranges::find(kReadTable, name, &ReadOptionSpec::name);
}

std::string option_arguments(const ReadOptions& options) {
  std::string out;
  for (const ReadOptionSpec& spec : kReadTable) {
    const std::string text = spec.text(options);
    if (!text.empty()) out += option_argument(spec.name, spec.is_switch(), text);
  }
  return out;
}

}  // namespace raio::core
