#include <gtest/gtest.h>

#include "nff_text.h"
#include "sanitized.h"
#include "shape/polygon.h"
#include "shape/triangle.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using tests::expect_same;
using tests::file_text;
using tests::if_sanitized;
using tests::kCamera;
using tests::kMaterial;
using tests::kSharedFolder;
using tests::many_spheres;
using tests::texts;

// Damage: any bytes give a valid scene or an error with a location.

std::string damaged(std::string text, std::mt19937_64& random) {
  static const std::string_view kPieces[] = {"p 4 ",
                                             "pp 5 ",
                                             "mesh 4 2 ",
                                             "nan",
                                             "1e39",
                                             "-",
                                             "#",
                                             "\n",
                                             "\r",
                                             "v\n",
                                             "from 1 1 1\n",
                                             "box ",
                                             "l ",
                                             " 0 ",
                                             "4294967295",
                                             "\xff",
                                             "\xc2\xbd",
                                             "angle 0\n",
                                             "f ",
                                             "s 0 0 0 ",
                                             "-1",
                                             "e",
                                             ".",
                                             "ms ",
                                             "aperture 1 ",
                                             "resolution 1 1 ",
                                             "spp 1 ",
                                             "pl ",
                                             "c ",
                                             "env sky\n",
                                             "accel 1\n",
                                             "f 1 1 1 0.5 1 0.5 0 0.5 30 0 1 0.1\n",
                                             "l 1 2 3 1 1 4 1 1 1\n",
                                             std::string_view("\0", 1),
                                             "1e30"};
  for (size_t changes = 1 + random() % 4; changes > 0 && !text.empty(); --changes) {
    const size_t at = random() % text.size(), length = random() % 40;
    switch (random() % 5) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(at, kPieces[random() % std::size(kPieces)]);
        break;
      case 2:
        text.replace(at, random() % 3, kPieces[random() % std::size(kPieces)]);
        break;
      case 3:
        text[at] = char(random());
        break;
      default:
        text.insert(random() % text.size(), text.substr(at, length));
    }
    if (random() % 16 == 0) text.resize(random() % (text.size() + 1));
  }
  return text;
}

const std::string kObjects =
    "s 0 0 0 1\nc 0 0 0 1 0 0 1 0.5\npl 0 0 0 1 0 0 0 1 0\nbox 0 0 0 1 1 1\n"
    "p 3 0 0 0 1 0 0 0 1 0\npp 4\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n"
    "mesh 4 2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n-1 -2 -3\n"
    "p 5\n0 0 0\n2 0 0\n2 2 0\n1 1 0\n0 2 0\n";

const std::string kP3f = "accel 1\nspp 4\nbclr 0 0 1\nenv sky box # six\n" + kCamera +
                         "aperture 2\nfocal 1.5\nl 1 2 3 1 1 1\nl 1 2 3 0.5 1 16 1 1 1\n"
                         "f 1 0.9 0.7 0.5 1 0.8 0.3 0.5 30 0 1\ns 0 1 0 1\n"
                         "f 1 1 1 0 1 1 1 0.2 20 1 1.35 0.2\n";

TEST(NffDamage, GivesAValidSceneOrAnErrorWithALocation) {
  std::vector<std::string> sources = {
      kCamera + "aperture 2\nfocal 1.5\nl 1 2 3\nl 1 2 3 1 1 1\n" + kMaterial + kObjects,
      kP3f + kObjects,
      "v\nfrom 1000010 5e6 3\nat 1e6 5e6 3\nup 0 0 1\nangle 45\nl 1e6 5e6 9\ns 1e6 5e6 3 1\n"};
  if (std::filesystem::exists(kSharedFolder))
    for (const char* file : {"p3d/plane.nff", "p3d/balls_low.nff", "spd/teapot.nff",
                             "spd/gears.nff", "spd/tree.nff", "spd/rings.nff"}) {
      const std::string start = file_text(kSharedFolder / file).substr(0, 3000);
      const auto last = [&](const char* keyword) { return start.rfind(keyword) + 1; };
      sources.push_back(start.substr(0, std::max({last("\ns "), last("\nc "), last("\np")})));
    }
  std::mt19937_64 random(7);
  int read_well = 0;
  constexpr int kTries = 12'000;
  for (int i = 0; i < kTries; ++i) {
    const std::string text = damaged(sources[random() % sources.size()], random);
    SCOPED_TRACE(text);
    const auto result = parse_nff(text, "damaged.nff");
    if (result) {
      ++read_well;
      ASSERT_THAT(validate(result->scene), IsEmpty());
      continue;
    }
    ASSERT_FALSE(result.error().empty());
    ASSERT_LE(result.error().size(), kMaxDiagnostics + 1);
    const int lines = 1 + int(std::count_if(text.begin(), text.end(),
                                            [](char c) { return c == '\n' || c == '\r'; }));
    for (const Diagnostic& d : result.error()) {
      ASSERT_EQ(d.severity, Severity::error);
      ASSERT_FALSE(d.message.empty());
      ASSERT_TRUE((d.line == 0 && d.column == 0) || (d.line > 0 && d.column > 0)) << d.text();
      ASSERT_LE(d.line, lines);
      const std::string line = d.text();
      ASSERT_TRUE(std::all_of(line.begin(), line.end(), [](char c) { return c >= 32 && c < 127; }));
    }
  }
  EXPECT_GT(read_well, kTries / 50);
  EXPECT_LT(read_well, kTries / 2);
}

TEST(NffDamage, IsReportedEquallyInALongText) {
  const std::string head = kCamera + kMaterial, sphere = "s 0 0 0 1\n", spheres = many_spheres();
  const int more_lines = int(std::count(spheres.begin(), spheres.end(), '\n')) - 1;
  const size_t more = spheres.size() / sphere.size() - 1;
  std::mt19937_64 random(11);
  int read_well = 0;
  constexpr int kTries = if_sanitized(60, 200);
  for (int i = 0; i < kTries; ++i) {
    const std::string broken = damaged(kObjects + "l 1 2 3\nb 0 0 0\n" + kObjects, random) + "\n";
    SCOPED_TRACE(broken);
    auto small = parse_nff(head + sphere + broken + sphere, "t.nff");
    const auto large = parse_nff(head + spheres + broken + spheres, "t.nff");
    ASSERT_EQ(bool(small), bool(large));
    Diagnostics expected = small ? small->notices : small.error();
    const Diagnostics& found = large ? large->notices : large.error();
    if (texts(expected).find("bytes left in the file") != std::string::npos ||
        texts(expected).find("not a text file") != std::string::npos)
      continue;  // these name sizes and offsets
    for (Diagnostic& d : expected)
      if (d.line > 9) d.line += more_lines;
    ASSERT_EQ(texts(expected), texts(found));
    if (!small) continue;
    ++read_well;
    Scene& scene = small->scene;
    for (const bool front : {true, false}) {
      const Sphere unit = scene.spheres.front();
      const MaterialId id = front ? 0 : scene.sphere_materials.back();
      const auto add = [&](auto& all, auto item) {
        all.insert(front ? all.begin() : all.end(), more, item);
      };
      add(scene.spheres.writable(), unit), add(scene.sphere_materials.writable(), id);
    }
    expect_same(scene, large->scene);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(read_well, 0);
}

}  // namespace
}  // namespace raio::core
