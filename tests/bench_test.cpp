#include "app/bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/bench_report.h"
#include "app/plot.h"
#include "io/image/image.h"

namespace raio::core::app {
namespace {

using testing::HasSubstr;

constexpr EffectSet kAa = effect_named("aa"), kSoft = effect_named("soft_shadows"),
                    kDof = effect_named("dof"), kAll = kAa | kSoft | kDof;

BenchmarkRequest asking_for(std::vector<AccelKind> structures, EffectSet effects = kAll) {
  BenchmarkRequest request;
  request.structures = std::move(structures), request.effects = effects;
  return request;
}

// Seconds that are easy to check by eye: the samples per pixel, eight times that without structure.
BenchmarkTable sample_table(const std::string& scene = "balls_medium",
                            const BenchmarkRequest& request = {}) {
  BenchmarkTable table;
  table.version = "1.2.3";
  table.scene = scene;
  table.machine = "Some Processor 9000";
  table.width = table.height = 512;
  table.threads = 2, table.depth = 5, table.repeat = 3, table.seed = 7;
  table.structures = {{{.name = "none", .bytes = 4000}, 1e-5},
                      {{.name = "grid", .bytes = 9000, .cells = 729, .references = 1931}, 2e-4},
                      {{.name = "bvh", .bytes = 7000, .cells = 20, .references = 91}, 1e-4}};
  table.disagreement = 0.0005;
  table.effects = request.effects;
  for (const Combination& c : combinations(request)) {
    const int samples = samples_per_pixel(c.effects);
    const double s = samples * (c.accel == AccelKind::none ? 0.08 : 0.01);
    table.rows.push_back({c, {s * 3, s, s / 3}, uint64_t(1'000'000) * uint64_t(samples)});
  }
  return table;
}

// The report's own seconds as if they had been measured.
BenchmarkTable report_as_table(const std::string& scene) {
  BenchmarkTable table = sample_table(scene);
  for (BenchmarkRow& row : table.rows) {
    const auto time = report_time(scene, row.combination);
    row.runs_s.assign(3, time ? time->seconds : 1);
  }
  return table;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// For UTF-8 with characters that are one column wide.
size_t columns(const std::string& line) {
  return size_t(std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; }));
}

TEST(Benchmark, HasAllCombinationsWithTheReportsSamples) {
  const auto all = combinations({});
  std::multiset<int> samples;
  std::set<std::string> labels;
  for (const Combination& c : all) {
    samples.insert(samples_per_pixel(c.effects));
    labels.insert(short_label(c));
  }
  EXPECT_EQ(labels.size(), 24u);
  for (const int n : {1, 3, 9, 27}) EXPECT_EQ(samples.count(n), 6u) << n;
  EXPECT_EQ(all.front(), Combination{AccelKind::none});
  EXPECT_EQ(all[1], (Combination{AccelKind::none, kDof}));
  EXPECT_EQ(all[15], (Combination{AccelKind::grid, kAll}));
  EXPECT_EQ(all.back(), (Combination{AccelKind::bvh, kAll}));
  EXPECT_EQ(short_label({AccelKind::grid, kAa | kDof}), "grid AA DOF");
}

TEST(Benchmark, CombinesTheChosenAndAlwaysHasThePlainRow) {
  const auto chosen = combinations(asking_for({AccelKind::bvh, AccelKind::grid}, kAa | kSoft));
  const std::vector<Combination> expected = {
      {AccelKind::bvh, 0},           {AccelKind::bvh, kSoft},       {AccelKind::bvh, kAa},
      {AccelKind::bvh, kAa | kSoft}, {AccelKind::grid, 0},          {AccelKind::grid, kSoft},
      {AccelKind::grid, kAa},        {AccelKind::grid, kAa | kSoft}};
  EXPECT_EQ(chosen, expected);
  EXPECT_EQ(combinations(asking_for({AccelKind::embree}, 0)),
            std::vector<Combination>{{AccelKind::embree}});
}

Scene one_ball() {
  Scene scene;
  scene.name = "ball";
  scene.camera.from = {0, 0, 5}, scene.camera.up = {0, 1, 0};
  scene.camera.width = scene.camera.height = 16;
  scene.lights = {{{3, 3, 3}, std::nullopt}};
  scene.materials = {{{1, 1, 1}, 0.9f, 0, 1, 0, 1}};
  scene.spheres = {{{0, 0, 0}, 1}};
  scene.sphere_materials = {0};
  return scene;
}

// An effect's line states its number of samples; its function must request as many.
TEST(Benchmark, EffectsMultiplySamples) {
  Scene scene = one_ball();
  scene.moving_spheres = std::vector<MovingSphere>{{{0, 0, 0}, {1, 0, 0}, 0.1f}};
  scene.moving_sphere_materials = std::vector<MaterialId>{0};
  for (const BenchmarkEffect& effect : kBenchmarkEffects) {
    RenderOptions options;
    options.aa = options.lens_samples = 1;
    options = with_effect(options, effect.effect, true, scene);
    EXPECT_EQ(options.samples_per_pixel(), effect.samples) << effect.name;
    EXPECT_TRUE(is_on(effect.effect, options, scene)) << effect.name;
    options = with_effect(options, effect.effect, false, scene);
    EXPECT_EQ(options.samples_per_pixel(), 1) << effect.name;
    EXPECT_FALSE(is_on(effect.effect, options, scene)) << effect.name;
  }
}

TEST(Benchmark, SpreadIsMinimumMedianAndMaximum) {
  BenchmarkRow row{{}, {9, 1, 2}, 100};
  EXPECT_EQ(row.seconds().least, 1);
  EXPECT_EQ(row.seconds().median, 2);
  EXPECT_EQ(row.seconds().most, 9);
  EXPECT_EQ(row.seconds().half_width(), 2);  // 4 either way, of 2
  EXPECT_EQ(row.rays_per_s(), 50);
  row.runs_s.push_back(4);
  EXPECT_EQ(row.seconds().median, 3);
}

// A machine that becomes ten times slower from round to round, all rows alike.
TEST(Benchmark, CostIsMeasuredWithinARound) {
  BenchmarkTable table = sample_table();
  for (BenchmarkRow& row : table.rows) {
    const double s = row.runs_s[1];
    row.runs_s = {s, 10 * s, 100 * s};
    const Spread cost = table.relative_cost(row);
    for (const double value : {cost.least, cost.median, cost.most})
      EXPECT_DOUBLE_EQ(value, samples_per_pixel(row.combination.effects));
    EXPECT_GT(row.seconds().half_width(), 4);
  }
}

TEST(Benchmark, RefusesStructuresWithDifferentPictures) {
  const Image a(100, 100);
  Image b = a;
  for (int i = 0; i < 10; ++i) b.at(i, 50) = Rgb(1);
  EXPECT_EQ(check_agreement(AccelKind::grid, a, AccelKind::none, b), 0.001);
  b.at(10, 50) = Rgb(1);
  const auto refused = check_agreement(AccelKind::bvh, a, AccelKind::grid, b);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), HasSubstr("bvh and grid"));
  EXPECT_THAT(refused.error(), HasSubstr("0.11 %"));
}

TEST(Benchmark, RunsGoInRoundsWithBruteForceLast) {
  const Scene scene = one_ball();
  WorkControl control;
  std::vector<std::string> steps;
  BenchmarkRequest request = asking_for({AccelKind::none, AccelKind::bvh}, kAa);
  request.repeat = 2;
  const auto table = measure_benchmark(scene, request, control, [&](const BenchmarkStep& step) {
    steps.push_back(std::to_string(step.number) + " " + short_label(step.combination));
    EXPECT_EQ(step.count, step.number > 0 ? 8 : 0);
  });
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(steps,
              testing::ElementsAre("0 none", "0 bvh", "1 bvh", "2 bvh AA", "3 bvh", "4 bvh AA",
                                   "5 none", "6 none AA", "7 none", "8 none AA"));
  EXPECT_EQ(table->disagreement, 0);
  ASSERT_EQ(table->rows.size(), 4u);
  EXPECT_EQ(table->rows[0].combination, Combination{AccelKind::none});
  for (const BenchmarkRow& row : table->rows) {
    EXPECT_EQ(row.runs_s.size(), 2u);
    EXPECT_GE(row.rays, 16u * 16u * uint64_t(samples_per_pixel(row.combination.effects)));
  }
}

TEST(Benchmark, ASingleStructureIsNotCompared) {
  const Scene scene = one_ball();
  WorkControl control;
  const auto table = measure_benchmark(scene, asking_for({AccelKind::grid}, 0), control);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_FALSE(table->disagreement);
  EXPECT_EQ(table->rows.size(), 1u);
  EXPECT_THAT(table_text(*table), HasSubstr("could not be compared"));
  EXPECT_TRUE(nlohmann::json::parse(table_json(*table))["disagreement"].is_null());
}

// Sizes, samples and views of the request give way to the effects'; nothing else does.
TEST(Benchmark, EffectsDecideOnSamples) {
  const Scene scene = one_ball();
  WorkControl control;
  BenchmarkRequest request = asking_for({AccelKind::bvh}, 0);
  request.options.samples = 64, request.options.dof = true, request.options.view = View::steps;
  request.options.width = request.options.height = 8;
  const auto table = measure_benchmark(scene, request, control);
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->width, 8);
  EXPECT_LT(table->rows[0].rays, 3u * 8u * 8u);  // an eye ray a pixel, and a shadow ray at most
}

// A mirror that reflects a sky, on a floor.
Scene mirror_ball() {
  Scene scene = one_ball();
  scene.materials = std::vector<Material>{{{1, 1, 1}, 0.2f, 0.8f, 10, 0, 1}};
  scene.spheres = std::vector<Sphere>{{{0, 0, 0}, 1}, {{0, -101, 0}, 100}};
  scene.sphere_materials = std::vector<MaterialId>{0, 0};
  return scene;
}

TEST(Benchmark, GlossHasRowsOnRequest) {
  const Scene scene = mirror_ball();
  WorkControl control;
  BenchmarkRequest request = asking_for({AccelKind::bvh}, kDof | effect_named("gloss"));
  EXPECT_EQ(absence_of_effects(request, scene), "");
  const auto table = measure_benchmark(scene, request, control);
  ASSERT_TRUE(table) << table.error().message;
  std::vector<std::string> labels;
  for (const BenchmarkRow& row : table->rows) labels.push_back(short_label(row.combination));
  EXPECT_THAT(labels, testing::ElementsAre("bvh", "bvh gloss", "bvh DOF", "bvh DOF gloss"));
  EXPECT_THAT(table_text(*table), HasSubstr("DOF gloss"));
  EXPECT_THAT(lines_of(table_csv(*table))[0], HasSubstr(",dof,gloss,samples_per_pixel,"));
  EXPECT_THAT(lines_of(table_csv(*table))[2], HasSubstr(",bvh,0,0,0,1,1,"));
  const auto rows = nlohmann::json::parse(table_json(*table))["rows"];
  EXPECT_EQ(rows[1]["effects"]["gloss"], true);
  EXPECT_EQ(rows[2]["effects"]["gloss"], false);
  EXPECT_FALSE(rows[0]["effects"].contains("translucency"));
  EXPECT_TRUE(rows[1]["relative_cost_max"].is_number());
}

// An effect that is not combined is in all rows, as the options say.
TEST(Benchmark, GlossIsUnchangedUnlessCombined) {
  Scene scene = mirror_ball();
  WorkControl control;
  BenchmarkRequest request = asking_for({AccelKind::bvh}, 0);
  const auto plain = measure_benchmark(scene, request, control);
  request.options.gloss = 0.5f;
  const auto rough = measure_benchmark(scene, request, control);
  ASSERT_TRUE(plain && rough);
  EXPECT_NE(rough->rows[0].rays, plain->rows[0].rays) << "spread rays hit something else";
  EXPECT_EQ(lines_of(table_csv(*rough))[0].find("gloss"), std::string::npos);
}

TEST(BenchLists, RefuseEffectsMissingFromTheScene) {
  for (const char* name : {"gloss", "translucency", "motion"}) {
    const BenchmarkRequest request = asking_for({AccelKind::bvh}, kAa | effect_named(name));
    EXPECT_THAT(absence_of_effects(request, one_ball()),
                HasSubstr(std::string(name) + " has no effect on a scene without"));
  }
  EXPECT_EQ(absence_of_effects({}, one_ball()), "");
  BenchmarkRequest request = asking_for({AccelKind::bvh}, effect_named("gloss"));
  request.options.gloss = 0.0f;
  EXPECT_THAT(bench_conflict(request), HasSubstr("--gloss 0 cannot be combined with gloss"));
  request.options.gloss = 0.2f;
  EXPECT_EQ(bench_conflict(request), "");
  request = asking_for({AccelKind::bvh}, effect_named("motion"));
  request.options.shutter = {1.0f, 1.0f};
  EXPECT_THAT(bench_conflict(request), HasSubstr("closes when it opens"));
}

TEST(Benchmark, StopsOnRequest) {
  const Scene scene = one_ball();
  WorkControl control;
  const auto stopped = measure_benchmark(scene, {}, control, [&](const BenchmarkStep& step) {
    if (step.number == 3) control.stop = true;
  });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, BenchmarkFailure::stopped);
  EXPECT_EQ(stopped.error().message, "");
}

TEST(BenchLists, StructuresAndEffects) {
  EXPECT_EQ(parse_structures("grid,bvh"), (std::vector{AccelKind::grid, AccelKind::bvh}));
  EXPECT_EQ(parse_structures("embree"), std::vector{AccelKind::embree});
  for (const char* bad : {"", "grid,", "grid,grid", "auto", "grid bvh"}) {
    const auto refused = parse_structures(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_THAT(refused.error(), HasSubstr("found '" + std::string(bad) + "'"));
    EXPECT_THAT(refused.error(), HasSubstr("none, grid, bvh, embree"));
  }
  EXPECT_EQ(parse_effects("none"), EffectSet(0));
  EXPECT_EQ(parse_effects("dof,aa"), kAa | kDof);
  EXPECT_EQ(parse_effects("soft-shadows"), kSoft);
  for (const char* bad : {"", "none,aa", "soft_shadows", "aa,aa"}) {
    const auto refused = parse_effects(bad);
    ASSERT_FALSE(refused) << bad;
    EXPECT_THAT(refused.error(), HasSubstr("aa, soft-shadows, dof"));
  }
}

TEST(BenchLists, RefuseOptionsWithoutTimedEffects) {
  BenchmarkRequest request;
  request.options.accel.grid_factor = 2, request.options.light_size = 1;
  request.options.aperture = 1, request.options.focus = 1;
  EXPECT_EQ(bench_conflict(request), "");
  request.structures = {AccelKind::bvh};
  EXPECT_THAT(bench_conflict(request), HasSubstr("--grid-factor has no effect without grid"));
  request.options.accel.grid_factor = 0, request.effects = kAa | kDof;
  EXPECT_THAT(bench_conflict(request),
              HasSubstr("--light-size has no effect without soft-shadows"));
  request.options.light_size = 0, request.effects = kAa;
  EXPECT_THAT(bench_conflict(request), HasSubstr("--aperture has no effect without dof"));
  request.options.aperture = 0;
  EXPECT_THAT(bench_conflict(request), HasSubstr("--focus has no effect without dof"));
  request.options.focus = 0;
  EXPECT_EQ(bench_conflict(request), "");
}

TEST(Report, KnowsItsSixteenTimesWithTheirDigits) {
  const BenchmarkTable table = sample_table();
  const auto text = [&](AccelKind accel, EffectSet effects) {
    const auto time = report_time(table, *table.find({accel, effects}));
    return time ? time->text() : "";
  };
  // One of each group of the report's table, and those with effects that are easily confused.
  EXPECT_EQ(text(AccelKind::none, 0), "24.251");
  EXPECT_EQ(text(AccelKind::none, kDof), "67.004");
  EXPECT_EQ(text(AccelKind::none, kAa), "198.190");
  EXPECT_EQ(text(AccelKind::none, kSoft), "26.352");
  EXPECT_EQ(text(AccelKind::none, kSoft | kAa), "222.732");
  EXPECT_EQ(text(AccelKind::grid, kAa | kDof), "95.047");
  EXPECT_EQ(text(AccelKind::grid, kSoft | kDof), "12.335");
  EXPECT_EQ(text(AccelKind::grid, kAll), "98.400");
  for (const EffectSet effects : {EffectSet(0), kAa, kAll})
    EXPECT_EQ(text(AccelKind::bvh, effects), "");
  EXPECT_EQ(
      std::ranges::count_if(table.rows, [&](auto& r) { return report_time(table, r).has_value(); }),
      16);
  BenchmarkTable other = table;
  other.width = 256;
  EXPECT_FALSE(report_knows(other));
  EXPECT_FALSE(report_knows(sample_table("balls_low")));
}

TEST(Report, KnowsBallsHighRoughly) {
  const auto none = report_time("balls_high", {AccelKind::none});
  ASSERT_TRUE(none);
  EXPECT_EQ(none->text(), ">3600");
  EXPECT_EQ(report_time("balls_high", {AccelKind::grid})->text(), "12");
  EXPECT_FALSE(report_time("balls_high", {AccelKind::grid, kAa}));
}

TEST(Report, CostAndSpeedupAreQuotients) {
  const BenchmarkTable table = sample_table();
  const BenchmarkRow& aa = *table.find({AccelKind::grid, kAa});
  EXPECT_DOUBLE_EQ(*report_cost(table, aa), 32.634 / 4.507);
  EXPECT_DOUBLE_EQ(*speedup(table, aa), 32.634 / 0.09);
  EXPECT_EQ(report_cost(table, *table.find({AccelKind::none})), 1);
  EXPECT_FALSE(report_cost(table, *table.find({AccelKind::bvh, kAa})));
  EXPECT_FALSE(speedup(table, *table.find({AccelKind::bvh})));
}

std::vector<Verdict> verdicts(const BenchmarkTable& table) {
  std::vector<Verdict> found;
  for (const ReportClaim& claim : report_claims(table)) found.push_back(claim.verdict);
  return found;
}

constexpr Verdict kYes = Verdict::confirmed, kNo = Verdict::corrected, kOpen = Verdict::unknown;

// Measurements equal to the report's confirm its claims, except for its "six times".
TEST(Report, JudgesItsOwnFigures) {
  EXPECT_THAT(verdicts(report_as_table("balls_medium")),
              testing::ElementsAre(kOpen, kYes, kYes, kNo, kYes));
  EXPECT_THAT(verdicts(report_as_table("balls_high")),
              testing::ElementsAre(kYes, kOpen, kOpen, kOpen, kOpen));
  EXPECT_TRUE(verdicts(report_as_table("balls_low")).empty());
  const auto claims = report_claims(report_as_table("balls_medium"));
  EXPECT_EQ(claims[0].report, ">3600 s / 12 s = >300 x");
  EXPECT_EQ(claims[0].ours, "");
  EXPECT_EQ(
      claims[1].report,
      "no grid: AA 8.17 x, DOF 2.76 x, soft 1.09 x; grid: AA 7.24 x, DOF 2.64 x, soft 1.01 x");
  EXPECT_EQ(claims[1].ours, claims[1].report);
  EXPECT_EQ(claims[2].report, "no grid: 1.02 to 1.12 x; grid: 1.01 to 1.04 x");
  EXPECT_EQ(claims[3].report, "24.251 s / 4.507 s = 5.38 x");
  EXPECT_EQ(claims[3].ours, "24.3 s / 4.51 s = 5.38 x");
  EXPECT_EQ(claims[4].report, "608.145 s / 98.400 s = 6.18 x, without effects 5.38 x");
}

void multiply(BenchmarkTable& table, const Combination& combination, double factor) {
  for (BenchmarkRow& row : table.rows)
    if (row.combination == combination)
      for (double& s : row.runs_s) s *= factor;
}

// Each verdict changes with its figures.
TEST(Report, VerdictsFollowTheFigures) {
  const BenchmarkTable medium = report_as_table("balls_medium");
  BenchmarkTable table = medium;
  multiply(table, {AccelKind::grid, kDof}, 3);  // now dearer than antialiasing
  EXPECT_EQ(verdicts(table)[1], kNo);
  table = medium;
  multiply(table, {AccelKind::grid, kAa | kSoft}, 1.2);
  EXPECT_EQ(verdicts(table)[2], kNo);
  table = medium;
  for (BenchmarkRow& row : table.rows)
    if (row.combination.accel == AccelKind::none) multiply(table, row.combination, 6 / 5.38);
  EXPECT_EQ(verdicts(table)[3], kYes);
  table = medium;
  multiply(table, {AccelKind::grid, kAll}, 1.3);  // 4.75 of 5.38 are left
  EXPECT_EQ(verdicts(table)[4], kNo);
  table = report_as_table("balls_high");
  multiply(table, {AccelKind::none}, 3);
  EXPECT_EQ(verdicts(table)[0], kNo);
}

TEST(Report, UndecidedWithoutRows) {
  BenchmarkTable grid_alone = sample_table("balls_medium", asking_for({AccelKind::grid}));
  EXPECT_THAT(verdicts(grid_alone), testing::ElementsAre(kOpen, kYes, kYes, kOpen, kOpen));
  EXPECT_THAT(
      verdicts(sample_table("balls_medium", asking_for({AccelKind::none, AccelKind::grid}, kSoft))),
      testing::ElementsAre(kOpen, kOpen, kYes, kNo, kOpen));
  EXPECT_THAT(table_text(grid_alone), HasSubstr("cannot be told from these rows"));
}

TEST(Bench, ThreeDigits) {
  EXPECT_EQ(three_digits(0.01234), "0.0123");
  EXPECT_EQ(three_digits(4.5), "4.50");
  EXPECT_EQ(three_digits(98.44), "98.4");
  EXPECT_EQ(three_digits(1260.4), "1260");
}

TEST(Bench, TextIsAlignedAndShowsKnownValues) {
  const auto lines = lines_of(table_text(sample_table()));
  for (const std::string& line : lines) {
    EXPECT_LE(columns(line), 100u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  for (const char* part : {"balls_medium", "512x512", "depth 5", "2 threads", "raio 1.2.3"})
    EXPECT_THAT(lines[0], HasSubstr(part));
  EXPECT_THAT(lines[1], HasSubstr("Some Processor 9000"));

  std::vector<std::string> rows(lines.begin() + 6, lines.begin() + 32);
  std::erase(rows, "");
  ASSERT_EQ(rows.size(), 24u);
  for (const std::string& row : rows) EXPECT_EQ(columns(row), columns(rows[0])) << row;
  for (const char* part : {"no grid ", " none ", " 24.251 ", " 303 x "})  // 24.251 s over 0.08 s
    EXPECT_THAT(rows[0], HasSubstr(part));
  for (const char* part : {"grid ", "AA soft DOF", " 27 ", " 98.400 ", " 0.270 ", " 21.8 x",
                           " 27.0 x", "±133%", "±0.0%", " 364 x "})
    EXPECT_THAT(rows[15], HasSubstr(part));
  EXPECT_TRUE(rows[16].starts_with("bvh "));
  EXPECT_THAT(rows[16], HasSubstr(" - "));
}

TEST(Bench, TextOmitsUnknownColumns) {
  BenchmarkTable table =
      sample_table("unheard_of", asking_for({AccelKind::none, AccelKind::grid}, kAa));
  table.repeat = 1;
  for (BenchmarkRow& row : table.rows) row.runs_s.resize(1);
  const std::string text = table_text(table);
  for (const char* part : {"report", "±", "soft", "claims", "rounds"})
    EXPECT_THAT(text, testing::Not(HasSubstr(part)));
  EXPECT_THAT(text, HasSubstr("9.00 x"));
}

TEST(Bench, CsvHasOneFieldForEachName) {
  const auto lines = lines_of(table_csv(sample_table("my \"best\"")));
  ASSERT_EQ(lines.size(), 25u);
  const auto commas = std::ranges::count(lines[0], ',');
  for (const std::string& line : lines) EXPECT_EQ(std::ranges::count(line, ','), commas) << line;
  EXPECT_TRUE(lines[1].starts_with("\"my \"\"best\"\"\",512,512,5,2,none,0,0,0,1,,,3,0.08,"))
      << lines[1];
  const auto known = lines_of(table_csv(sample_table()));
  EXPECT_THAT(known[16], HasSubstr(",grid,1,1,1,27,98.4,0,3,0.27,0.09"));
  EXPECT_TRUE(known[16].ends_with(",27,27,27.000000000000004")) << known[16];
  EXPECT_THAT(lines_of(table_csv(sample_table("balls_high")))[1], HasSubstr(",1,3600,1,3,"));
}

TEST(Bench, JsonHasTheWholeTable) {
  const auto json = nlohmann::json::parse(table_json(sample_table()));
  EXPECT_EQ(json["scene"], "balls_medium");
  EXPECT_EQ(json["resolution"], (nlohmann::json{512, 512}));
  EXPECT_EQ(json["accelerators"][1]["cells"], 729);
  ASSERT_EQ(json["rows"].size(), 24u);
  const auto& plain = json["rows"][0];
  EXPECT_EQ(plain["accelerator"], "none");
  EXPECT_EQ(plain["report_s"], 24.251);
  EXPECT_EQ(plain["report_more_than"], false);
  EXPECT_EQ(plain["report_cost"], 1);
  EXPECT_EQ(json["rows"][1]["effects"],
            (nlohmann::json{{"aa", false}, {"soft_shadows", false}, {"dof", true}}));
  const auto& all = json["rows"][15];
  EXPECT_EQ(all["runs_s"].size(), 3u);
  EXPECT_EQ(all["runs"], 3);
  EXPECT_EQ(all["samples_per_pixel"], 27);
  EXPECT_DOUBLE_EQ(all["seconds_min"].get<double>(), 0.09);
  EXPECT_DOUBLE_EQ(all["seconds"].get<double>(), 0.27);
  EXPECT_DOUBLE_EQ(all["seconds_max"].get<double>(), 0.81);
  EXPECT_DOUBLE_EQ(all["report_cost"].get<double>(), 98.4 / 4.507);
  for (const char* cost : {"relative_cost", "relative_cost_min", "relative_cost_max"})
    EXPECT_DOUBLE_EQ(all[cost].get<double>(), 27) << cost;
  const auto& tree = json["rows"][23];
  EXPECT_EQ(tree["accelerator"], "bvh");
  for (const char* unknown : {"report_s", "report_more_than", "report_cost", "speedup"})
    EXPECT_TRUE(tree[unknown].is_null()) << unknown;
  ASSERT_EQ(json["claims"].size(), 5u);
  EXPECT_EQ(json["claims"][0]["verdict"], "cannot be told from these rows");
  EXPECT_TRUE(json["claims"][0]["ours"].is_null());
  EXPECT_EQ(json["claims"][3]["ours"], "0.0800 s / 0.0100 s = 8.00 x");
  EXPECT_EQ(json["claims"][3]["verdict"], "corrected");
  EXPECT_TRUE(nlohmann::json::accept(table_json(sample_table("no\xff utf-8"))));
}

TEST(Plot, FormatIsTheSuffix) {
  EXPECT_EQ(plot_format("a/b.png"), PlotFormat::png);
  EXPECT_EQ(plot_format("B.SVG"), PlotFormat::svg);
  EXPECT_EQ(plot_format("x.y.pdf"), PlotFormat::pdf);
  for (const char* bad : {"x", "x.jpg", "-", ".png"}) {
    const auto format = plot_format(bad);
    ASSERT_FALSE(format) << bad;
    EXPECT_THAT(format.error(), HasSubstr(".svg"));
  }
}

TEST(Plot, VectorFilesAreWhole) {
  const auto svg = draw_plot(sample_table(), PlotFormat::svg);
  ASSERT_TRUE(svg) << svg.error();
  EXPECT_THAT(*svg, HasSubstr("<svg"));
  EXPECT_THAT(*svg, HasSubstr("</svg>"));
  const auto pdf = draw_plot(sample_table(), PlotFormat::pdf);
  ASSERT_TRUE(pdf) << pdf.error();
  EXPECT_TRUE(pdf->starts_with("%PDF-"));
  EXPECT_THAT(pdf->substr(pdf->size() - 10), HasSubstr("%%EOF"));
}

class PlotPicture : public testing::Test {
 protected:
  PlotPicture() {
    path_ = std::filesystem::temp_directory_path() / "raio_plot_";
    path_ += std::to_string(getpid());
  }
  ~PlotPicture() override { std::filesystem::remove(path_); }

  Image draw(const BenchmarkTable& table) {
    const auto png = draw_plot(table, PlotFormat::png);
    EXPECT_TRUE(png) << png.error();
    EXPECT_TRUE(write_file(path_, *png));
    auto image = read_image(path_);
    EXPECT_TRUE(image) << image.error().message;
    return *image;
  }

  std::filesystem::path path_;
};

bool has_bytes(Rgb p, int r, int g, int b) {
  return to_byte(p.x) == r && to_byte(p.y) == g && to_byte(p.z) == b;
}

TEST_F(PlotPicture, ShowsBarsAndTheReportIfKnown) {
  const auto is_report = [](Rgb p) { return has_bytes(p, 213, 94, 0); };
  const auto is_grid = [](Rgb p) { return has_bytes(p, 0, 114, 178); };
  const auto is_tree = [](Rgb p) { return has_bytes(p, 0, 158, 115); };
  const Image known = draw(sample_table());
  EXPECT_EQ(known.width, 1600);
  EXPECT_EQ(known.height, 1000);
  EXPECT_GT(std::ranges::count_if(known.pixels, is_report), 300);
  const auto bars = std::ranges::count_if(known.pixels, is_grid);
  EXPECT_GT(bars, 10000);
  EXPECT_GT(std::ranges::count_if(known.pixels, is_tree), 10000);

  const Image unknown = draw(sample_table("unheard_of"));
  EXPECT_EQ(std::ranges::count_if(unknown.pixels, is_report), 0);
}

// The report's diamonds are in both panels, among seconds and among costs.
TEST_F(PlotPicture, ShowsCostsNextToTheReports) {
  const auto count = [](const Image& image, int from, int to, int r, int g, int b) {
    int found = 0;
    for (int y = 200; y < 880; ++y)
      for (int x = from; x < to; ++x) found += has_bytes(image.at(x, y), r, g, b);
    return found;
  };
  const Image known = draw(sample_table()), unknown = draw(sample_table("unheard_of"));
  for (const auto& [from, to] :
       {std::pair(430, 1040), std::pair(1060, 1385), std::pair(1385, 1470)}) {
    EXPECT_GT(count(known, from, to, 213, 94, 0), 300) << from;
    EXPECT_EQ(count(unknown, from, to, 213, 94, 0), 0) << from;
  }
  EXPECT_GT(count(unknown, 1060, 1385, 0, 114, 178), 300);
}

TEST_F(PlotPicture, FitsFewAndManyRows) {
  const std::vector every = {AccelKind::none, AccelKind::grid, AccelKind::bvh, AccelKind::embree};
  const auto is_embree = [](Rgb p) { return has_bytes(p, 204, 121, 167); };
  for (const BenchmarkRequest& request : {asking_for(every), asking_for({AccelKind::embree}, 0)}) {
    const Image image = draw(sample_table("balls_medium", request));
    EXPECT_GT(std::ranges::count_if(image.pixels, is_embree), 300);
    for (int x = 0; x < image.width; ++x)
      EXPECT_TRUE(has_bytes(image.at(x, image.height - 3), 255, 255, 255)) << x;
  }
}

TEST_F(PlotPicture, KeepsItsMargins) {
  BenchmarkTable table = sample_table();
  table.machine = std::string(300, 'M');
  for (const char* scene : {"balls_medium", "balls_high", ""})
    for (const double factor : {1e-4, 1.0, 300.0, 1e5}) {
      BenchmarkTable scaled = table;
      scaled.scene = *scene ? scene : std::string(200, 'W') + "\xff";
      for (BenchmarkRow& row : scaled.rows)
        for (double& s : row.runs_s) s *= factor;
      const Image image = draw(scaled);
      for (int y = 0; y < image.height; ++y)
        for (const int x : {2, image.width - 3}) {
          EXPECT_TRUE(has_bytes(image.at(x, y), 255, 255, 255)) << factor << ": " << x << " " << y;
        }
    }
}

}  // namespace
}  // namespace raio::core::app
