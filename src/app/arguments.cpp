#include "app/arguments.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include "app/help.h"
#include "app/outline.h"
#include "io/atoms/select.h"
#include "io/colormaps.h"

namespace raio::app {

std::string file_name_problem(const std::string& text) {
  if (text.empty()) return "expected the name of a file, found nothing";
  if (text.size() > 1 && text[0] == '-')
    return fmt::format("expected the name of a file, found '{0}'; if that is one, write ./{0}",
                       text);
  return {};
}

void add_file(CLI::App& app, const std::string& name, std::string& path, const std::string& help,
              const std::string& value_name) {
  app.add_option(name, path, help)
      ->check(CLI::Validator(file_name_problem, ""))
      ->type_name(value_name)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_scene(CLI::App& app, std::string& path) {
  add_file(app, "scene", path,
           "Scene file: NFF, P3F, .raio, PDB, PQR, CIF, GRO, XYZ, LAMMPS, PLY, STL, OBJ, OFF or "
           "glTF; - is "
           "standard input",
           "SCENE");
  app.get_option("scene")->required();
}

namespace {

// "A:B" or "A:B:STEP", any of which may be left out; nothing: it is none.
std::optional<FrameRange> parse_frames(std::string_view text) {
  FrameRange out;
  std::optional<int> step;
  std::optional<int>* const parts[] = {&out.first, &out.last, &step};
  size_t count = 0;
  for (bool more = true; more; ++count) {
    const size_t end = std::min(text.find(':'), text.size());
    more = end < text.size();
    if (count == std::size(parts)) return std::nullopt;
    if (end > 0) {
      int number = 0;
      const auto [stop, error] = std::from_chars(text.data(), text.data() + end, number);
      if (error != std::errc() || stop != text.data() + end) return std::nullopt;
      *parts[count] = number;
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  out.step = step.value_or(1);
  if (count < 2 || out.step < 1) return std::nullopt;
  return out;
}

// "-3,5.5".
std::array<double, 2> parse_range(const std::string& text) {
  std::array<double, 2> out{};
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, out[0]);
  const bool comma = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
  const auto second = comma ? std::from_chars(first.ptr + 1, end, out[1]) : first;
  if (!comma || second.ec != std::errc() || second.ptr != end || !std::isfinite(out[0]) ||
      !std::isfinite(out[1]) || out[0] == out[1])
    throw CLI::ValidationError(
        "--color-range",
        fmt::format("expected two different numbers, as in 0,1.5, found '{}'", text));
  return out;
}

// "2,2,1".
std::array<int, 3> parse_images(const std::string& text) {
  std::array<int, 3> out{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (size_t i = 0; i < 3; ++i) {
    const auto [stop, error] = std::from_chars(at, end, out[i]);
    const bool more = i < 2 && stop != end && *stop == ',';
    if (error != std::errc() || out[i] < 1 || out[i] > kMostImages || (stop != end) != (i < 2) ||
        (i < 2 && !more))
      throw CLI::ValidationError(
          "--images", fmt::format("expected three numbers from 1 to {}, as in 2,2,1, found '{}'",
                                  kMostImages, text));
    at = stop + more;
  }
  return out;
}

}  // namespace

std::vector<const CLI::Option*> add_read_options(CLI::App& app, ReadOptions& options,
                                                 std::optional<FrameRange>* frames) {
  const size_t before = app.get_options().size();
  static constexpr std::string_view kStyles[] = {"space-filling", "ball-and-stick", "sticks",
                                                 "points"};  // in the order of AtomStyle
  const auto word = [&](const std::string& name, const auto& take, const std::string& help,
                        const std::string& value_name) {
    app.add_option_function<std::string>(name, take, help)
        ->type_name(value_name)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  };
  word(
      "--style",
      [&options](const std::string& text) {
        const auto* const style = std::ranges::find(kStyles, text);
        if (style == std::end(kStyles))
          throw CLI::ValidationError(
              "--style",
              fmt::format("expected space-filling, ball-and-stick, sticks or points, found '{}'",
                          text));
        options.style = AtomStyle(style - std::begin(kStyles));
      },
      "Draw atoms so: space-filling, ball-and-stick, sticks or points (default: space-filling; "
      "ball-and-stick for up to 300 atoms)",
      value_type("NAME", kStyles));
  word(
      "--color-by", [&options](const std::string& text) { options.color_by = text; },
      "Colour by element, chain, residue, type, index, bfactor, occupancy or a column of numbers "
      "of "
      "the file (default: element)",
      "NAME");
  word(
      "--colormap", [&options](const std::string& text) { options.colormap = text; },
      "Colours of numbers: viridis, plasma, cividis or coolwarm (default: viridis)",
      value_type("NAME", kColormaps));
  word(
      "--color-range",
      [&options](const std::string& text) { options.color_range = parse_range(text); },
      "Numbers that have the first and the last colour of the map (default: the least and the "
      "largest)",
      "LO,HI");
  add_number(app, "--radius", options.radius, 1e-30f, 1e30f,
             "Radius of points that have none, and of atoms, in scene units (default: half of the "
             "points' spacing; the elements' radii)",
             "R");
  word(
      "--smooth",
      [&options](const std::string& text) {
        float angle = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, angle);
        if (error != std::errc() || stop != end || !(angle >= 0 && angle <= 180))
          throw CLI::ValidationError(
              "--smooth", fmt::format("expected degrees from 0 to 180, found '{}'", text));
        options.smooth = angle;
      },
      "Let edges of meshes without normals look round that bend by less than DEG degrees; 0 for "
      "flat faces (default: 40; 0 for glTF, whose rule it is)",
      "DEG");
  word(
      "--assembly",
      [&options](const std::string& text) {
        int number = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, number);
        if (text != "none" && (error != std::errc() || stop != end || number < 1))
          throw CLI::ValidationError(
              "--assembly", fmt::format("expected a number from 1, or none, found '{}'", text));
        options.assembly = number;
      },
      "Biological assembly of a molecule (default: 1 where there is one, for space-filling)",
      "N|none");
  word(
      "--atom-style", [&options](const std::string& text) { options.atom_style = text; },
      "Style of the atoms of a LAMMPS data file, such as full (default: as its section Atoms has "
      "it, else by its columns)",
      "NAME");
  const auto selection = [&](const std::string& name, std::string& to, const std::string& help) {
    word(
        name,
        [name, &to](const std::string& text) {
          if (auto why = selection_problem(text); !why.empty())
            throw CLI::ValidationError(name, why);
          to = text;
        },
        help, "SEL");
  };
  selection("--only", options.only,
            "Draw these atoms alone: water, hydrogen, ion, ligand, protein, nucleic, element C,N, "
            "type 1,3-5, chain A, residue ALA,5-12 or index 0-99, joined by and, or, not and "
            "parentheses");
  selection("--hide", options.hide, "Leave these atoms out");
  selection("--show", options.show,
            "Draw these atoms even so" +
                std::string(options.hide_solvent ? ", such as water around a protein" : ""));
  auto* const cell = app.add_flag_function(
      "--cell", [&options](int64_t) { options.cell = true; },
      "Draw the edges of the cell of a crystal or simulation, with the atoms on its border on all "
      "sides where it is small" +
          std::string(options.cell ? "" : " (default, but for molecules)"));
  app.add_flag_function(
         "--no-cell", [&options](int64_t) { options.cell = false; },
         "Draw no edges and no atoms twice")
      ->excludes(cell);
  word(
      "--images", [&options](const std::string& text) { options.images = parse_images(text); },
      "Copies of the cell along its sides, such as 2,2,1 (default: 1,1,1)", "NA,NB,NC");
  word(
      "--frame",
      [&options, frames](const std::string& text) {
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, options.frame);
        if (error == std::errc() && stop == end) return;
        options.frame = 0;
        if (frames) *frames = parse_frames(text);
        if (!frames || !*frames)
          throw CLI::ValidationError(
              "--frame", fmt::format("expected the number of a frame{}, found '{}'",
                                     frames ? " or a range such as 0:100:5" : "", text));
      },
      fmt::format("Frame of a trajectory or model of a molecule, from 0; negative from the end{} "
                  "(default: 0)",
                  frames
                      ? "; A:B:STEP renders every STEP-th from A to before B to picture-0001.png "
                        "and so on"
                      : ""),
      frames ? "N|A:B[:STEP]" : "N");
  const auto all = std::as_const(app).get_options();
  return {all.begin() + ptrdiff_t(before), all.end()};
}

std::string given_arguments(const std::vector<const CLI::Option*>& options) {
  std::string out;
  for (const CLI::Option* option : options) {
    if (option->count() == 0) continue;
    out += fmt::format(" --{}", option->get_lnames().front());
    if (option->get_items_expected() > 0) out += " " + shell_word(option->results().back());
  }
  return out;
}

std::string examples(std::initializer_list<std::string_view> lines) {
  std::string text = lines.size() == 1 ? "Example:\n" : "Examples:\n";
  for (const std::string_view line : lines) text += fmt::format("  {}\n", line);
  return text;
}

void refuse_conflict(const RenderOptions& options) {
  if (const auto why = option_conflict(options)) throw CLI::ParseError(text_of(*why), kBadInput);
}

void add_render_options(CLI::App& app, RenderOptions& options,
                        std::initializer_list<std::string_view> wanted) {
  for (const OptionSpec& spec : render_option_table()) {
    if (wanted.size() > 0 && std::ranges::find(wanted, spec.name) == wanted.end()) continue;
    const std::string name = "--" + std::string(spec.name);
    const auto set = [&options, &spec, name](const std::string& text) {
      if (auto done = set_option(options, spec, text); !done)
        throw CLI::ValidationError(name, with_settings(done.error().message, "--"));
    };
    if (!spec.is_switch()) {
      app.add_option_function<std::string>(name, set, with_settings(spec.help, "--"))
          ->type_name(value_type(spec.value_name, spec.words))
          ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
      continue;
    }
    // A switch that the scene can set has a way to say no.
    const bool optional =
        std::holds_alternative<std::optional<bool>& (*)(RenderOptions&)>(spec.value);
    app.add_flag_function(
        name + (optional ? ",!--no-" + std::string(spec.name) : ""),
        [set](int64_t count) { set(count > 0 ? "true" : "false"); },
        with_settings(spec.help, "--"));
  }
}

}  // namespace raio::app
