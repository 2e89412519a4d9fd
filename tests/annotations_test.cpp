// Legends and scale bars on pictures, and sizes in print.
#include "draw/annotations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "integrate/figure.h"
#include "render/options.h"
#include "scenes.h"

namespace raio::core::app {
namespace {

Picture white_page(int width, int height, float dpi = 0) {
  Picture page;
  page.color = Image(width, height);
  std::ranges::fill(page.color.pixels, Rgb(1));
  page.dpi = dpi;
  return page;
}

bool is_ink(const Rgb& pixel) { return max_component(pixel) < 0.3f; }

// The longest run of ink in a row of the picture.
int longest_run(const Image& image) {
  int longest = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0, run = 0; x < image.width; ++x)
      longest = std::max(longest, run = is_ink(image.at(x, y)) ? run + 1 : 0);
  return longest;
}

// Not longer than a quarter of the picture: of 400 pixels, at 20 for each unit, 5 units.
TEST(Annotations, AScaleBarIsAsLongAsItSays) {
  for (const auto& [per_unit, pixels] : {std::pair(20.0, 100), {21.0, 42}, {0.011, 55}}) {
    Picture page = white_page(400, 300);
    ASSERT_TRUE(draw_scale_bar_on(page, per_unit, "Å", false));
    EXPECT_NEAR(longest_run(page.color), pixels, 1) << per_unit;
  }
}

// Discs of the colours are below each other; entries without room are counted.
TEST(Annotations, ALegendShowsItsColours) {
  const std::vector<LegendEntry> entries = {{"Fe", {1, 0, 0}}, {"chain B", {0, 0, 1}}};
  for (const bool left : {true, false}) {
    Picture page = white_page(400, 300);
    ASSERT_TRUE(draw_legend_on(page, entries, left, false));
    std::array<int, 2> first_row = {300, 300}, count{};
    for (int y = 0; y < 300; ++y)
      for (int x = 0; x < 400; ++x) {
        const Rgb& c = page.color.at(x, y);
        const bool red = c.x > 0.95f && c.y < 0.05f, blue = c.z > 0.95f && c.y < 0.05f;
        if (!red && !blue) continue;
        EXPECT_EQ(x < 200, left);
        first_row[blue] = std::min(first_row[blue], y), ++count[blue];
      }
    EXPECT_LT(first_row[0], first_row[1]);
    EXPECT_GT(count[0], 20);
    EXPECT_NEAR(count[0], count[1], 12);
  }
  Picture small = white_page(60, 40);
  EXPECT_TRUE(draw_legend_on(small, std::vector<LegendEntry>(1000, {"x", {}}), true, false));
}

// 7 points at 300 and at 600 pixels per inch.
TEST(Annotations, TextKeepsItsSizeInPrint) {
  const auto width = [](float dpi) {
    Picture page = white_page(1200, 900, dpi);
    EXPECT_TRUE(draw_legend_on(page, std::vector<LegendEntry>{{"MMMM", {1, 1, 1}}}, true, false));
    int right = 0;
    for (int y = 0; y < 900; ++y)
      for (int x = 0; x < 1200; ++x)
        if (is_ink(page.color.at(x, y))) right = std::max(right, x);
    return right - int(0.045 * 900);
  };
  EXPECT_NEAR(double(width(300)) / width(150), 2, 0.1);
}

TEST(PrintSize, BecomesPixels) {
  const auto spec_of = [](std::string_view name) {
    return *std::ranges::find(render_option_table(), name, &OptionSpec::name);
  };
  Scene scene = tests::random_scene(20, 1);
  scene.dialect = Dialect::data;
  scene.camera.width = 1200, scene.camera.height = 900;
  struct Case {
    std::string_view option, text, dpi;
    int width, height;
  };
  for (const Case& c : {Case{"width", "88mm", "", 1039, 780},
                        {"width", "3.5in", "100", 350, 263},
                        {"size", "8.8x4.4cm", "254", 880, 440}}) {
    RenderOptions options;
    ASSERT_TRUE(set_option(options, spec_of(c.option), c.text)) << c.text;
    if (!c.dpi.empty()) {
      ASSERT_TRUE(set_option(options, spec_of("dpi"), c.dpi));
    }
    const RenderSettings s = resolve_options(options, scene);
    EXPECT_EQ(s.width, c.width);
    EXPECT_NEAR(s.height, c.height, 1);
    // Stored as pixels with their density, which give the same picture.
    EXPECT_EQ(resolve_options(options_of(s, scene), scene), s);
    EXPECT_TRUE(window_conflict(options));
  }
  RenderOptions both;
  for (const std::string_view wrong : {"88", "mm", "88mmx", "-1mm", "1e9mm", "nanmm"})
    EXPECT_FALSE(set_option(both, spec_of("width"), wrong)) << wrong;
  both.width = both.height = 10, both.print = PrintSize{.width = 10};
  ASSERT_TRUE(option_conflict(both));
  EXPECT_EQ(option_conflict(both)->subject, "width");
  RenderOptions huge;
  huge.print = PrintSize{.width = 10000}, huge.dpi = 10000;
  ASSERT_TRUE(option_conflict(huge, &scene));
  EXPECT_EQ(option_conflict(huge, &scene)->subject, "dpi");
}

}  // namespace
}  // namespace raio::core::app
