// Hostile input: damaged scene files, degenerate and coincident geometry, numbers at the ends of
// their range, and pictures beyond memory. For any input, an error says where it is wrong, or every
// structure gives the same finite picture in bounded time and memory.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <random>

#include "io/nff/nff.h"
#include "nff_text.h"
#include "one_picture.h"
#include "sanitized.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using tests::expect_one_picture;
using tests::if_sanitized;
using tests::read;
using tests::texts;

namespace fs = std::filesystem;

constexpr int kRounds = if_sanitized(8, 40);

const std::string kFrontCamera = "v\nfrom 0 -5 1\nat 0 0 0\nup 0 0 1\nangle 45\n";
const std::string kLight = "l 3 -4 5\nl -1 -4 2\n";
const std::string kDullMaterial = "f 1 0.5 0.2 0.6 0.4 10 0 1\n";
const std::string kGlass = "f 1 1 1 0.1 0.5 10 0.9 1.5\n";

RenderOptions square(int side, int depth = 5) {
  RenderOptions o;
  o.width = o.height = side;
  o.aa = 1;
  o.depth = depth;
  return o;
}

// Damaged files.

const char* const kBadNumbers[] = {
    "nan", "inf", "-inf", "1e39",  "-1e39", "-0",         "1e-45",  "-1e-45", "1e-38", "3e38",
    "0",   "-1",  "1e20", "-1e19", "1e-20", "4294967296", "-2e9",   "1e400",  "1e9",   "0x10",
    "1,5", "",    "--1",  "1e",    "+",     "16777217",   "179.99", "3.4e38", "1e10",  "1e-10"};

/// The scene with changed numbers, duplicated or moved lines, flipped bits, or its end truncated.
std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](size_t n) { return size_t(random() % std::max<size_t>(n, 1)); };
  const auto number_at = [&] { return text.find_first_of("0123456789", below(text.size())); };
  for (size_t changes = 1 + below(3); changes > 0 && !text.empty(); --changes) {
    const size_t line = text.find('\n', below(text.size())), at = number_at();
    const size_t end = text.find('\n', line + 1);
    const size_t kind = below(20);
    if (kind < 14 && at != text.npos) {
      const size_t number_end = text.find_first_of(" \t\n", at);
      text.replace(at, number_end - at, kBadNumbers[below(std::size(kBadNumbers))]);
    } else if (kind < 17 && end != text.npos) {
      text.insert(text.find('\n', below(text.size())) + 1, text.substr(line + 1, end - line));
    } else if (kind < 18) {
      text[below(text.size())] ^= char(1 << below(8));
    } else if (kind < 19) {
      text.resize(below(text.size()));
    } else if (end != text.npos) {
      text.erase(line + 1, end - line);
    }
  }
  return text;
}

class Damaged : public testing::TestWithParam<const char*> {};

TEST_P(Damaged, IsRefusedWithALocationOrGivesOnePicture) {
  const fs::path path = fs::path(RAIO_SOURCE_DIR) / "scenes" / (GetParam() + std::string(".nff"));
  std::ifstream stream(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  ASSERT_FALSE(whole.empty());
  std::mt19937 random(1);
  int rendered = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::string text = damaged(whole, random);
    SCOPED_TRACE(testing::Message() << GetParam() << " round " << round);
    const auto result = parse_nff(text, "t.nff");
    if (!result) {
      ASSERT_FALSE(result.error().empty());
      EXPECT_TRUE(std::ranges::any_of(result.error(), [](auto& d) { return d.line > 0; }) ||
                  texts(result.error()).find("no camera") != std::string::npos)
          << texts(result.error());
      continue;
    }
    ++rendered;
    ASSERT_THAT(validate(result->scene), IsEmpty());
    expect_one_picture(result->scene, square(6, 3));
    if (HasFailure()) std::ofstream(testing::TempDir() + "failed.nff") << text;
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_GT(rendered, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Damaged,
                         testing::Values("gears", "lattice", "mount", "rings", "shapes",
                                         "sphereflake", "teapot", "tetra", "tree"),
                         [](const auto& scene) { return std::string(scene.param); });

// Degenerate and extreme geometry.

struct Case {
  const char* name;
  std::string text;  // after camera, lights and material
  const char* refused = nullptr;
};

const std::string kFloor = "p 4\n-9 -9 -1\n9 -9 -1\n9 9 -1\n-9 9 -1\n";

const Case kDegenerate[] = {
    {"SphereWithoutRadius", "s 0 0 0 0\n", "radius"},
    {"SphereOfTheLeastRadius", "s 0 0 0 1e-45\n"},
    {"SphereOfTheLargestRadius", "s 0 0 0 3e38\n"},
    {"SphereThatIsFarAway", "s 0 1e30 0 1e29\ns 0 1e30 0 1\n" + kFloor},
    {"SphereAtTheEndOfFloats", "s 0 3e38 0 3e38\n" + kFloor},
    {"ConeWithoutLength", "c 0 0 0 1 0 0 0 1\n", "c"},
    {"ConeOfTheLeastLength", "c 0 0 0 1 0 0 1e-45 1\n"},
    {"CylinderLikeAHair", "c -1 0 -1 1e-30 1 0 1 1e-30\n" + kFloor},
    {"ConeFromNothingToAll", "c 0 0 0 0 0 0 1e30 1e30\n" + kFloor},
    {"ConeFarAway", "c 0 1e30 0 1e29 0 1e30 1e30 1\n"},
    {"TriangleInOnePoint", "p 3\n0 0 0\n0 0 0\n0 0 0\n" + kFloor, "area"},
    {"TriangleInALine", "p 3\n0 0 0\n1 1 1\n2 2 2\n" + kFloor, "area"},
    {"TriangleLikeANeedle", "p 3\n-1 0 0\n1 0 0\n0 0 1e-38\n" + kFloor},
    {"TriangleFarAway", "p 3\n-1e30 1e30 -1e30\n1e30 1e30 -1e30\n0 1e30 1e30\n"},
    {"TriangleAtTheEndOfFloats", "p 3\n-3e38 3e38 -3e38\n3e38 3e38 -3e38\n0 3e38 3e38\n"},
    {"QuadInALine", "p 4\n0 0 0\n1 0 0\n2 0 0\n3 0 0\n" + kFloor, "area"},
    {"BowTie", "p 4\n-1 0 -1\n1 0 1\n1 0 -1\n-1 0 1\n"},
    {"StarThatCrossesItself", "p 5\n0 0 1\n0.6 0 -0.8\n-1 0 0.3\n1 0 0.3\n-0.6 0 -0.8\n"},
    {"PolygonWithAllCornersTwice",
     "p 8\n-1 0 -1\n-1 0 -1\n1 0 -1\n1 0 -1\n1 0 1\n1 0 1\n-1 0 1\n-1 0 1\n"},
    {"SmoothTriangleWithNormalsAway", "pp 3\n-1 0 0 0 1 0\n1 0 0 0 1 0\n0 0 1 0 1 0\n"},
    {"PlaneOfOnePoint", "pl 0 0 0 0 0 0 0 0 0\n", "pl"},
    {"PlaneThroughTheEye", "pl 0 -5 1 1 -5 1 0 -4 1\n" + kFloor},
    {"BoxWithoutHeight", "box -1 -1 0 1 1 0\n", "lowest z"},
    {"BoxOfAllSpace", "box -3e38 -3e38 -3e38 3e38 3e38 3e38\n"},
    {"EyeInsideASphere", "s 0 -5 1 2\ns 0 0 0 1\n" + kFloor},
    {"EyeInsideGlass", kGlass + "s 0 -5 1 2\ns 0 0 0 1\n" + kFloor},
    {"EyeOnASurface", "s 0 -5 0 1\n" + kFloor},
    {"EyeAtTheCentre", "s 0 -5 1 1\ns 0 -5 1 2\n"},
    {"LightInsideASphere", "l 0 0 0\ns 0 0 0 1\n" + kFloor},
    {"LightOnASurface", "l 0 -1 0\ns 0 0 0 1\n" + kFloor},
    {"LightAtTheEye", "l 0 -5 1\ns 0 0 0 1\n" + kFloor},
    {"LightInAPlane", "l 0 0 -1\n" + kFloor},
    {"LightFarAway", "l 0 -1e30 1e30\ns 0 0 0 1\n" + kFloor},
    {"LightAtTheEndOfFloats", "l 0 -3e38 3e38\ns 0 0 0 1\n" + kFloor},
    {"LightsInOnePlace", "l 1 -3 3\nl 1 -3 3\nl 1 -3 3\ns 0 0 0 1\n" + kFloor},
    {"LightBeyondAllMeasure", "l 1 -3 3 3e38 3e38 3e38\ns 0 0 0 1\n" + kFloor},
    {"MaterialBeyondAllMeasure", "f 3e38 3e38 3e38 3e38 3e38 3e38 3e38 3e38\ns 0 0 0 1\n" + kFloor},
    {"RefractionBeyondAllMeasure", "f 1 1 1 0.1 0.5 10 0.9 1e-45\ns 0 0 0 1\n" + kFloor},
    {"TinyThingsFarApart", "s 0 0 0 1e-30\ns 1e30 0 0 1e-30\ns -1e30 0 0 1e-30\n"},
};

class Degenerate : public testing::TestWithParam<Case> {};

TEST_P(Degenerate, IsRefusedWithALocationOrGivesOnePicture) {
  const Case& c = GetParam();
  const std::string text = kFrontCamera + kLight + kDullMaterial + c.text;
  const auto result = parse_nff(text, "t.nff");
  if (c.refused) {
    const std::string said = texts(result ? result->notices : result.error());
    EXPECT_THAT(said, HasSubstr(c.refused));
    EXPECT_THAT(said, HasSubstr("t.nff:"));
  }
  if (!result) {
    EXPECT_TRUE(c.refused) << texts(result.error());
    return;
  }
  RenderOptions options = square(24);
  expect_one_picture(result->scene, options);
  options.soft_shadows = true;
  options.dof = true;
  options.lens_samples = 2;
  expect_one_picture(result->scene, options);
}

INSTANTIATE_TEST_SUITE_P(Geometry, Degenerate, testing::ValuesIn(kDegenerate),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(Hostile, BlindCamerasAreRefusedWithALocation) {
  for (const char* camera :
       {"from 0 0 0\nat 0 0 0\nup 0 0 1\nangle 45", "from 0 0 1\nat 0 0 0\nup 0 0 1\nangle 45",
        "from 0 0 1\nat 0 0 0\nup 0 0 0\nangle 45", "from 0 0 1\nat 0 0 0\nup 0 1 0\nangle 0",
        "from 0 0 1\nat 0 0 0\nup 0 1 0\nangle 180",
        "from 0 0 1\nat 0 0 0\nup 0 1 0\nangle 45\nresolution 0 0",
        "from 0 0 1\nat 0 0 0\nup 0 1 0\nangle 45\nresolution -3 5",
        "from 0 0 1\nat 0 0 0\nup 0 1 0\nangle 45\nresolution 1e9 1e9"}) {
    const auto result = parse_nff("v\n" + std::string(camera) + "\ns 0 0 0 1\n", "t.nff");
    ASSERT_FALSE(result) << camera;
    EXPECT_GT(result.error().front().line, 0) << camera;
  }
}

TEST(Hostile, CamerasAtTheEndOfFloatsGiveOnePicture) {
  for (const char* camera : {"from 3e38 0 0\nat -3e38 0 0\nup 0 0 1\nangle 45",
                             "from 0 0 0\nat 0 1e-45 0\nup 0 0 1\nangle 45",
                             "from 0 -5 1\nat 0 0 0\nup 0 0 3e38\nangle 179.99",
                             "from 0 -5 1\nat 0 0 0\nup 0 0 1e-45\nangle 1e-30",
                             "from 0 -1e30 1\nat 0 0 0\nup 0 0 1\nangle 1e-28"})
    expect_one_picture(
        read("v\n" + std::string(camera) + "\n" + kLight + kDullMaterial + "s 0 0 0 1\n" + kFloor),
        square(16));
}

// Coincident primitives: building must not split them forever.

TEST(Hostile, ThousandsOfCoincidentPrimitivesGiveOnePicture) {
  const std::string same[] = {"s 0 0 0 1\n", "p 3\n-1 0 -1\n1 0 -1\n0 0 1\n",
                              "c 0 0 -1 1 0 0 1 0.5\n"};
  std::string all;
  for (const std::string& text : same) {
    std::string many;
    for (int i = 0; i < 250 * kRounds; ++i) many += text;
    all += many;
    const Scene scene = read(kFrontCamera + kLight + kDullMaterial + many);
    const auto tree = build_accel(scene, {.kind = AccelKind::bvh});
    EXPECT_LT((*tree)->info().bytes, 10 * memory_bytes(scene) + 1'000'000);
    const auto grid = build_accel(scene, {.kind = AccelKind::grid});  // may list each in many cells
    EXPECT_LT((*grid)->info().references, 10'000'000 + 100 * scene.primitive_count());
    expect_one_picture(scene, square(3, 1));
  }
  expect_one_picture(read(kFrontCamera + kLight + kDullMaterial + all), square(3, 2));
}

TEST(Hostile, PolygonsOfManyCornersAreBuiltInBoundedTime) {
  const int corners = 2500 * kRounds;  // 100,000
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  const std::pair<const char*, std::function<Vec3f(int)>> outlines[] = {
      {"a circle",
       [&](int i) {
         const double angle = i * 2 * 3.14159265 / corners;
         return Vec3f(float(std::cos(angle)), 0, float(std::sin(angle)));
       }},
      {"a comb", [&](int i) { return Vec3f(float(i) / float(corners), 0, i % 2 ? 1.0f : 0.0f); }},
      {"points anywhere",
       [&](int) {
         const float x = unit(random), z = unit(random);
         return Vec3f(x, 0, z);
       }},
      {"one point", [&](int) { return Vec3f(1, 2, 3); }},
      {"two points", [&](int i) { return Vec3f(float(i % 2), 0, 0); }},
      {"a line", [&](int i) { return Vec3f(float(i), 0, float(i)); }}};
  for (const auto& [name, corner] : outlines) {
    SCOPED_TRACE(name);
    Scene scene = read(kFrontCamera + kLight + kDullMaterial, true);
    for (int i = 0; i < corners; ++i) scene.positions.push_back(corner(i));
    scene.polygons = {{0, uint32_t(corners)}};
    scene.polygon_materials = {0};
    for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh}) {
      const auto accel = build_accel(scene, {.kind = kind});
      ASSERT_TRUE(accel) << accel.error().text();
      EXPECT_LT((*accel)->info().bytes, 100 * memory_bytes(scene) + 1'000'000);
    }
  }
}

// Found by fuzzing.

TEST(Hostile, TheGridFindsRoundedHitsFromAfar) {
  const Scene scene = read(kFrontCamera + kLight + kDullMaterial +
                           "s 0 0 0 4294967296\ns -0.1 -0.1 0.6 1e-22\ns 0.4 0.6 0.2 0.02\n"
                           "s -0.4 0.2 0.3 0.02\ns 0.3 0.5 -0.4 0.02\n" +
                           kFloor);
  expect_one_picture(scene, square(64));
}

TEST(Hostile, NearlyDegenerateShapesAreReadOrDropped) {
  for (const std::string& objects :
       {std::string("mesh 4 2\n0 0 0\n1 0 0\n0.5 1e20 0\n0 1e-20 1e20\n1 2 3\n1 3 4\n"),
        std::string("box 0 0 0 1e20 1 1e-10\n"),
        std::string("pp 4\n0 0 0 0 0 1\n1e20 0 0 0 0 1\n1e20 1 0 0 0 1\n0 1 0 0 0 1\n")}) {
    const std::string written = write_nff(read(kFrontCamera + kDullMaterial + objects, true));
    EXPECT_EQ(write_nff(read(written, true)), written);
  }
}

// Deep trees of rays.

TEST(Hostile, FacingMirrorsEndAtTheLastLevel) {
  const Scene scene = read(kFrontCamera + kLight +
                           "f 1 1 1 0.1 1 10 0 1\npl 0 0 -2 1 0 -2 0 1 -2\npl 0 0 2 0 1 2 1 0 2\n");
  expect_one_picture(scene, square(16, kMaxDepth));
}

TEST(Hostile, NestedGlassEndsAtTheLastLevel) {
  // A hit on glass has two children: this checks that 2^32 rays are never all made. Without a
  // mirror part each hit has one.
  std::string shells = "f 1 1 1 0.1 0 10 0.9 1.5\n";
  for (int i = 1; i <= 40; ++i) shells += "s 0 0 0 " + std::to_string(0.05 * i) + "\n";
  expect_one_picture(read(kFrontCamera + kLight + shells), square(4, 10));
}

// Sizes beyond memory, through the program.

class HostileProgram : public TemporaryFolder {
 protected:
  /// The exit status of `arguments` with this memory limit, or minus the signal; errors are in
  /// said().
  int run(const std::string& arguments, rlim_t memory = RLIM_INFINITY) {
    const std::string command =
        "'" RAIO_PROGRAM "' " + arguments + " >'" + file("said").string() + "' 2>&1";
    const pid_t child = ::fork();
    if (child == 0) {
      const rlimit limit{memory, memory};
      ::setrlimit(RLIMIT_AS, &limit);
      ::execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
      ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string said() const { return get(file("said")); }
};

TEST_F(HostileProgram, PicturesBeyondMemoryAreRefused) {
  const std::string render =
      "render '" RAIO_SOURCE_DIR "/scenes/tetra.nff' -o '" + file("a.ppm").string() + "' --size ";
  for (const char* size : {"1048576x1048576", "100000x100000", "65536x65536"}) {
    EXPECT_EQ(run(render + size), 3) << said();
    EXPECT_THAT(said(), HasSubstr("--size"));
  }
  for (const char* size :
       {"0x5", "-1x5", "1e9x1", "2147483648x1", "5x", "x", "99999999999999999999x1"}) {
    EXPECT_EQ(run(render + size), 2) << said();
    EXPECT_THAT(said(), HasSubstr("WIDTHxHEIGHT"));
  }
}

#ifndef RAIO_SANITIZED  // which reserve far more
TEST_F(HostileProgram, ReportsExhaustedMemory) {
  const std::string render = "render '" RAIO_SOURCE_DIR "/scenes/tetra.nff' -o '" +
                             file("a.ppm").string() + "' --threads 2 --size ";
  EXPECT_EQ(run(render + "31623x31623", rlim_t(2) << 30), 3) << said();
  EXPECT_EQ(run(render + "10000x10000", rlim_t(2) << 30), 3) << said();
  EXPECT_EQ(run(render + "64x64", rlim_t(2) << 30), 0) << said();
  EXPECT_FALSE(said().empty());
}
#endif

}  // namespace
}  // namespace raio::core
