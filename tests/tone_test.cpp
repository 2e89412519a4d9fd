// Tone curves and colours that are written down.
#include "integrate/tone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/executor.h"
#include "integrate/color_text.h"
#include "io/image/image.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Tone, PowersAndLogarithmsAreExactToTheLastDigits) {
  for (double x = -300; x <= 300; x += 0.37) {
    EXPECT_NEAR(exact_exp2(x) / std::exp2(x), 1, 2e-15) << x;
    EXPECT_NEAR(exact_log2(std::exp2(x)), x, 1e-15 * std::max(1.0, std::abs(x))) << x;
  }
  for (int n = -20; n <= 20; ++n) {
    EXPECT_EQ(exact_exp2(n), std::ldexp(1, n));
    EXPECT_EQ(exact_log2(std::ldexp(1, n)), n);
  }
}

TEST(Tone, SrgbIsTheCurveOfTheStandard) {
  EXPECT_EQ(srgb_from_linear(0), 0);
  EXPECT_EQ(srgb_from_linear(1), 1);
  EXPECT_EQ(srgb_from_linear(-1), 0);
  EXPECT_EQ(srgb_from_linear(kInfinity), 1);
  EXPECT_EQ(srgb_from_linear(std::nanf("")), 0);
  EXPECT_NEAR(srgb_from_linear(0.5f), 0.735356983, 1e-7);
  EXPECT_NEAR(srgb_from_linear(0.18f), 0.461356, 1e-6);
  EXPECT_NEAR(srgb_from_linear(0.002f), 0.02584, 1e-7);
  for (int byte = 0; byte < 256; ++byte) {
    const float encoded = float(byte) / 255;
    EXPECT_NEAR(linear_from_srgb(encoded),
                encoded <= 0.04045f ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4),
                1e-7);
    EXPECT_EQ(to_byte(srgb_from_linear(linear_from_srgb(encoded))), byte);
  }
}

TEST(Tone, NoneLeavesEveryBit) {
  const ToneMap none(Tone::none, 0);
  for (const Rgb color : {Rgb(0.1f, 1.7f, 0), Rgb(-1, 1e-38f, 3e38f)})
    EXPECT_EQ(none(color), color);
  EXPECT_EQ(ToneMap(Tone::none, 3)(Rgb(0.125f, 0.5f, 1)), Rgb(1, 4, 8));
  EXPECT_EQ(ToneMap(Tone::none, -1)(Rgb(0.125f)), Rgb(0.0625f));
}

TEST(Tone, ExposureCountsInStops) {
  for (const Tone tone : {Tone::srgb, Tone::agx, Tone::neutral})
    EXPECT_EQ(ToneMap(tone, 2)(Rgb(0.05f, 0.1f, 0.2f)), ToneMap(tone, 0)(Rgb(0.2f, 0.4f, 0.8f)));
}

// Benjamin Wrensch's approximation, computed in extended precision by another program.
TEST(Tone, AgxIsAsPublished) {
  const ToneMap agx(Tone::agx, 0);
  const auto expect = [&](Rgb linear, Rgb wanted) {
    const Rgb got = agx(linear);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], 2e-6) << c;
  };
  expect(Rgb(0.18f, 0.18f, 0.18f), Rgb(0.4966762f, 0.4967449f, 0.4967491f));
  expect(Rgb(1, 1, 1), Rgb(0.7867452f, 0.7868847f, 0.7868934f));
  expect(Rgb(1, 0, 0), Rgb(0.8609764f, 0.2301589f, 0.2303248f));
  expect(Rgb(0.02f, 0.5f, 4), Rgb(0.5860575f, 0.7336330f, 0.9594208f));
  expect(Rgb(16, 8, 1), Rgb(1.0000000f, 0.9770203f, 0.8688115f));
}

TEST(Tone, AgxCompressesHighlights) {
  const ToneMap agx(Tone::agx, 0);
  float before = -1;
  for (double stops = -14; stops <= 8; stops += 0.125) {
    const Rgb grey = agx(Rgb(float(std::exp2(stops))));
    EXPECT_NEAR(grey.x, grey.y, 1e-3);
    EXPECT_NEAR(grey.x, grey.z, 1e-3);
    EXPECT_GE(grey.x, before) << stops;
    before = grey.x;
  }
  EXPECT_EQ(to_byte(agx(Rgb()).x), 0);
  EXPECT_EQ(to_byte(agx(Rgb(kInfinity)).x), 255);
  EXPECT_EQ(agx(Rgb(std::nanf(""))), agx(Rgb()));
  EXPECT_EQ(agx(Rgb(-1)), agx(Rgb()));
  // Differences far above white remain, and a pure colour fades to white.
  EXPECT_GT(to_byte(agx(Rgb(8)).x), to_byte(agx(Rgb(4)).x));
  EXPECT_GT(agx(Rgb(1000, 0, 0)).y, 0.5f);
}

// The linear colour that a display shows.
Rgb shown(Rgb encoded) {
  return {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
}

TEST(Tone, NeutralKeepsColoursBelowItsStart) {
  const ToneMap neutral(Tone::neutral, 0);
  // The curve subtracts the 0.04 that dielectrics reflect; less from darker colours.
  for (const Rgb color : {Rgb(0.1f, 0.3f, 0.79f), Rgb(0.5f), Rgb(0.08f, 0.2f, 0.1f)})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown(neutral(color))[c], color[c] - 0.04f, 1e-6f);
  EXPECT_NEAR(shown(neutral(Rgb(0.04f))).x, 6.25f * 0.04f * 0.04f, 1e-7f);
  EXPECT_EQ(neutral(Rgb()), Rgb());
  EXPECT_EQ(neutral(Rgb(-1)), Rgb());
  EXPECT_EQ(neutral(Rgb(std::nanf(""))), Rgb());
}

// The formulas of the specification, in extended precision by another program.
TEST(Tone, NeutralCompressesHighlightsWithTheirHue) {
  const ToneMap neutral(Tone::neutral, 0);
  // Grey 1.04 becomes 1 - 0.24^2 / (1 + 0.24 - 0.76).
  EXPECT_NEAR(shown(neutral(Rgb(1.04f))).x, 0.88f, 1e-6f);
  const Rgb red = shown(neutral(Rgb(4, 0.5f, 0.25f)));
  EXPECT_NEAR(red.x, 0.983256f, 1e-5f);
  EXPECT_NEAR(red.y, 0.382473f, 1e-5f);
  EXPECT_NEAR(red.z, 0.339560f, 1e-5f);
  EXPECT_EQ(neutral(Rgb(kInfinity)), Rgb(1));
  float before = -1;
  for (double stops = -14; stops <= 20; stops += 0.125) {
    const float grey = neutral(Rgb(float(std::exp2(stops)))).x;
    EXPECT_GT(grey, before - 1e-7f) << stops;
    EXPECT_LE(grey, 1);
    before = grey;
  }
}

TEST(Tone, AutomaticExposureMapsTheMeanToGrey) {
  // The geometric mean of 0.045 and 0.72 is 0.18, so of these it is a quarter of that.
  std::vector<Rgb> colors = {Rgb(0.045f / 4), Rgb(0.72f / 4)};
  EXPECT_NEAR(exposure_of(colors, {}), 2, 1e-6);
  // Black, NaN and infinity do not count.
  for (const float other : {0.0f, kInfinity, std::nanf("")}) colors.emplace_back(other);
  EXPECT_NEAR(exposure_of(colors, {}), 2, 1e-6);
  // Of pixels that are covered in part, the covered part counts.
  EXPECT_NEAR(exposure_of(std::vector{Rgb(0.045f / 4), Rgb(0.72f / 8)}, std::vector{0.5f, 0.5f}),
              exposure_of(std::vector{Rgb(0.045f / 2), Rgb(0.72f / 4)}, {}), 1e-6);
  EXPECT_EQ(exposure_of({}, {}), 0);
  EXPECT_EQ(exposure_of(std::vector{Rgb(1e-36f)}, {}), 100);
  // As luminance: green counts most.
  EXPECT_NEAR(exposure_of(std::vector{Rgb(0, 0.18f / 0.7152f, 0)}, {}), 0, 1e-6);
}

TEST(Tone, AutomaticExposureDoesNotDependOnThreads) {
  std::vector<Rgb> colors;
  for (int i = 0; i < 100'000; ++i) colors.emplace_back(float(i % 977) * 1e-3f);
  const float one = Executor(1).run([&] { return exposure_of(colors, {}); });
  EXPECT_EQ(Executor(3).run([&] { return exposure_of(colors, {}); }), one);
}

TEST(WrittenColor, ComesInFourForms) {
  const auto color = [](std::string_view text) { return parse_color(text).value(); };
  EXPECT_EQ(color("white"), (WrittenColor{Rgb(1), false, true}));
  EXPECT_EQ(color("Orange"), color("#ffa500"));
  EXPECT_EQ(color("#FfA500"), (WrittenColor{Rgb(1, 165.0f / 255, 0), false, true}));
  EXPECT_EQ(color("#f80"), color("#ff8800"));
  EXPECT_EQ(color("#123"), color("#112233"));
  EXPECT_EQ(color("0.1,2,0"), (WrittenColor{Rgb(0.1f, 2, 0), false, false}));
  EXPECT_EQ(color("transparent"), (WrittenColor{Rgb(), true, true}));
  EXPECT_EQ(color("grey"), color("gray"));
  // Display bytes equal the written ones.
  EXPECT_EQ(to_byte(color("#8081fe").color.y), 0x81);
}

TEST(WrittenColor, RefusesTheRest) {
  for (const char* text :
       {"", "#", "#12", "#1234567", "#12345g", "#-12345", "1,2", "1,2,3,4", "1,2,", ",,",
        "-0.1,0,0", "nan,0,0", "inf,0,0", "1 ,2,3", "1e7,0,0", "wite", "#ffffff "}) {
    const auto color = parse_color(text);
    ASSERT_FALSE(color) << text;
    EXPECT_THAT(color.error(), HasSubstr("expected a colour"));
    EXPECT_THAT(color.error(), HasSubstr("found '" + std::string(text) + "'"));
  }
  EXPECT_THAT(parse_color("wite").error(), HasSubstr("did you mean white?"));
}

}  // namespace
}  // namespace raio::core
