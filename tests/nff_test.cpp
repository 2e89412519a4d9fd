#include "io/nff/nff.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <fstream>
#include <random>
#include <sstream>

#include "io/nff/geometry.h"
#include "io/nff/text_cursor.h"
#include "nff_text.h"
#include "shape/polygon.h"
#include "shape/triangle.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using tests::corners;
using tests::expect_same;
using tests::file_text;
using tests::kCamera;
using tests::kMaterial;
using tests::many_spheres;
using tests::read;
using tests::read_objects;
using tests::same;
using tests::texts;

// Numbers.

TEST(NffNumber, FormsThatPeopleWrite) {
  const std::pair<const char*, double> cases[] = {{"0", 0},
                                                  {"-0", 0},
                                                  {"+1", 1},
                                                  {".5", 0.5},
                                                  {"-.5", -0.5},
                                                  {"5.", 5},
                                                  {"1e-3", 1e-3},
                                                  {"1E+3", 1e3},
                                                  {"1.11022e-16", 1.11022e-16},
                                                  {"00012.50", 12.5},
                                                  {"12345678", 12345678},
                                                  {"123456789.123456789", 123456789.123456789},
                                                  {"1e-400", 0},
                                                  {"0e999999999999999", 0},
                                                  {"0.1e1", 1},
                                                  {"9007199254740993", 9007199254740992},
                                                  {"1e999999", INFINITY},
                                                  {"-1e999999", -INFINITY}};
  for (const auto& [text, expected] : cases) {
    const TextBuffer buffer(text);
    double value = 77;
    EXPECT_EQ(parse_number(buffer.begin(), value), buffer.end()) << text;
    EXPECT_EQ(value, expected) << text;
  }
  const std::string tiny = "0." + std::string(400, '0') + "1", huge = std::string(400, '9');
  double value = 77;
  EXPECT_NE(parse_number(TextBuffer(tiny).begin(), value), nullptr);
  EXPECT_EQ(value, 0);
  EXPECT_NE(parse_number(TextBuffer(huge + "e-380").begin(), value), nullptr);
  EXPECT_EQ(value, 1e20);
}

TEST(NffNumber, InvalidNumbers) {
  for (const char* text : {"", "-", "+", ".", "-.", "e5", "1e", "1e+", "nan", "inf", "12abc",
                           "1.2.3", "1-2", "--1", "+-1", "0x10", "1,5", "1e5.5", "\xc2\xbd"}) {
    double value;
    EXPECT_EQ(parse_number(TextBuffer(text).begin(), value), nullptr) << text;
  }
}

TEST(NffNumber, NearestDoubleOfRandomDigits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    std::string text = random() % 2 ? "-" : "";
    const size_t whole = random() % 12, fraction = random() % 12 + (whole == 0);
    for (size_t k = 0; k < whole; ++k) text += char('0' + random() % 10);
    if (fraction) text += '.';
    for (size_t k = 0; k < fraction; ++k) text += char('0' + random() % 10);
    if (random() % 3 == 0) text += fmt::format("e{}", int(random() % 80) - 40);
    double expected = 0, value = 1;
    std::from_chars(text.data(), text.data() + text.size(), expected);
    const TextBuffer buffer(text);
    ASSERT_EQ(parse_number(buffer.begin(), value), buffer.end()) << text;
    ASSERT_EQ(std::bit_cast<uint64_t>(value), std::bit_cast<uint64_t>(expected)) << text;
  }
}

// Entities.

TEST(NffRead, CameraBackgroundLightsAndMaterial) {
  const Scene scene = read("b 0.078 0.361 0.753\n" + kCamera +
                           "l 1 2 3\nl 4 5 6 1 0.5 2 # a bright one\n" + kMaterial + "s 1 2 3 4\n");
  EXPECT_EQ(scene.name, "t");
  EXPECT_EQ(scene.background, Rgb(0.078f, 0.361f, 0.753f));
  EXPECT_EQ(scene.camera.from, Vec3f(2, 1, 1));
  EXPECT_EQ(scene.camera.at, Vec3f(0, 0, 0));
  EXPECT_EQ(scene.camera.up, Vec3f(0, 0, 1));
  EXPECT_EQ(scene.camera.fov_deg, 45);
  EXPECT_EQ(scene.requests.near_clip, 1);
  EXPECT_EQ(scene.camera.width, 64);
  EXPECT_EQ(scene.camera.height, 48);
  EXPECT_FALSE(scene.camera.lens_radius || scene.camera.focus_distance);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_EQ(scene.lights[0].position, Vec3f(1, 2, 3));
  EXPECT_FALSE(scene.lights[0].color);
  EXPECT_EQ(scene.lights[1].color, Rgb(1, 0.5f, 2));
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.materials[0], (Material{{1, 0.5f, 0.25f}, 0.5f, 0.5f, 3, 0, 0}));
  ASSERT_EQ(scene.spheres.size(), 1u);
  EXPECT_TRUE(same(scene.spheres[0], Sphere{{1, 2, 3}, 4}));
}

TEST(NffRead, LineEndsCommentsAndBlanksDoNotMatter) {
  const std::string text =
      kCamera + kMaterial + "c 0 0 0 1 0 0 1 0.5\ns 0 0 0 -1\np 3\n0 0 0\n1 0 0\n0 1 0\n";
  const Scene scene = read(text);
  const auto with = [&](std::string_view line_end) {
    std::string out;
    for (const char c : text) c == '\n' ? out += line_end : out += c;
    return out;
  };
  for (const char* line_end : {"\r", "\r\n", "\n\n", " # 7 8 9\n", "#\r", "\t \v\f\n"})
    expect_same(scene, read(with(line_end)));
  expect_same(scene, read("\xef\xbb\xbf" + text));
  std::string tokens = text;
  std::replace(tokens.begin(), tokens.end(), '\n', ' ');
  expect_same(scene, read(tokens));
  std::replace(tokens.begin(), tokens.end(), ' ', '\n');
  expect_same(scene, read(tokens));
  expect_same(scene, read(text.substr(0, text.size() - 1)));
}

TEST(NffRead, ConesCylindersAndInsides) {
  const Scene scene = read_objects(
      "c 0 0 0 1 0 0 1 1\nc\n0 0 0 1\n0 0 1 0\nc 0 0 0 -1 0 0 1 -2\ns 0 0 0 -3\nc 0 0 0 0 0 0 1 "
      "1\n");
  const auto counts = count_primitives(scene);
  EXPECT_EQ(counts[size_t(ShapeKind::cylinder)], 1u);
  EXPECT_EQ(counts[size_t(ShapeKind::cone)], 3u);
  EXPECT_TRUE(same(scene.cones[1], Cone{{0, 0, 0}, 1, {0, 0, 1}, 0}));
  EXPECT_TRUE(same(scene.cones[2], Cone{{0, 0, 0}, -1, {0, 0, 1}, -2}));
  EXPECT_EQ(scene.spheres[0].radius, -3);
}

TEST(NffRead, PolygonsByTheirNumberOfCorners) {
  const Scene scene = read_objects(
      "p 3 0 0 0 1 0 0 0 1 0\np 4 0 0 0 1 0 0 1 1 0 0 1 0\n"
      "p 6 0 0 0 2 0 0 2 1 0 1 1 0 1 2 0 0 2 0\np 4 0 0 0 0 0 0 1 0 0 1 1 0\n");
  EXPECT_EQ(scene.triangles.size(), 1u);
  EXPECT_TRUE(scene.triangle_normals.empty());
  ASSERT_EQ(scene.polygons.size(), 3u);
  EXPECT_EQ(scene.polygons[1].count, 6u);
  EXPECT_EQ(scene.positions[scene.polygons[1].first + 3], Vec3f(1, 1, 0));
}

TEST(NffRead, SmoothTrianglesAmongFlatOnes) {
  const Scene scene = read_objects(
      "p 3 0 0 0 1 0 0 0 1 0\npp 3\n0 0 0 0 0 2\n1 0 0 0 3 4\n0 1 0 1 0 0\np 3 0 0 1 1 0 1 0 1 "
      "1\n");
  ASSERT_EQ(scene.triangle_normals.size(), 3u);
  EXPECT_EQ(scene.triangle_normals[0][0], kNoNormal);
  EXPECT_EQ(scene.triangle_normals[2][0], kNoNormal);
  EXPECT_EQ(scene.normals[scene.triangle_normals[1][0]], Vec3f(0, 0, 1));
  EXPECT_EQ(scene.normals[scene.triangle_normals[1][1]], Vec3f(0, 0.6f, 0.8f));
}

TEST(NffRead, SmoothPolygonsAreCut) {
  // An L of six vertices with distinct normals.
  const Vec3f l[6] = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};
  std::string text = "pp 6\n";
  for (int i = 0; i < 6; ++i) text += fmt::format("{} {} 0 {} 1 1\n", l[i].x, l[i].y, i);
  const Scene scene = read_objects(text);
  EXPECT_TRUE(scene.polygons.empty());
  ASSERT_EQ(scene.triangles.size(), 4u);
  double area = 0;
  for (size_t t = 0; t < 4; ++t) {
    Vec3f p[3];
    for (int k = 0; k < 3; ++k) {
      p[k] = scene.positions[scene.triangles[t][k]];
      const auto corner = std::find(l, l + 6, p[k]) - l;
      const Vec3f n = scene.normals[scene.triangle_normals[t][k]];
      EXPECT_NEAR(n.x / n.y, double(corner), 1e-5);
    }
    area += 0.5 * cross(p[1] - p[0], p[2] - p[0]).z;
  }
  EXPECT_NEAR(area, 3, 1e-6);
}

TEST(NffRead, PlaneOfThreePoints) {
  const Scene scene =
      read_objects("pl 12 12 -0.5 -12 12 -0.5 -12 -12 -0.5\npl 0 0 0 0 0 1 0 1 0\n");
  ASSERT_EQ(scene.planes.size(), 2u);
  EXPECT_EQ(scene.planes[0].normal, Vec3f(0, 0, 1));
  EXPECT_EQ(scene.planes[0].point.z, -0.5f);
  EXPECT_EQ(scene.planes[1].normal, Vec3f(-1, 0, 0));
}

TEST(NffRead, BoxIsSixQuadsThatFaceOutwards) {
  const Scene scene = read_objects("box -1 -2 -3 4 5 6\n");
  ASSERT_EQ(scene.polygons.size(), 6u);
  const Vec3f center(1.5f, 1.5f, 1.5f);
  Vec3f sum;
  for (const Polygon& side : scene.polygons) {
    ASSERT_EQ(side.count, 4u);
    const Vec3f* c = &scene.positions[side.first];
    const Vec3f area = cross(c[2] - c[0], c[3] - c[1]) * 0.5f;
    EXPECT_GT(dot(area, c[0] - center), 0);
    sum += abs(area);
  }
  EXPECT_EQ(sum, Vec3f(2 * 7 * 9, 2 * 5 * 9, 2 * 5 * 7));
  const Box3f box = bounds(scene);
  EXPECT_EQ(box.lo, Vec3f(-1, -2, -3));
  EXPECT_EQ(box.hi, Vec3f(4, 5, 6));
}

TEST(NffRead, MeshSharesItsVertices) {
  const Scene scene = read_objects(
      "s 0 0 0 1\np 3 9 9 9 8 9 9 9 8 9\nmesh 4 3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n-4 -3 -1\n2 "
      "3 4\n");
  EXPECT_EQ(scene.positions.size(), 7u);
  ASSERT_EQ(scene.triangles.size(), 4u);
  EXPECT_EQ(scene.triangles[1], (TriangleIndices{3, 4, 5}));
  EXPECT_EQ(scene.triangles[2], (TriangleIndices{3, 4, 6}));
  EXPECT_EQ(scene.triangles[3], (TriangleIndices{4, 5, 6}));
}

TEST(NffRead, LensOfP3f) {
  const Scene scene = read(
      "spp 16\nbclr 0.1 0.2 0.3\nv\nfrom 0 0 4\nat 0 0 0\nup 0 1 0\nangle 90\nhither 0\n"
      "resolution 200 100\naperture 5\nfocal 1.5\n" +
      kMaterial + "s 0 0 0 1\n");
  EXPECT_EQ(scene.requests.samples_per_pixel, 16);
  EXPECT_EQ(scene.background, Rgb(0.1f, 0.2f, 0.3f));
  // 8 units high in 100 rows: pixels of 0.08.
  EXPECT_FLOAT_EQ(scene.camera.lens_radius.value(), 0.4f);
  EXPECT_FLOAT_EQ(scene.camera.focus_distance.value(), 6);
}

TEST(NffRead, EqualMaterialsAreOne) {
  const Scene scene = read(kCamera + kMaterial + "s 0 0 0 1\nf 1 1 1 1 0 1 0 1\ns 0 0 0 2\n" +
                           kMaterial + "s 0 0 0 3\n");
  EXPECT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(scene.sphere_materials, (std::vector<MaterialId>{0, 1, 0}));
}

TEST(NffRead, SceneFarFromZeroKeepsItsDigits) {
  const std::string text =
      "v\nfrom 1000010 5000000 3\nat 1000000 5000000 3\nup 0 0 1\nangle 45\nhither 0\n"
      "l 1000000.125 5000000 9\nf 1 1 1 1 0 1 0 1\ns 1000000.001 5000000.002 3 0.5\n"
      "p 3 1000000.1 5000000 0 1000001 5000000 0 1000000 5000001 0\n"
      "pl 1000000 5000000 0 1000001 5000000 0 1000000 5000001 0\n";
  const Scene scene = read(text);
  EXPECT_NE(scene.origin, Vec3d());
  const auto world = [&](Vec3f p) { return scene.origin + Vec3d(p); };
  EXPECT_NEAR(world(scene.spheres[0].center).x, 1000000.001, 1e-6);
  EXPECT_NEAR(world(scene.spheres[0].center).y, 5000000.002, 1e-6);
  EXPECT_NEAR(world(scene.positions[0]).x, 1000000.1, 1e-6);
  EXPECT_NEAR(world(scene.camera.from).x, 1000010, 1e-6);
  EXPECT_NEAR(world(scene.lights[0].position).x, 1000000.125, 1e-6);
  EXPECT_EQ(scene.planes[0].normal, Vec3f(0, 0, 1));
  expect_same(scene, read(write_nff(scene)));
  EXPECT_EQ(read_objects("s 0 0 0 1\n").origin, Vec3d());
}

TEST(NffRead, FilesThatCannotBeRead) {
  const auto message = [](const char* path) {
    const auto result = read_nff(path);
    return result ? std::string("read") : texts(result.error());
  };
  EXPECT_EQ(message("/nonexistent/a.nff"),
            "/nonexistent/a.nff: error: cannot open the file: No such file or directory\n");
  EXPECT_EQ(message("/tmp"), "/tmp: error: this is a folder, expected a file\n");
  EXPECT_EQ(message("/dev/null"), "/dev/null: error: this is a device, expected a file\n");
}

// Each file of a folder, and its messages, in expected.txt in the order of names.
void expect_what_is_said(const std::filesystem::path& folder, const char* suffix) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == suffix) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_GT(files.size(), 40u);
  const std::string expected = file_text(folder / "expected.txt");
  std::string said;
  for (const std::filesystem::path& file : files) {
    const std::string name = file.filename().string();
    const auto result = parse_nff(file_text(file), name);
    const std::string text = texts(result ? result->notices : result.error());
    EXPECT_NE(text, "") << name << " is not broken";
    EXPECT_THAT(expected, HasSubstr(text)) << name;
    said += text;
    if (result) {
      EXPECT_THAT(validate(result->scene), IsEmpty()) << name;
    }
  }
  EXPECT_EQ(said, expected);
}

TEST(NffRead, BrokenFiles) { expect_what_is_said(RAIO_SOURCE_DIR "/tests/broken", ".nff"); }

TEST(P3fRead, BrokenFiles) { expect_what_is_said(RAIO_SOURCE_DIR "/tests/broken/p3f", ".p3f"); }

// Long texts, which are read in pieces.

/// Longer than two pieces. Some of everything in a piece, with few materials and long stretches
/// without any.
std::string random_objects(std::mt19937_64& random, size_t bytes) {
  const auto n = [&] { return fmt::format("{} ", double(random() % 20001) / 1000 - 10); };
  const auto repeat = [](size_t count, const auto& make) {
    std::string out;
    for (size_t i = 0; i < count; ++i) out += make();
    return out;
  };
  const auto corners = [&](size_t count, std::string_view more) {
    return repeat(count, [&] { return "\n" + n() + n() + n() + std::string(more); });
  };
  std::string text;
  // The first smooth triangle comes late, the last stretch has none.
  while (text.size() < bytes) {
    const bool may_be_smooth = text.size() > bytes / 2 && text.size() < bytes * 3 / 4;
    switch (random() % 8) {
      case 0:
        text += "c " + n() + n() + n() + " 1 " + n() + n() + n() + "0.5";
        break;
      case 1:
        text += "pl 0 0 " + n() + "1 0 1 0 1 " + n();
        break;
      case 2:
        text += "box -11 -12 -13 " + n() + n() + n();
        break;
      case 3:
        text += "mesh 4 2" + corners(4, "") + "\n1 2 3\n-1 -2 -3";
        break;
      case 4:
        text += "p 5" + corners(5, "");
        break;
      case 5:
        text += may_be_smooth ? "pp 4" + corners(4, "0 0.6 0.8") : "p 3" + corners(3, "");
        break;
      case 6:
        if (random() % 200 == 0) text += fmt::format("f 1 1 1 0.{} 0 3 0 0\n", 1 + random() % 4);
        [[fallthrough]];
      default:
        text += "s " + n() + n() + n() + "1";
    }
    text += '\n';
  }
  return text;
}

TEST(NffPieces, GiveTheSceneOfATextThatCannotBeCut) {
  std::mt19937_64 random(3);
  for (const size_t bytes : {150'000, 1'000'000, 12'000'000}) {
    std::string text = kCamera + kMaterial + random_objects(random, bytes);
    const Scene scene = read(text);
    std::replace(text.begin(), text.end(), '\n', ' ');
    const Scene whole = read(text);
    expect_same(whole, scene);
    EXPECT_EQ(whole.triangles, scene.triangles);
    EXPECT_EQ(whole.triangle_normals, scene.triangle_normals);
    EXPECT_FALSE(scene.triangle_normals.empty());
  }
}

TEST(NffPieces, BeginWithTheMaterialBefore) {
  const Scene scene = read(kCamera + kMaterial + many_spheres() + "f 1 1 1 1 0 1 0 1\n" +
                           many_spheres() + kMaterial + many_spheres());
  EXPECT_EQ(scene.materials.size(), 2u);
  const size_t third = scene.spheres.size() / 3;
  for (size_t i = 0; i < scene.spheres.size(); ++i)
    ASSERT_EQ(scene.sphere_materials[i], MaterialId(i / third == 1)) << i;
}

TEST(NffPieces, WarningsComeInOrderAndAreCounted) {
  std::string text = kCamera + kMaterial;
  const std::string spheres = many_spheres();
  const size_t lines = size_t(std::count(spheres.begin(), spheres.end(), '\n')) + 1;
  for (int i = 0; i < 30; ++i) text += spheres + "p 3 0 0 0 1 1 1 2 2 2\n";
  const auto result = parse_nff(text, "t.nff");
  ASSERT_TRUE(result);
  ASSERT_EQ(result->notices.size(), kMaxDiagnostics + 1);
  for (size_t i = 0; i < kMaxDiagnostics; ++i) {
    EXPECT_EQ(size_t(result->notices[i].line), 8 + (i + 1) * lines);
    EXPECT_EQ(result->notices[i].excerpt, "p 3 0 0 0 1 1 1 2 2 2");
  }
  EXPECT_EQ(result->notices.back().message, "10 more warnings not shown");
}

TEST(NffPieces, TheHeadMayBeAnywhere) {
  // Nothing can be read in pieces before there is an object with a material; here none is.
  const std::string spheres = many_spheres();
  const auto result = parse_nff(spheres + kCamera + "l 1 2 3\n" + kMaterial + spheres, "t.nff");
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scene.materials.size(), 2u);
  EXPECT_EQ(result->scene.sphere_materials.front(), 0u);
  EXPECT_EQ(result->scene.sphere_materials.back(), 1u);
  EXPECT_EQ(result->scene.camera.width, 64);
  EXPECT_EQ(result->scene.lights.size(), 1u);
  ASSERT_EQ(result->notices.size(), 3u);
  EXPECT_THAT(result->notices[0].message, HasSubstr("an object before any f"));
  EXPECT_THAT(result->notices[1].message, HasSubstr("v follows objects"));
  EXPECT_THAT(result->notices[2].message, HasSubstr("a light follows objects"));
}

TEST(NffPieces, LargeFilesAreReadAsTheyAre) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "large.nff";
  std::string text = kCamera + kMaterial;
  for (int i = 0; text.size() < 9'000'000; ++i) text += fmt::format("s {} 0 0 1\n", i);
  std::ofstream(path, std::ios::binary) << text;
  const auto buffer = TextBuffer::read_file(path);
  ASSERT_TRUE(buffer);
  EXPECT_TRUE(buffer->view() == text);
  EXPECT_EQ(*buffer->end(), '\0');
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace raio::core
