#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "app/grade.h"
#include "app/json.h"

namespace raio::core::app {
namespace {

std::string size_text(const std::array<int, 2>& size) {
  return fmt::format("{}x{}", size[0], size[1]);
}

double percent(double part, double whole) { return 100 * part / std::max(whole, 1.0); }

std::string errors_text(const Grade::Errors& e, const GradeCommand& command, double pixels,
                        bool passed) {
  return fmt::format(
      "RMSE                {:.4g} of 255, {} the threshold of {:g}\n"
      "mean difference     {:.4g} of 255\n"
      "largest difference  {} of 255\n"
      "wrong pixels        {:.4g} %: a colour differs by more than {} of 255\n",
      e.difference.rmse, passed ? "within" : "beyond", command.threshold, e.mean,
      e.difference.largest, percent(double(e.wrong), pixels), command.tolerance);
}

std::string cause_text(const Cause& cause, bool is_first) {
  std::string text = fmt::format(
      "\n{:<20}{}: {}\nWith {}{}, the RMSE falls from {:.3g} to {:.3g}: this explains {:.3g} % of "
      "the squared error.\n{}\n",
      is_first ? "likely cause" : "and then", cause.fault->name, cause.fault->with,
      is_first ? "it" : "this, too", is_first ? " in Raio's picture" : "", cause.rmse_before,
      cause.rmse, 100 * cause.share(), cause.fault->check);
  for (const KnownFault* other : cause.equals)
    text += fmt::format("The same with {} ({}). {}\n", other->with, other->name, other->check);
  return text;
}

std::string pixel_text(std::string_view name, const Grade::WrongPixel& p) {
  return fmt::format("{:<20}{}: expected {}, found {}\n", name, fmt::join(p.at, ","),
                     fmt::join(p.expected, " "), fmt::join(p.found, " "));
}

std::string counts_text(const std::vector<Grade::Count>& counts) {
  std::string text = fmt::format("\n{:<20}{:>14}{:>14}\n", "rays", "expected", "found");
  for (const Grade::Count& count : counts)
    text += fmt::format("{:<20}{:>14}{:>14}\n", count.name, fmt::format("{:.10g}", count.expected),
                        count.found ? fmt::format("{:.10g}", *count.found) : "-");
  return text;
}

std::string advice(const Grade& grade) {
  std::string text;
  for (const Cause& cause : grade.causes) text += cause_text(cause, &cause == grade.causes.data());
  if (grade.region)
    text += fmt::format("\nNo known fault explains half of the error. Look first at the {}: {}.\n",
                        kRegionNames[size_t(*grade.region)], likely_cause(*grade.region));
  if (!grade.is_rendered)
    text +=
        "The reference is not Raio's picture of this scene, so only faults of the finished picture "
        "were tried.\n";
  return text;
}

// Whether the character may be part of a word.
bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

// The number after the first occurrence of the word in the text, with only punctuation and "per
// ray" between them.
std::optional<double> number_after(std::string_view text, std::string_view word) {
  for (size_t at = 0; (at = text.find(word, at)) != std::string_view::npos; at += word.size()) {
    std::string_view rest = text.substr(at + word.size());
    if ((at > 0 && is_letter(text[at - 1])) || (!rest.empty() && is_letter(rest[0]))) continue;
    if (rest.starts_with(" per ray")) rest.remove_prefix(8);
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t'\":=,|"), rest.size()));
    double value = 0;
    if (std::from_chars(rest.data(), rest.data() + rest.size(), value).ec == std::errc())
      return value;
  }
  return std::nullopt;
}

Json json_of(const Cause& cause) {
  Json equals = Json::array();
  for (const KnownFault* other : cause.equals) equals.push_back(other->name);
  return {{"name", cause.fault->name},   {"with", cause.fault->with},
          {"check", cause.fault->check}, {"rmse_before", cause.rmse_before},
          {"rmse", cause.rmse},          {"share", cause.share()},
          {"equals", std::move(equals)}};
}

Json json_of(const std::optional<Grade::WrongPixel>& pixel) {
  if (!pixel) return nullptr;
  return {{"pixel", pixel->at},
          {"expected", pixel->expected},
          {"found", pixel->found},
          {"explain", Json::parse(pixel->json)}};
}

}  // namespace

std::vector<Grade::Count> counts_in(std::string_view text, const RayCounts& expected) {
  const double rays = double(std::max<uint64_t>(1, expected.total()));
  struct Known {
    std::string_view name, other;  // words
    double expected;
  };
  const Known all[] = {
      {"eye", "primary", double(expected.eye)},
      {"eye_hits", "hits", double(expected.eye_hits)},
      {"reflection", "reflected", double(expected.reflection)},
      {"refraction", "refracted", double(expected.refraction)},
      {"shadow", "shadows", double(expected.shadow)},
      {"shadow_hits", "occluded", double(expected.shadow_hits)},
      {"tests", "tests_per_ray", double(expected.tests) / rays},
      {"steps", "steps_per_ray", double(expected.steps) / rays},
  };
  std::vector<Grade::Count> counts;
  for (const Known& known : all) {
    auto found = number_after(text, known.name);
    if (!found) found = number_after(text, known.other);
    counts.push_back({known.name, known.expected, found});
  }
  return counts;
}

std::string grade_text(const Grade& grade, const GradeCommand& command) {
  std::string text =
      fmt::format("{} of {}: {}\n", command.student, grade.scene, size_text(grade.size));
  if (!grade.errors) {
    text += fmt::format(
        "expected {} pixels{}\n", size_text(grade.expected_size),
        grade.size[0] == grade.expected_size[1] && grade.size[1] == grade.expected_size[0]
            ? "; width and height are exchanged"
            : "");
  } else {
    text +=
        errors_text(*grade.errors, command, double(grade.size[0]) * grade.size[1], grade.passed);
    text += advice(grade);
  }
  if (!grade.counts.empty()) text += counts_text(grade.counts);
  if (grade.first)
    text += "\n" + pixel_text("first wrong pixel", *grade.first) +
            pixel_text("worst pixel", *grade.worst) + "\nThe first one in Raio's picture:\n\n" +
            grade.first->text;
  return text;
}

std::string grade_json(const Grade& grade, const GradeCommand& command) {
  Json json{{"version", RAIO_VERSION},
            {"scene", grade.scene},
            {"student", command.student},
            {"reference", command.reference.empty() ? Json(nullptr) : Json(command.reference)},
            {"size", grade.size},
            {"expected_size", grade.expected_size},
            {"threshold", command.threshold},
            {"tolerance", command.tolerance},
            {"passed", grade.passed}};
  json["errors"] = nullptr;
  if (const auto& e = grade.errors) {
    json["errors"] = {
        {"rmse", e->difference.rmse},
        {"mean", e->mean},
        {"largest", e->difference.largest},
        {"wrong_pixels", e->wrong},
        {"wrong_share", double(e->wrong) / std::max(1.0, double(grade.size[0]) * grade.size[1])}};
  }
  json["causes"] = Json::array();
  for (const Cause& cause : grade.causes) json["causes"].push_back(json_of(cause));
  json["region"] = grade.region ? Json(kRegionNames[size_t(*grade.region)]) : Json(nullptr);
  json["first_wrong"] = json_of(grade.first);
  json["worst"] = json_of(grade.worst);
  json["counts"] = grade.counts.empty() ? Json(nullptr) : Json::object();
  for (const Grade::Count& count : grade.counts)
    json["counts"][std::string(count.name)] = {
        {"expected", count.expected}, {"found", count.found ? Json(*count.found) : Json(nullptr)}};
  return json_text(json);
}

}  // namespace raio::core::app
