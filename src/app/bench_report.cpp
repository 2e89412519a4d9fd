#include "app/bench_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/bench.h"

namespace raio::core::app {

namespace {

constexpr std::string_view kMedium = "balls_medium", kHigh = "balls_high";
constexpr int kReportSide = 512;

constexpr EffectSet kAa = effect_named("aa"), kSoft = effect_named("soft_shadows"),
                    kDof = effect_named("dof"), kAll = kAa | kSoft | kDof;
static_assert(kAa != 0 && kSoft != 0 && kDof != 0);

// Seconds of balls_medium in the order of the report's table: effects count in binary, depth of
// field fastest, then antialiasing, then soft shadows; first without grid, then with it.
constexpr std::array<double, 16> kMediumSeconds = {
    24.251, 67.004, 198.190, 596.887, 26.352, 70.007, 222.732, 608.145,
    4.507,  11.897, 32.634,  95.047,  4.543,  12.335, 33.084,  98.400};

// A known time of a combination, the report's or ours.
struct Known {
  double seconds;
  std::string text;  // "24.251 s"
  bool more_than;
};

// The times of a scene: the report's, or those of a table.
class Times {
 public:
  explicit Times(std::string_view scene, const BenchmarkTable* table = nullptr)
      : scene_(scene), table_(table) {}

  std::optional<Known> operator()(AccelKind accel, EffectSet effects) const {
    if (table_) {
      const BenchmarkRow* const row = row_of({accel, effects});
      if (!row) return std::nullopt;
      const double seconds = row->seconds().median;
      return Known{seconds, three_digits(seconds) + " s", false};
    }
    const auto time = report_time(scene_, {accel, effects});
    if (!time) return std::nullopt;
    return Known{time->seconds, time->text() + " s", time->more_than};
  }

  /// The ratio of times with the first effects to those with the others.
  std::optional<double> ratio(AccelKind accel, EffectSet effects, EffectSet others = 0) const {
    if (table_) {
      const auto *row = row_of({accel, effects}), *base = row_of({accel, others});
      return row && base ? std::optional(ratio_of(*row, *base).median) : std::nullopt;
    }
    const auto time = report_time(scene_, {accel, effects}),
               base = report_time(scene_, {accel, others});
    return time && base ? std::optional(time->seconds / base->seconds) : std::nullopt;
  }

 private:
  const BenchmarkRow* row_of(const Combination& c) const {
    return scene_ == table_->scene ? table_->find(c) : nullptr;
  }

  std::string_view scene_;
  const BenchmarkTable* table_;
};

// The evidence for a claim: a number to judge it by, and the details as text.
struct Figure {
  double value;
  std::string text;
};

std::optional<Figure> gain(const Times& times, EffectSet effects) {
  const auto without = times(AccelKind::none, effects), with = times(AccelKind::grid, effects);
  if (!without || !with) return std::nullopt;
  const double value = without->seconds / with->seconds;
  return Figure{value, fmt::format("{} / {} = {}{} x", without->text, with->text,
                                   without->more_than ? ">" : "", three_digits(value))};
}

std::optional<Figure> plain_gain(const Times& times) { return gain(times, 0); }

// The gain with all effects relative to that without any.
std::optional<Figure> gain_kept(const Times& times) {
  const auto all = gain(times, kAll), plain = gain(times, 0);
  if (!all || !plain) return std::nullopt;
  return Figure{all->value / plain->value,
                fmt::format("{}, without effects {} x", all->text, three_digits(plain->value))};
}

constexpr std::array<std::pair<AccelKind, std::string_view>, 2> kStructures = {
    {{AccelKind::none, "no grid"}, {AccelKind::grid, "grid"}}};

// Antialiasing's cost relative to the most expensive other effect, at its lowest.
std::optional<Figure> antialiasing_lead(const Times& times) {
  std::optional<Figure> found;
  for (const auto& [accel, name] : kStructures) {
    const auto aa = times.ratio(accel, kAa), soft = times.ratio(accel, kSoft),
               dof = times.ratio(accel, kDof);
    if (!aa || !soft || !dof) continue;
    const double lead = *aa / std::max(*soft, *dof);
    found =
        Figure{found ? std::min(found->value, lead) : lead,
               fmt::format("{}{}: AA {} x, DOF {} x, soft {} x", found ? found->text + "; " : "",
                           name, three_digits(*aa), three_digits(*dof), three_digits(*soft))};
  }
  return found;
}

// The largest factor by which soft shadows increase the time of a picture, whatever else is on.
std::optional<Figure> soft_shadow_cost(const Times& times) {
  std::optional<Figure> found;
  for (const auto& [accel, name] : kStructures) {
    std::vector<double> costs;
    for (const EffectSet others : {EffectSet(0), kAa, kDof, kAa | kDof})
      if (const auto cost = times.ratio(accel, others | kSoft, others)) costs.push_back(*cost);
    if (costs.empty()) continue;
    const auto [least, most] = std::ranges::minmax(costs);
    found = Figure{found ? std::max(found->value, most) : most,
                   fmt::format("{}{}: {} to {} x", found ? found->text + "; " : "", name,
                               three_digits(least), three_digits(most))};
  }
  return found;
}

struct ClaimSpec {
  std::string_view claim, scene;
  std::optional<Figure> (*figure)(const Times& times);
  /// Whether our figures confirm the claim.
  bool (*holds)(double ours, double reports);
};

// Numbers in words include everything that rounds to them. Soft shadows cost next to nothing if
// they cost no more than in the report; a gain is kept if it is at most a tenth smaller.
constexpr auto kClaims = std::to_array<ClaimSpec>({
    {"balls_high without effects: from more than an hour to 12 s by the grid, about 300 times",
     kHigh, plain_gain, [](double ours, double) { return std::lround(ours / 100) == 3; }},
    {"of the effects antialiasing costs most", kMedium, antialiasing_lead,
     [](double ours, double) { return ours > 1; }},
    {"soft shadows cost next to nothing", kMedium, soft_shadow_cost,
     [](double ours, double reports) { return ours <= reports; }},
    {"balls_medium without effects is \"six times\" as fast by the grid", kMedium, plain_gain,
     [](double ours, double) { return std::lround(ours) == 6; }},
    {"with all effects on, the grid gains as much as without", kMedium, gain_kept,
     [](double ours, double) { return ours > 0.9; }},
});

bool of_report_size(const BenchmarkTable& table) {
  return table.width == kReportSide && table.height == kReportSide;
}

}  // namespace

std::string ReportTime::text() const {
  return fmt::format("{}{:.{}f}", more_than ? ">" : "", seconds, decimals);
}

std::optional<ReportTime> report_time(std::string_view scene, const Combination& combination) {
  const auto [accel, effects] = combination;
  const bool grid = accel == AccelKind::grid;
  if ((!grid && accel != AccelKind::none) || (effects & ~kAll)) return std::nullopt;
  const auto bit = [&](EffectSet effect) { return size_t((effects & effect) != 0); };
  if (scene == kMedium)
    return ReportTime{kMediumSeconds[8 * size_t(grid) + 4 * bit(kSoft) + 2 * bit(kAa) + bit(kDof)]};
  if (scene == kHigh && effects == 0) return grid ? ReportTime{12, 0} : ReportTime{3600, 0, true};
  return std::nullopt;
}

std::optional<ReportTime> report_time(const BenchmarkTable& table, const BenchmarkRow& row) {
  if (!of_report_size(table)) return std::nullopt;
  return report_time(table.scene, row.combination);
}

std::optional<double> report_cost(const BenchmarkTable& table, const BenchmarkRow& row) {
  if (!of_report_size(table)) return std::nullopt;
  return Times(table.scene).ratio(row.combination.accel, row.combination.effects);
}

std::optional<double> speedup(const BenchmarkTable& table, const BenchmarkRow& row) {
  const auto time = report_time(table, row);
  return time ? std::optional(time->seconds / row.seconds().median) : std::nullopt;
}

bool report_knows(const BenchmarkTable& table) {
  return std::ranges::any_of(table.rows,
                             [&](const auto& row) { return report_time(table, row).has_value(); });
}

std::string_view verdict_words(Verdict verdict) {
  switch (verdict) {
    case Verdict::confirmed:
      return "confirmed";
    case Verdict::corrected:
      return "corrected";
    case Verdict::unknown:
      break;
  }
  return "cannot be told from these rows";
}

std::vector<ReportClaim> report_claims(const BenchmarkTable& table) {
  std::vector<ReportClaim> claims;
  if (!report_knows(table)) return claims;
  for (const ClaimSpec& spec : kClaims) {
    const Figure report = *spec.figure(Times(spec.scene));
    const auto ours = spec.figure(Times(spec.scene, &table));
    ReportClaim& claim = claims.emplace_back(spec.claim, report.text);
    if (!ours) continue;
    claim.ours = ours->text;
    claim.verdict = spec.holds(ours->value, report.value) ? Verdict::confirmed : Verdict::corrected;
  }
  return claims;
}

}  // namespace raio::core::app
