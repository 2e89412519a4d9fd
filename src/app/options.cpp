// `raio options`: the tables of options, for programs that offer them.
#include "render/options.h"

#include <cstdint>

#include "app/json.h"
#include "app/manual.h"
#include "render/job_options.h"
#include "render/read_options.h"

namespace raio::core::app {
namespace {

Json text_json(std::string_view text) { return text.empty() ? Json(nullptr) : Json(text); }

Json value_json(OptionType type, const std::string& text) {
  if (type == OptionType::toggle && !text.empty()) return text == "true";
  if (type == OptionType::integer && !text.empty()) return parse_number<int64_t>(text).value();
  if (type == OptionType::number && !text.empty()) return parse_number<double>(text).value();
  return text_json(text);
}

template <class Options>
Json entry_json(const OptionEntry<Options>& entry, std::string_view of,
                const std::vector<std::string_view>& excludes) {
  const auto limit = [&](double value) -> Json {
    if (entry.least == entry.most) return nullptr;
    return entry.type() == OptionType::integer ? Json(int64_t(value)) : Json(value);
  };
  return {{"name", entry.name},
          {"of", of},
          {"group", kOptionGroups[size_t(entry.group)]},
          {"type", kOptionTypes[size_t(entry.type())]},
          {"value_name", text_json(entry.value_name)},
          {"unit", text_json(entry.unit)},
          {"default", text_json(with_settings(default_text(entry), ""))},
          {"default_value", value_json(entry.type(), default_value(entry))},
          {"minimum", limit(entry.least)},
          {"maximum", limit(entry.most)},
          {"words", entry.words},
          {"help", with_settings(option_help(entry), "")},
          {"integrators", names_of(entry.integrators)},
          {"excludes", excludes},
          {"affects_picture", entry.of_picture}};
}

}  // namespace

std::string options_json() {
  Json all = Json::array();
  for (const OptionSpec& spec : render_option_table())
    all.push_back(entry_json(spec, "rendering", excluded_by(spec)));
  for (const ReadOptionSpec& spec : read_option_table())
    all.push_back(entry_json(spec, "reading", {}));
  for (const JobOptionSpec& spec : job_option_table()) all.push_back(entry_json(spec, "job", {}));
  return json_text({{"version", RAIO_VERSION}, {"options", all}});
}

}  // namespace raio::core::app
