// What raio grade says about pictures. tests/grade_faults.py has those of a broken tracer.
#include "app/grade.h"

#include <nlohmann/json.hpp>

#include "measure/faults.h"
#include "nff_text.h"
#include "noise.h"
#include "program.h"
#include "render/render.h"
#include "sanitized.h"

namespace raio::core {
namespace {

using nlohmann::json;

// Every fault has an effect: two lights, a ball beyond one of them, glass, mirrors, smooth
// triangles, background.
constexpr std::string_view kRich =
    "b 0.3 0.5 0.9\nv\nfrom 1 -8 2\nat 0.2 0 0.8\nup 0.2 0 1\nangle 36\nhither 0\nresolution 54 "
    "36\n"
    "l 3 -4 5\nl -5 -4 3\n"
    "f 0.7 0.7 0.6 0.9 0 1 0 1\np 4\n-5 -5 0\n5 -5 0\n5 5 0\n-5 5 0\n"
    "s 4 -5.3 6.7 0.8\n"
    "f 1 0.4 0.1 0.9 0.3 10 0 1\ns -1.2 0 0.7 0.7\nf 1 1 1 0 0.1 50 0.9 1.5\ns 0.6 -1 0.6 0.6\n"
    "f 0.2 0.8 0.3 0.7 0.4 8 0 1\nc 2 0.5 0 0.5 2 0.5 1.6 0.2\n"
    "pp 3\n-3 2 0 -1 -1 0.5\n1 2 0 1 -1 0.5\n-1 1.5 3 0 -1 -1\n"
    "f 0.4 0.3 0.9 0.8 0 1 0 1\np 3\n1.5 2 0\n4 2 0\n3 2 2.6\n";

Imitation right_picture() {
  Imitation right;
  right.scene = tests::read(std::string(kRich));
  RenderOptions options;
  options.accel.kind = AccelKind::none;
  right.settings = resolve_options(options, right.scene);
  return right;
}

bool names(const Cause& cause, const KnownFault& fault) {
  return cause.fault == &fault || std::ranges::count(cause.equals, &fault) > 0;
}

TEST(Grade, FindsEachFaultThatItImitates) {
  const Imitation right = right_picture();
  const auto reference = imitate(right, {});
  ASSERT_TRUE(reference);
  EXPECT_TRUE(causes_of_difference(right, *reference, *reference).empty());
  constexpr size_t kStep = tests::if_sanitized(3, 1);
  size_t found = 0, number = 0;
  for (const KnownFault& fault : known_faults()) {
    if (number++ % kStep != 0) continue;
    Imitation wrong = right;
    if (!fault.add(wrong) || wrong.shadows == ShadowRays::speckled) continue;
    const auto picture = imitate(wrong, *reference);
    ASSERT_TRUE(picture) << fault.name;
    EXPECT_GT(compare(*reference, *picture).rmse, 0.2) << fault.name;
    const auto causes = causes_of_difference(right, *reference, *picture);
    EXPECT_FALSE(causes.empty()) << fault.name;
    if (causes.empty()) continue;
    EXPECT_TRUE(names(causes[0], fault)) << fault.name << " taken for " << causes[0].fault->name;
    EXPECT_EQ(causes.size(), 1u) << fault.name;
    EXPECT_LT(causes[0].rmse, 0.1) << fault.name;
    ++found;
  }
  EXPECT_GE(found, known_faults().size() / kStep - 4);  // of square pictures, and those below
}

TEST(Grade, FindsTwoFaultsTogether) {
  const Imitation right = right_picture();
  const auto reference = imitate(right, {});
  Imitation wrong = right;
  wrong.shadows = ShadowRays::none;
  ASSERT_EQ(known_faults()[0].name, "upside-down");
  ASSERT_TRUE(known_faults()[0].add(wrong));
  const auto picture = imitate(wrong, {});
  ASSERT_TRUE(reference && picture);
  const auto causes = causes_of_difference(right, *reference, *picture);
  ASSERT_EQ(causes.size(), 2u);
  EXPECT_EQ(causes[0].fault->name, "upside-down");
  EXPECT_EQ(causes[1].fault->name, "no-shadows");
  EXPECT_EQ(causes[1].rmse_before, causes[0].rmse);
  EXPECT_EQ(causes[1].share(), 1);
}

TEST(Grade, TakesSpecklesButNotAreasForAcne) {
  const Imitation right = right_picture();
  const auto reference = imitate(right, {});
  Imitation dark = right;
  dark.shadows = ShadowRays::always;
  const auto shadow = imitate(dark, {});
  ASSERT_TRUE(reference && shadow);
  Image speckles = *reference, areas = *reference;
  for (int y = 0; y < speckles.height; ++y)
    for (int x = 0; x < speckles.width; ++x) {
      if ((x * 7 + y * 5) % 3 == 0) speckles.at(x, y) = shadow->at(x, y);
      if (x < speckles.width / 2) areas.at(x, y) = shadow->at(x, y);
    }
  const auto causes = causes_of_difference(right, *reference, speckles);
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].fault->name, "acne");
  EXPECT_EQ(causes[0].rmse, 0);
  for (const Cause& cause : causes_of_difference(right, *reference, areas))
    EXPECT_NE(cause.fault->name, "acne");
}

TEST(Grade, OfAnotherPictureTriesOnlyItsTransformations) {
  Image reference = tests::noise(20, 20), wrong = reference;
  for (Rgb& pixel : wrong.pixels) std::swap(pixel.x, pixel.z);
  const auto causes = causes_of_difference(right_picture(), reference, wrong, true);
  ASSERT_EQ(causes.size(), 1u);
  EXPECT_EQ(causes[0].fault->name, "red-blue");
  for (const KnownFault* other : causes[0].equals) EXPECT_TRUE(other->of_file);
}

TEST(Grade, CountsAreTheNumbersAfterTheirWords) {
  RayCounts expected;
  expected.eye = 50, expected.shadow = 30, expected.reflection = 20, expected.tests = 250;
  const auto counts = app::counts_in(
      "mine.png: 1.5 s, 90 rays {'eye': 50, 'shadow': 31, 'reflected': 20}, tests per ray 2.75, "
      "eyes 7",
      expected);
  const auto found = [&](std::string_view name) -> const app::Grade::Count& {
    return *std::ranges::find(counts, name, &app::Grade::Count::name);
  };
  EXPECT_EQ(found("eye").found, 50);
  EXPECT_EQ(found("shadow").found, 31);
  EXPECT_EQ(found("shadow").expected, 30);
  EXPECT_EQ(found("reflection").found, 20);
  EXPECT_EQ(found("tests").found, 2.75);
  EXPECT_EQ(found("tests").expected, 2.5);
  EXPECT_FALSE(found("refraction").found);
}

class GradeCommandLine : public CommandLine {
 protected:
  void SetUp() override {
    ASSERT_EQ(raio({"render", "ok.nff", "-o", "right.png", "--stats", "stats.json"}).status, 0);
    ASSERT_EQ(raio({"render", "ok.nff", "-o", "mirrorless.png", "--no-reflection"}).status, 0);
  }
};

TEST_F(GradeCommandLine, PassesTheRightPicture) {
  const Outcome o = raio({"grade", "ok.nff", "right.png", "--counts", "stats.json"});
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("24x16"));
  EXPECT_THAT(o.out, HasSubstr("RMSE                0 of 255, within"));
  EXPECT_THAT(o.out, Not(HasSubstr("likely cause")));
  EXPECT_THAT(o.out, Not(HasSubstr("first wrong pixel")));
  const json said =
      json::parse(raio({"grade", "ok.nff", "right.png", "--counts", "stats.json", "--json"}).out);
  EXPECT_TRUE(said["passed"]);
  EXPECT_EQ(said["errors"]["wrong_pixels"], 0);
  EXPECT_TRUE(said["first_wrong"].is_null());
  for (const char* name : {"eye", "eye_hits", "reflection", "refraction", "shadow", "shadow_hits"})
    EXPECT_EQ(said["counts"][name]["found"], said["counts"][name]["expected"]) << name;
}

TEST_F(GradeCommandLine, NamesTheFaultAndShowsAWrongPixel) {
  const Outcome o =
      raio({"grade", "ok.nff", "mirrorless.png", "--tolerance", "2", "-o", "apart.png"});
  EXPECT_EQ(o.status, 1) << o.err;
  EXPECT_THAT(o.out, HasSubstr("likely cause        no-reflection: no mirrored rays\n"));
  EXPECT_THAT(o.out, HasSubstr("to 0: this explains 100 % of the squared error"));
  EXPECT_THAT(o.out, HasSubstr("\neye ray, level 1"));
  const auto sides = read_image(file("apart.png"));
  ASSERT_TRUE(sides);
  EXPECT_EQ(sides->width, 3 * 24 + 8);
  EXPECT_EQ(sides->height, 16);

  const json said =
      json::parse(raio({"grade", "ok.nff", "mirrorless.png", "--tolerance", "2", "--json"}).out);
  EXPECT_FALSE(said["passed"]);
  EXPECT_EQ(said["causes"][0]["name"], "no-reflection");
  EXPECT_EQ(said["causes"][0]["rmse_before"], said["errors"]["rmse"]);
  // The first pixel that differs, as the pictures tell.
  const auto a = read_image(file("right.png")), b = read_image(file("mirrorless.png"));
  ASSERT_TRUE(a && b);
  size_t first = 0;
  const auto apart = [&](size_t i) {
    const auto p = display_bytes(a->pixels[i]), q = display_bytes(b->pixels[i]);
    return std::max({std::abs(p[0] - q[0]), std::abs(p[1] - q[1]), std::abs(p[2] - q[2])});
  };
  while (apart(first) <= 2) ++first;
  EXPECT_EQ(said["first_wrong"]["pixel"], json({first % 24, first / 24}));
  EXPECT_EQ(said["first_wrong"]["expected"], json(display_bytes(a->pixels[first])));
  EXPECT_EQ(said["first_wrong"]["found"], json(display_bytes(b->pixels[first])));
  EXPECT_EQ(said["first_wrong"]["explain"]["pixel"], said["first_wrong"]["pixel"]);
}

TEST_F(GradeCommandLine, TheThresholdDecides) {
  const double rmse = json::parse(raio({"grade", "ok.nff", "mirrorless.png", "--json"}).out)
                          .at("errors")
                          .at("rmse");
  const auto status = [&](double threshold) {
    return raio({"grade", "ok.nff", "mirrorless.png", "--threshold", std::to_string(threshold)})
        .status;
  };
  EXPECT_EQ(status(rmse * 0.99), 1);
  EXPECT_EQ(status(rmse * 1.01), 0);
}

TEST_F(GradeCommandLine, AReferenceMayBeAPicture) {
  Outcome o = raio({"grade", "ok.nff", "mirrorless.png", "--reference", "right.png"});
  EXPECT_EQ(o.status, 1);
  EXPECT_THAT(o.out, HasSubstr("no-reflection"));
  o = raio({"grade", "ok.nff", "mirrorless.png", "--reference", "mirrorless.png"});
  EXPECT_EQ(o.status, 0);
  // Of another scene: only transformations are tried.
  ASSERT_EQ(raio({"render", "ok.nff", "-o", "moved.png", "--from", "1,-4,3"}).status, 0);
  o = raio({"grade", "ok.nff", "mirrorless.png", "--reference", "moved.png"});
  EXPECT_EQ(o.status, 1);
  EXPECT_THAT(o.out, HasSubstr("only faults of the finished picture"));
}

TEST_F(GradeCommandLine, ASizeThatIsNotTheExpectedOneFails) {
  const Outcome o = raio({"grade", "ok.nff", "right.png", "--size", "16x24"});
  EXPECT_EQ(o.status, 1);
  EXPECT_THAT(o.out, HasSubstr("expected 16x24 pixels; width and height are exchanged"));
}

TEST_F(GradeCommandLine, RefusesWhatItCannotGrade) {
  expect_refusal({"grade", "ok.nff"}, 2, "STUDENT is missing");
  expect_refusal({"grade", "ok.nff", "none.png"}, 2, "none.png");
  expect_refusal({"grade", "ok.nff", "right.png", "--threshold", "x"}, 2, "--threshold");
  expect_refusal({"grade", "ok.nff", "right.png", "-o", "-"}, 2, "standard output");
  expect_refusal({"grade", "ok.nff", "right.png", "-o", "a.gif"}, 2, "a.gif");
  expect_refusal({"grade", "ok.nff", "right.png", "--counts", "none.txt"}, 2, "none.txt");
  expect_refusal({"grade", "ok.nff", "right.png", "--accel", "embree"}, 2, "Embree does not log");
  put(file("salt.xyz"), "1\n\nNa 0 0 0\n");
  expect_refusal({"grade", "salt.xyz", "right.png"}, 2, "integrator");
}

}  // namespace
}  // namespace raio::core
