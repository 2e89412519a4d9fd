// An entry of a table of options (render/options.cpp, render/read_options.cpp). Everything else
// follows from it: command line, help, messages, the window's panel, JSON, stored settings.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "integrate/integrators.h"

namespace raio::core {

/// The sections of the help, in order.
enum class OptionGroup : uint8_t {
  input,
  output,
  camera,
  sampling,
  effects,
  figures,
  long_renders,
  diagnostics,
};
inline constexpr auto kOptionGroups =
    std::to_array<std::string_view>({"Input", "Output", "Camera", "Sampling", "Effects", "Figures",
                                     "Long renders", "Speed and diagnostics"});

/// The form of a value; all are written as text. `words`: one of OptionEntry::words.
enum class OptionType : uint8_t { toggle, integer, number, words, vector, color, size, list, text };
inline constexpr auto kOptionTypes = std::to_array<std::string_view>(
    {"switch", "integer", "number", "words", "vector", "color", "size", "list", "text"});

/// A set of integrators.
using Integrators = uint8_t;
constexpr Integrators bit_of(IntegratorKind kind) { return Integrators(1 << int(kind)); }
inline constexpr Integrators kAllIntegrators = (1 << kIntegratorNames.size()) - 1;

inline std::vector<std::string_view> names_of(Integrators integrators) {
  std::vector<std::string_view> names;
  for (size_t i = 0; i < kIntegratorNames.size(); ++i)
    if (integrators >> i & 1) names.push_back(kIntegratorNames[i]);
  return names;
}

template <class Options>
struct OptionEntry;

/// How an entry reads and writes its value: kMember, or functions for a form of its own.
template <class Options>
struct OptionValue {
  using Entry = OptionEntry<Options>;

  OptionType type;
  std::expected<void, std::string> (*set)(Options&, const Entry&, std::string_view);
  std::string (*text)(const Options&, const Entry&);
  void (*reset)(Options&) = nullptr;  // to the default
  bool is_optional = false;           // the scene or a rule decides if it is not given
};

template <class Options>
struct OptionEntry {
  OptionGroup group;
  std::string_view name;        // --name on the command line
  std::string_view value_name;  // "N"; empty for a switch
  std::string_view help;        // for option_help(); settings as in Error::message
  OptionValue<Options> value;

  std::string_view usual = {};  // the default, as a value or in words; empty: the member's
  double least = 0, most = 0;   // of numbers; equal: any
  std::string_view unit = {};
  std::span<const std::string_view> words = {};  // NOLINT(readability-redundant-member-init)
  std::string_view alone = {};                   // the value if the name stands alone; or required
  Integrators integrators = kAllIntegrators;     // others ignore it
  std::string_view excludes = {};                // an option that it cannot be combined with
  bool is_always_stored = false;                 // even if it is the default
  bool of_picture = true;                        // it affects the picture
  bool of_window = true;  // it also applies to progressive pictures in the window

  bool is_switch() const { return value_name.empty(); }
  OptionType type() const {
    const bool any = value.type == OptionType::toggle || value.type == OptionType::text;
    return any && !words.empty() ? OptionType::words : value.type;
  }
  bool applies_to(IntegratorKind kind) const { return (integrators & bit_of(kind)) != 0; }

  /// Sets it from text ("true" or "false" for a switch). The error says what was expected and
  /// found.
  std::expected<void, std::string> set(Options& options, std::string_view text) const {
    return value.set(options, *this, text);
  }
  /// The value in the form of set(); empty if not given.
  std::string text(const Options& options) const { return value.text(options, *this); }
  bool is_given(const Options& options) const { return text(options) != text(Options()); }
};

/// The words of a table.
namespace table {

/// An entry; the rest are its properties, in any order.
template <class Options, class... Properties>
constexpr OptionEntry<Options> option(OptionGroup group, std::string_view name,
                                      std::string_view value_name, std::string_view help,
                                      OptionValue<Options> value, const Properties&... properties) {
  OptionEntry<Options> entry{group, name, value_name, help, value};
  (properties(entry), ...);
  return entry;
}

constexpr auto usual(std::string_view value) {
  return [=](auto& entry) { entry.usual = value; };
}
constexpr auto unit(std::string_view name) {
  return [=](auto& entry) { entry.unit = name; };
}
constexpr auto range(double least, double most, std::string_view unit = {}) {
  return [=](auto& entry) { entry.least = least, entry.most = most, entry.unit = unit; };
}
constexpr auto one_of(std::span<const std::string_view> words) {
  return [=](auto& entry) { entry.words = words; };
}
constexpr auto alone(std::string_view value) {
  return [=](auto& entry) { entry.alone = value; };
}
constexpr auto only_with(auto... integrators) {
  return [=](auto& entry) { entry.integrators = (bit_of(integrators) | ...); };
}
constexpr auto excludes(std::string_view name) {
  return [=](auto& entry) { entry.excludes = name; };
}
inline constexpr auto kAlwaysStored = [](auto& entry) { entry.is_always_stored = true; };
inline constexpr auto kNotOfPicture = [](auto& entry) { entry.of_picture = false; };
inline constexpr auto kNotOfWindow = [](auto& entry) { entry.of_window = false; };

}  // namespace table

inline std::unexpected<std::string> expected_but(std::string_view expected, std::string_view text) {
  return std::unexpected(fmt::format("expected {}, found '{}'", expected, text));
}

/// A number that is the whole text.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// As many numbers as `out` has, with separators between them.
template <class Numbers>
bool parse_list(std::string_view text, char separator, Numbers& out) {
  constexpr int kCount = sizeof(out) / sizeof(out[0]);
  for (int i = 0; i < kCount; ++i) {
    const bool is_last = i + 1 == kCount;
    const size_t end = is_last ? text.size() : text.find(separator);
    if (end == std::string_view::npos) return false;
    const auto number = parse_number<std::remove_cvref_t<decltype(out[0])>>(text.substr(0, end));
    if (!number) return false;
    out[i] = *number;
    text.remove_prefix(is_last ? end : end + 1);
  }
  return true;
}

/// One of `names`; its index is the value.
template <class T>
std::expected<void, std::string> parse_word(std::span<const std::string_view> names,
                                            std::string_view text, T& value) {
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return value = T(i), std::expected<void, std::string>();
  std::string accepted(names.front());
  for (size_t i = 1; i < names.size(); ++i)
    accepted += fmt::format("{}{}", i + 1 < names.size() ? ", " : " or ", names[i]);
  return expected_but(accepted, text);
}

namespace option_value {

template <class T>
struct Plain {
  using Type = T;
};
template <class T>
struct Plain<std::optional<T>> {
  using Type = T;
};

template <auto first, auto... rest>
constexpr auto& at(auto& options) {
  if constexpr (sizeof...(rest) == 0)
    return options.*first;
  else
    return at<rest...>(options.*first);
}

template <class T>
inline constexpr OptionType kType = std::is_same_v<T, bool>          ? OptionType::toggle
                                    : std::is_enum_v<T>              ? OptionType::words
                                    : std::is_integral_v<T>          ? OptionType::integer
                                    : std::is_floating_point_v<T>    ? OptionType::number
                                    : std::is_same_v<T, std::string> ? OptionType::text
                                    : std::is_same_v<T, Vec3d>       ? OptionType::vector
                                                                     : OptionType::list;

// Between numbers, as in "X,Y,Z" and "XxYxZ".
constexpr const char* separator(const auto& entry) {
  return entry.value_name.contains('x') ? "x" : ",";
}

template <class T>
std::expected<void, std::string> parse(const auto& entry, std::string_view text, T& out) {
  constexpr OptionType kForm = kType<T>;
  if constexpr (kForm == OptionType::text) {
    out = text;
  } else if constexpr (kForm == OptionType::toggle || kForm == OptionType::words) {
    if (!entry.words.empty()) return parse_word(entry.words, text, out);
    out = T(text == "true");
  } else {
    constexpr bool kOne = std::is_arithmetic_v<T>;
    const auto fits = [&](auto number) {
      using Number = decltype(number);
      return std::isfinite(double(number)) &&
             (entry.least == entry.most ||
              (number >= Number(entry.least) && number <= Number(entry.most)));
    };
    const auto refused = [&](auto number) {
      using Number = decltype(number);
      const std::string_view kind = std::is_integral_v<Number> ? "whole number" : "number";
      const std::string range =
          entry.least == entry.most
              ? ""
              : fmt::format("{} from {} to {}{}{}", kOne ? "" : ", each", Number(entry.least),
                            Number(entry.most), entry.unit.empty() ? "" : " ", entry.unit);
      // NOLINTNEXTLINE(bugprone-sizeof-expression): one number has one
      constexpr size_t kCount = sizeof(T) / sizeof(Number);
      return expected_but(
          kOne ? fmt::format("a {}{}", kind, range)
               : fmt::format("{} {}s as {}{}", kCount, kind, entry.value_name, range),
          text);
    };
    T value{};
    if constexpr (kOne) {
      const auto number = parse_number<T>(text);
      if (!number || !fits(*number)) return refused(value);
      value = *number;
    } else {
      bool sound = parse_list(text, separator(entry)[0], value);
      for (int i = 0; i < int(sizeof(T) / sizeof(value[0])); ++i) sound = sound && fits(value[i]);
      if (!sound) return refused(value[0]);
    }
    out = value;
  }
  return {};
}

// Numbers have the shortest decimals that read back the same.
template <class T>
std::string text(const auto& entry, const T& value) {
  if constexpr (kType<T> == OptionType::toggle || kType<T> == OptionType::words) {
    if (!entry.words.empty()) return std::string(entry.words[size_t(value)]);
    return value == T(1) ? "true" : "false";
  } else if constexpr (std::is_arithmetic_v<T> || kType<T> == OptionType::text) {
    return fmt::format("{}", value);
  } else {
    std::string out;
    for (int i = 0; i < int(sizeof(T) / sizeof(value[0])); ++i)
      out += fmt::format("{}{}", i == 0 ? "" : separator(entry), value[i]);
    return out;
  }
}

}  // namespace option_value

/// A member of the options, or a member of a member: a switch, number, word of OptionEntry::words,
/// text, vector or array of numbers, optional or not.
template <class Options, auto... path>
inline constexpr OptionValue<Options> kMember = [] {
  using Entry = OptionEntry<Options>;
  using Member = std::remove_cvref_t<decltype(option_value::at<path...>(std::declval<Options&>()))>;
  using Type = option_value::Plain<Member>::Type;
  constexpr bool kIsOptional = !std::is_same_v<Member, Type>;
  return OptionValue<Options>{
      .type = option_value::kType<Type>,
      .set =
          [](Options& o, const Entry& entry, std::string_view text) {
            Type value{};
            auto done = option_value::parse(entry, text, value);
            if (done) option_value::at<path...>(o) = std::move(value);
            return done;
          },
      .text = [](const Options& o, const Entry& entry) -> std::string {
        const Member& value = option_value::at<path...>(o);
        if constexpr (kIsOptional) {
          return value ? option_value::text(entry, *value) : "";
        } else {
          const Options usual;
          const bool is_usual = value == option_value::at<path...>(usual);
          return is_usual && !entry.is_always_stored ? "" : option_value::text(entry, value);
        }
      },
      .reset =
          [](Options& o) {
            const Options usual;
            option_value::at<path...>(o) = option_value::at<path...>(usual);
          },
      .is_optional = kIsOptional};
}();

/// The default as a value; empty if it depends on the scene or other options.
template <class Options>
std::string default_value(const OptionEntry<Options>& entry) {
  if (entry.type() == OptionType::toggle) return entry.value.is_optional ? "" : "false";
  if (entry.usual.empty()) return entry.text(Options());
  if (entry.type() == OptionType::text || entry.type() == OptionType::color) return {};
  Options ignored;
  return std::string(entry.set(ignored, entry.usual) ? entry.usual : "");
}

/// The default in the help; empty if there is none to mention.
template <class Options>
std::string default_text(const OptionEntry<Options>& entry) {
  return entry.usual.empty() && !entry.is_switch() ? default_value(entry)
                                                   : std::string(entry.usual);
}

/// The whole help: what it does, with unit, integrator (if it can be selected) and default.
template <class Options>
std::string option_help(const OptionEntry<Options>& entry, bool with_integrator = true) {
  const size_t clause = std::min({entry.help.find(": "), entry.help.find("; "), entry.help.size()});
  std::string added;
  if (!entry.unit.empty() && !entry.help.contains(entry.unit))
    added += fmt::format(", in {}", entry.unit);
  if (const auto names = names_of(entry.integrators); with_integrator && names.size() == 1)
    added += fmt::format(", with `integrator` {}", names.front());
  const std::string usual = default_text(entry);
  return fmt::format("{}{}{}{}", entry.help.substr(0, clause), added, entry.help.substr(clause),
                     usual.empty() ? "" : fmt::format(" (default: {})", usual));
}

}  // namespace raio::core
