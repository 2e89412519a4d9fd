#include "app/arguments.h"

#include <algorithm>
#include <optional>
#include <variant>

#include "app/help.h"
#include "app/outline.h"

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
  add_file(app, "scene", path, "Scene file: NFF, P3F or .raio; - is standard input", "SCENE");
  app.get_option("scene")->required();
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
