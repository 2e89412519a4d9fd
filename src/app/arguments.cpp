#include "app/arguments.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "app/help.h"
#include "app/outline.h"
#include "render/job_options.h"
#include "render/picture_options.h"
#include "render/read_options.h"

namespace raio::core::app {

std::string file_name_problem(const std::string& text) {
  if (text.empty()) return "expected a file name, found nothing";
  if (text.size() > 1 && text[0] == '-')
    return fmt::format("expected a file name, found '{0}'; for a file of that name write ./{0}",
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
           "NFF, P3F, .raio, PDB, PQR, CIF, GRO, XYZ, LAMMPS, PLY, STL, OBJ, OFF or glTF; - is "
           "standard input",
           "SCENE");
  app.get_option("scene")->required();
}

namespace {

// Parses "A:B" or "A:B:STEP"; each number may be missing.
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

// An option that `set` takes, as text; its error becomes the command line's.
template <class Options>
void add_option(CLI::App& app, const OptionEntry<Options>& spec, auto set,
                std::string_view value_name, const std::string& more_help = {}) {
  begin_group(app, spec.group);
  const std::string name = "--" + std::string(spec.name);
  const bool with_integrator = app.get_option_no_throw("--integrator") != nullptr;
  std::string help = with_settings(option_help(spec, with_integrator), "--") + more_help;
  if (!spec.alone.empty()) help += fmt::format("; without a {}: {}", value_name, spec.alone);
  const auto parse = [set, name, &spec](const std::string& text) {
    const std::expected<void, std::string> done =
        set(text.empty() ? std::string(spec.alone) : text);
    if (!done) throw CLI::ValidationError(name, with_settings(done.error(), "--"));
  };
  if (!spec.is_switch()) {
    auto* option = app.add_option_function<std::string>(name, parse, help)
                       ->type_name(value_type(value_name, spec.words))
                       ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    if (!spec.alone.empty()) option->expected(0, 1);
    return;
  }
  // A scene can turn on some switches; --no-... turns them off.
  const std::string off = spec.value.is_optional ? ",!--no-" + std::string(spec.name) : "";
  app.add_flag_function(
      name + off, [parse](int64_t count) { parse(count > 0 ? "true" : "false"); }, help);
}

}  // namespace

void add_read_options(CLI::App& app, ReadOptions& options, std::optional<FrameRange>* frames) {
  for (const ReadOptionSpec& spec : read_option_table()) {
    if (frames && spec.name == "frame") {
      const auto set = [&options, &spec, frames](const std::string& text) {
        *frames = parse_frames(text);
        options.frame = 0;
        return *frames || spec.set(options, text)
                   ? std::expected<void, std::string>()
                   : expected_but("the number of a frame or a range such as 0:100:5", text);
      };
      add_option(app, spec, set, "N|A:B[:STEP]",
                 "; A:B:STEP renders every STEP-th frame from A up to but not including B, to "
                 "picture-0001.png and so on");
      continue;
    }
    add_option(
        app, spec, [&options, &spec](const std::string& text) { return spec.set(options, text); },
        spec.value_name);
  }
  end_groups(app);
}

std::string examples(std::initializer_list<std::string_view> lines) {
  std::string text = lines.size() == 1 ? "Example:\n" : "Examples:\n";
  for (const std::string_view line : lines) text += fmt::format("  {}\n", line);
  return text;
}

void refuse_conflict(RenderOptions& options, ReadOptions& read) {
  if (const auto why = read_background(options, read))
    throw CLI::ParseError(text_of(*why), kBadInput);
  if (const auto why = option_conflict(options)) throw CLI::ParseError(text_of(*why), kBadInput);
}

void add_render_options(CLI::App& app, RenderOptions& options,
                        std::initializer_list<std::string_view> wanted) {
  for (const OptionSpec& spec : render_option_table())
    if (wanted.size() == 0 || std::ranges::find(wanted, spec.name) != wanted.end())
      add_option(
          app, spec, [&options, &spec](const std::string& text) { return spec.set(options, text); },
          spec.value_name);
  end_groups(app);
}

void add_job_options(CLI::App& app, JobRequest& request,
                     std::initializer_list<std::string_view> wanted) {
  for (const JobOptionSpec& spec : job_option_table()) {
    if (std::ranges::find(wanted, spec.name) == wanted.end()) continue;
    add_option(
        app, spec, [&request, &spec](const std::string& text) { return spec.set(request, text); },
        spec.value_name);
    if (spec.value_name == "FILE")
      app.get_option("--" + std::string(spec.name))->check(CLI::Validator(file_name_problem, ""));
  }
}

}  // namespace raio::core::app
