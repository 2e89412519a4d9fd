#include "render/read_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/atoms/select.h"
#include "io/colormaps.h"
#include "render/option_text.h"
#include "render/options.h"

namespace raio::core {
namespace {

using Set = std::expected<void, std::string>;

constexpr std::array<std::string_view, 4> kStyles = {"space-filling", "ball-and-stick", "sticks",
                                                     "points"};  // in the order of AtomStyle

Set wrong(std::string_view expected, std::string_view text) {
  return std::unexpected(fmt::format("expected {}, found '{}'", expected, text));
}

// Comma-separated numbers, as many as fit.
template <class T, size_t n>
bool parse_list(std::string_view text, std::array<T, n>& out) {
  for (size_t i = 0; i < n; ++i) {
    const bool is_last = i + 1 == n;
    const size_t end = is_last ? text.size() : text.find(',');
    if (end == std::string_view::npos) return false;
    const auto number = parse_number<T>(text.substr(0, end));
    if (!number) return false;
    out[i] = *number;
    text.remove_prefix(is_last ? end : end + 1);
  }
  return true;
}

template <std::string ReadOptions::* member>
Set set_word(ReadOptions& o, std::string_view text) {
  return o.*member = text, Set();
}

template <std::string ReadOptions::* member>
Set set_selection(ReadOptions& o, std::string_view text) {
  if (auto why = selection_problem(text); !why.empty()) return std::unexpected(std::move(why));
  return set_word<member>(o, text);
}

template <std::string ReadOptions::* member>
std::string word(const ReadOptions& o) {
  return o.*member;
}

Set set_range(ReadOptions& o, std::string_view text) {
  std::array<double, 2> ends{};
  if (!parse_list(text, ends) || !std::isfinite(ends[0]) || !std::isfinite(ends[1]) ||
      ends[0] == ends[1])
    return wrong("two different numbers, as in 0,1.5", text);
  return o.color_range = ends, Set();
}

Set set_radius(ReadOptions& o, std::string_view text) {
  constexpr float kLeast = 1e-30f, kMost = 1e30f;
  const auto radius = parse_number<float>(text);
  if (!radius || !(*radius >= kLeast && *radius <= kMost))
    return wrong(fmt::format("a number from {} to {}", kLeast, kMost), text);
  return o.radius = *radius, Set();
}

Set set_smooth(ReadOptions& o, std::string_view text) {
  const auto angle = parse_number<float>(text);
  if (!angle || !(*angle >= 0 && *angle <= 180)) return wrong("degrees from 0 to 180", text);
  return o.smooth = angle, Set();
}

Set set_assembly(ReadOptions& o, std::string_view text) {
  const auto number = parse_number<int>(text);
  if (text != "none" && (!number || *number < 1)) return wrong("a number from 1, or none", text);
  return o.assembly = number.value_or(0), Set();
}

Set set_images(ReadOptions& o, std::string_view text) {
  std::array<int, 3> images{};
  if (!parse_list(text, images) || std::ranges::min(images) < 1 ||
      std::ranges::max(images) > kMaxImages)
    return wrong(fmt::format("three numbers from 1 to {}, as in 2,2,1", kMaxImages), text);
  return o.images = images, Set();
}

Set set_frame(ReadOptions& o, std::string_view text) {
  const auto frame = parse_number<int>(text);
  if (!frame) return wrong("the number of a frame", text);
  return o.frame = *frame, Set();
}

using enum OptionGroup;
constexpr ReadOptionSpec kTable[] = {
    {figures, "style", "NAME",
     "Atom style: space-filling, ball-and-stick, sticks or points (default: space-filling; "
     "ball-and-stick for up to 300 atoms)",
     [](ReadOptions& o, std::string_view text) {
       return parse_word<AtomStyle>(kStyles, text, o.style);
     },
     [](const ReadOptions& o) { return std::string(o.style ? kStyles[size_t(*o.style)] : ""); },
     kStyles},
    {figures, "color-by", "NAME",
     "Colour by a property: element, chain, residue, type, index, bfactor, occupancy or a numeric "
     "column of the file (default: element; chain for large assemblies)",
     set_word<&ReadOptions::color_by>, word<&ReadOptions::color_by>},
    {figures, "colormap", "NAME",
     "Colour map for numbers: viridis, plasma, cividis or coolwarm (default: viridis)",
     set_word<&ReadOptions::colormap>, word<&ReadOptions::colormap>, kColormaps},
    {figures, "color-range", "LO,HI",
     "Values at the two ends of the colour map (default: the smallest and the largest)", set_range,
     [](const ReadOptions& o) {
       return o.color_range ? fmt::format("{},{}", (*o.color_range)[0], (*o.color_range)[1])
                            : std::string();
     }},
    {figures, "radius", "R",
     "Radius of points without one and of space-filling atoms, in scene units; ball-and-stick "
     "takes 0.27 of it (default: half the spacing of points; van der Waals radii of atoms)",
     set_radius,
     [](const ReadOptions& o) { return o.radius > 0 ? fmt::format("{}", o.radius) : ""; }},
    {input, "smooth", "DEG",
     "Smooth the edges of meshes without normals that bend by less than DEG degrees; 0 keeps faces "
     "flat (default: 40; 0 for glTF, as its specification says)",
     set_smooth, [](const ReadOptions& o) { return o.smooth ? fmt::format("{}", *o.smooth) : ""; }},
    {input, "assembly", "N|none",
     "Biological assembly of a molecule (default: 1 for space-filling, if the file has one)",
     set_assembly,
     [](const ReadOptions& o) {
       return !o.assembly ? "" : *o.assembly == 0 ? "none" : fmt::format("{}", *o.assembly);
     }},
    {input, "atom-style", "NAME",
     "Atom style of a LAMMPS data file, such as full (default: from its section Atoms, else from "
     "its columns)",
     set_word<&ReadOptions::atom_style>, word<&ReadOptions::atom_style>},
    {input, "only", "SEL",
     "Draw only these atoms: water, hydrogen, ion, ligand, protein, nucleic, element C,N, type "
     "1,3-5, chain A, residue ALA,5-12 or index 0-99, joined by and, or, not and parentheses",
     set_selection<&ReadOptions::only>, word<&ReadOptions::only>},
    {input, "hide", "SEL", "Hide these atoms", set_selection<&ReadOptions::hide>,
     word<&ReadOptions::hide>},
    {input, "show", "SEL",
     "Draw these atoms although they are hidden, such as water around a protein",
     set_selection<&ReadOptions::show>, word<&ReadOptions::show>},
    {input, "cell", "",
     "Draw the edges of the unit cell; in a small one, repeat the atoms on its border on all sides "
     "(default: on in pictures of crystals and simulations)",
     [](ReadOptions& o, std::string_view text) { return o.cell = text == "true", Set(); },
     [](const ReadOptions& o) {
       return std::string(!o.cell ? "" : *o.cell ? "true" : "false");
     }},
    {input, "images", "NA,NB,NC",
     "Repeat the unit cell along its sides, as in 2,2,1 (default: 1,1,1)", set_images,
     [](const ReadOptions& o) {
       const auto& n = o.images;
       return n == ReadOptions().images ? "" : fmt::format("{},{},{}", n[0], n[1], n[2]);
     }},
    {input, "frame", "N",
     "Frame of a trajectory or model of a molecule, from 0; negative counts from the end (default: "
     "0)",
     set_frame, [](const ReadOptions& o) { return o.frame ? fmt::format("{}", o.frame) : ""; }},
};

}  // namespace

std::span<const ReadOptionSpec> read_option_table() { return kTable; }

std::string option_arguments(const ReadOptions& options) {
  std::string out;
  for (const ReadOptionSpec& spec : kTable) {
    const std::string text = spec.text(options);
    if (!text.empty()) out += option_argument(spec.name, spec.is_switch(), text);
  }
  return out;
}

}  // namespace raio::core
