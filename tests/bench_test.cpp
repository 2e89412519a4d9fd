#include "app/bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app/plot.h"
#include "io/image/image.h"

namespace raio::app {
namespace {

using testing::HasSubstr;

// Seconds that are easy to check by eye: the samples a pixel, eight times that without structure.
BenchTable sample_table(const std::string& scene = "balls_medium") {
  BenchTable table;
  table.version = "1.2.3";
  table.scene = scene;
  table.machine = "Some Processor 9000";
  table.width = table.height = 512;
  table.threads = 2, table.depth = 5, table.repeat = 3, table.seed = 7;
  table.structures = {{{.name = "none", .bytes = 4000}, 1e-5},
                      {{.name = "grid", .bytes = 9000, .cells = 729, .references = 1931}, 2e-4},
                      {{.name = "bvh", .bytes = 7000, .cells = 20, .references = 91}, 1e-4}};
  table.disagreement = 0.0005;
  for (const Combination& c : all_combinations()) {
    const double s = samples_per_pixel(c) * (c.accel == AccelKind::none ? 0.08 : 0.01);
    BenchRow row;
    row.combination = c;
    row.runs_s = {s * 3, s, s / 3};
    row.rays = uint64_t(1'000'000) * uint64_t(samples_per_pixel(c));
    row.report_s = report_seconds(scene, table.width, table.height, c);
    table.rows.push_back(row);
  }
  return table;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Bench, HasAllCombinationsWithTheReportsSamples) {
  std::multiset<int> samples;
  std::set<std::string> labels;
  for (const Combination& c : all_combinations()) {
    samples.insert(samples_per_pixel(c));
    labels.insert(short_label(c));
  }
  EXPECT_EQ(labels.size(), 24u);
  for (const int n : {1, 3, 9, 27}) EXPECT_EQ(samples.count(n), 6u) << n;
  EXPECT_EQ(all_combinations().front(), Combination{AccelKind::none});
  EXPECT_EQ(all_combinations()[15], (Combination{AccelKind::grid, true, true, true}));
  EXPECT_EQ(all_combinations().back(), (Combination{AccelKind::bvh, true, true, true}));
  EXPECT_EQ(short_label({AccelKind::grid, true, false, true}), "grid AA DOF");
}

TEST(Bench, KnowsTheReportsSecondsAndNoOthers) {
  const Combination plain{AccelKind::none}, grid{AccelKind::grid};
  const Combination all{AccelKind::grid, true, true, true};
  EXPECT_EQ(report_seconds("balls_medium", 512, 512, plain), 24.3);
  EXPECT_EQ(report_seconds("balls_medium", 512, 512, grid), 4.5);
  EXPECT_EQ(report_seconds("balls_medium", 512, 512, all), 98.4);
  EXPECT_FALSE(report_seconds("balls_medium", 256, 256, plain));
  EXPECT_FALSE(report_seconds("balls_high", 512, 512, plain));
  const auto known = std::ranges::count_if(all_combinations(), [](const Combination& c) {
    return report_seconds("balls_medium", 512, 512, c).has_value();
  });
  EXPECT_EQ(known, 3);
}

TEST(Bench, TakesTheMedianOfTheRuns) {
  BenchRow row;
  row.runs_s = {9, 1, 2}, row.rays = 100, row.report_s = 30;
  EXPECT_EQ(row.seconds(), 2);
  EXPECT_EQ(row.rays_per_s(), 50);
  EXPECT_EQ(row.speedup(), 15);
  row.runs_s.push_back(4);
  EXPECT_EQ(row.seconds(), 3);
  row.report_s.reset();
  EXPECT_FALSE(row.speedup());
}

TEST(Bench, CostIsAgainstTheSameStructureWithoutEffects) {
  const BenchTable table = sample_table();
  for (const BenchRow& row : table.rows)
    EXPECT_DOUBLE_EQ(table.relative_cost(row), samples_per_pixel(row.combination));
}

TEST(Bench, RefusesStructuresThatSeeDifferentPictures) {
  const Image a(100, 100);
  Image b = a;
  for (int i = 0; i < 10; ++i) b.at(i, 50) = Rgb(1);
  EXPECT_EQ(check_agreement(AccelKind::grid, a, b), 0.001);
  b.at(10, 50) = Rgb(1);
  const auto refused = check_agreement(AccelKind::bvh, a, b);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), HasSubstr("bvh and none"));
  EXPECT_THAT(refused.error(), HasSubstr("0.11 %"));
}

TEST(Bench, ThreeDigits) {
  EXPECT_EQ(three_digits(0.01234), "0.0123");
  EXPECT_EQ(three_digits(4.5), "4.50");
  EXPECT_EQ(three_digits(98.44), "98.4");
  EXPECT_EQ(three_digits(1260.4), "1260");
}

TEST(Bench, TextIsAlignedAndShowsWhatIsKnown) {
  const auto lines = lines_of(table_text(sample_table()));
  for (const std::string& line : lines) {
    EXPECT_LE(line.size(), 100u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  for (const char* part : {"balls_medium", "512x512", "depth 5", "2 threads", "raio 1.2.3"})
    EXPECT_THAT(lines[0], HasSubstr(part));
  EXPECT_THAT(lines[1], HasSubstr("Some Processor 9000"));

  std::vector<std::string> rows;
  for (const std::string& line : lines)
    if (line.ends_with(" x")) rows.push_back(line);
  ASSERT_EQ(rows.size(), 24u);
  for (const std::string& row : rows) EXPECT_EQ(row.size(), rows[0].size()) << row;
  EXPECT_THAT(rows[0], HasSubstr("24.3"));
  EXPECT_THAT(rows[0], HasSubstr("304 x"));  // 24.3 s over 0.08 s
  EXPECT_THAT(rows[1], HasSubstr(" - "));
  EXPECT_THAT(rows[15], HasSubstr("98.4"));
  EXPECT_THAT(rows[15], HasSubstr("27.0 x"));
  EXPECT_TRUE(rows[16].starts_with("bvh "));
}

TEST(Bench, CsvHasOneFieldForEachName) {
  const auto lines = lines_of(table_csv(sample_table("my \"best\"")));
  ASSERT_EQ(lines.size(), 25u);
  const auto commas = std::ranges::count(lines[0], ',');
  for (const std::string& line : lines) EXPECT_EQ(std::ranges::count(line, ','), commas) << line;
  EXPECT_TRUE(lines[1].starts_with("\"my \"\"best\"\"\",512,512,5,2,none,0,0,0,1,,0.08,"))
      << lines[1];
  const auto known = lines_of(table_csv(sample_table()));
  EXPECT_THAT(known[16], HasSubstr(",grid,1,1,1,27,98.4,0.27,27000000,100000000,"));
}

TEST(Bench, JsonHoldsTheWholeTable) {
  const auto json = nlohmann::json::parse(table_json(sample_table()));
  EXPECT_EQ(json["scene"], "balls_medium");
  EXPECT_EQ(json["resolution"], (nlohmann::json{512, 512}));
  EXPECT_EQ(json["accelerators"][1]["cells"], 729);
  ASSERT_EQ(json["rows"].size(), 24u);
  EXPECT_EQ(json["rows"][0]["accelerator"], "none");
  EXPECT_EQ(json["rows"][0]["report_s"], 24.3);
  EXPECT_TRUE(json["rows"][1]["report_s"].is_null());
  EXPECT_TRUE(json["rows"][1]["speedup"].is_null());
  EXPECT_EQ(json["rows"][1]["effects"]["dof"], true);
  EXPECT_EQ(json["rows"][15]["runs_s"].size(), 3u);
  EXPECT_EQ(json["rows"][15]["samples_per_pixel"], 27);
  EXPECT_EQ(json["rows"][23]["accelerator"], "bvh");
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

  Image draw(const BenchTable& table) {
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

TEST_F(PlotPicture, ShowsBarsAndWhereKnownTheReport) {
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

TEST_F(PlotPicture, KeepsItsMargins) {
  BenchTable table = sample_table(std::string(200, 'W') + "\xff");
  table.machine = std::string(300, 'M');
  for (const double factor : {1e-4, 1.0, 300.0}) {
    BenchTable scaled = table;
    for (BenchRow& row : scaled.rows) {
      for (double& s : row.runs_s) s *= factor;
      row.report_s = row.combination.aa ? std::optional(24.3) : std::nullopt;
    }
    const Image image = draw(scaled);
    for (int y = 0; y < image.height; ++y)
      for (const int x : {2, image.width - 3}) {
        EXPECT_TRUE(has_bytes(image.at(x, y), 255, 255, 255)) << factor << ": " << x << " " << y;
      }
  }
}

}  // namespace
}  // namespace raio::app
