// Tone curves and colours that are written down.
#include "integrate/tone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
  for (const Tone tone : {Tone::srgb, Tone::agx})
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
