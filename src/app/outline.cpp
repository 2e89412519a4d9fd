#include "app/outline.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace raio::core::app {
namespace {

constexpr const char* kOwnOptions = "Options";  // CLI11's own default

}  // namespace

std::string value_type(std::string_view value_name, std::span<const std::string_view> words) {
  return words.empty() ? std::string(value_name)
                       : fmt::format("{}:{{{}}}", value_name, fmt::join(words, ","));
}

std::string value_name(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(":{"));
}

std::string value_usage(const CLI::Option& option) {
  return needs_value(option) ? value_name(option) : "[" + value_name(option) + "]";
}

std::vector<std::string> value_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const size_t begin = type.find(":{");
  if (begin == std::string::npos) return {};
  return CLI::detail::split(type.substr(begin + 2, type.size() - begin - 3), ',');
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

bool needs_value(const CLI::Option& option) { return option.get_items_expected_min() > 0; }

bool is_list(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

std::vector<std::string> option_names(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::string first_clause(const CLI::Option& option) {
  const std::string& help = option.get_description();
  return help.substr(
      0, std::min({help.find(" ("), help.find(": "), help.find("; "), help.find(", with --")}));
}

std::vector<const CLI::Option*> positionals(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) { return o->get_positional(); });
}

std::vector<const CLI::Option*> named_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* o) {
    return !o->get_positional() && !o->get_group().empty();  // no group: hidden
  });
}

std::vector<OptionSection> option_sections(const CLI::App& app) {
  std::vector<OptionSection> sections = {{kOwnOptions, {}}};
  for (const std::string_view title : kOptionGroups) sections.push_back({title, {}});
  for (const CLI::Option* option : named_options(app))
    std::ranges::find(sections, option->get_group(), &OptionSection::title)
        ->options.push_back(option);
  std::erase_if(sections, [](const OptionSection& s) { return s.options.empty(); });
  return sections;
}

void begin_group(CLI::App& app, OptionGroup group) {
  app.option_defaults()->group(std::string(kOptionGroups[size_t(group)]));
}

void end_groups(CLI::App& app) { app.option_defaults()->group(kOwnOptions); }

std::vector<const CLI::App*> commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

const CLI::App* find_command(const CLI::App& app, std::string_view name) {
  const auto all = commands(app);
  const auto found = std::ranges::find(all, name, [](const CLI::App* c) { return c->get_name(); });
  return found == all.end() ? nullptr : *found;
}

std::vector<const CLI::App*> all_commands(const CLI::App& app) {
  std::vector<const CLI::App*> all = {&app};
  for (const CLI::App* command : commands(app)) {
    const auto below = all_commands(*command);
    all.insert(all.end(), below.begin(), below.end());
  }
  return all;
}

std::string full_name(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return (parent ? full_name(*parent) + " " : "") + command.get_name();
}

std::string usage_of_arguments(const CLI::App& app) {
  if (!commands(app).empty()) return " COMMAND [ARGUMENT ...]";
  std::string out;
  for (const CLI::Option* o : positionals(app)) {
    const std::string name = value_name(*o) + (is_list(*o) ? " ..." : "");
    out += o->get_required() ? " " + name : " [" + name + "]";
  }
  return out + " [OPTION ...]";
}

}  // namespace raio::core::app
