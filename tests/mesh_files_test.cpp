// Files of meshes and points.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/srgb.h"
#include "data_files.h"
#include "io/colormaps.h"
#include "io/fit_camera.h"
#include "io/mesh/write.h"
#include "io/scene_file.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

TEST(Ply, PointsAreSpheres) {
  const auto text = read(ply("ascii", 5000, true), "a.ply");
  ASSERT_TRUE(text) << text.error().front().text();
  const Scene& scene = text->scene;
  EXPECT_TRUE(validate(scene).empty());
  ASSERT_EQ(scene.spheres.size(), 5000u);
  EXPECT_EQ(scene.spheres[8].center, Vec3f(8, 0.5f, 0.375f));
  EXPECT_EQ(scene.spheres[8].radius, 2.25f);
  EXPECT_EQ(scene.sphere_colors[8], Rgb(linear_from_srgb(8.0f / 255), 0, 1));
  EXPECT_EQ(scene.sphere_opacity[8], 1);
  EXPECT_EQ(scene.sphere_opacity[9], 128.0f / 255);
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const auto binary = read(ply(format, 5000, true), "a.ply");
    ASSERT_TRUE(binary) << binary.error().front().text();
    EXPECT_EQ(content_hash(binary->scene), content_hash(scene));
  }
  EXPECT_TRUE(read(ply("ascii", 50, false), "a.ply")->scene.sphere_opacity.empty());
}

TEST(Ply, PointsWithoutRadiusTakeIt) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  for (int i = 0; i < 8; ++i)
    text += std::to_string(i & 1) + " " + std::to_string(i >> 1 & 1) + " " +
            std::to_string(i >> 2) + "\n";
  EXPECT_EQ(read(text, "a.ply", {.radius = 0.2f})->scene.spheres[3].radius, 0.2f);
  EXPECT_FLOAT_EQ(read(text, "a.ply")->scene.spheres[3].radius, 0.25f);
}

TEST(Ply, FacesAreAMesh) {
  const auto mesh = read(kMesh, "a.ply");
  ASSERT_TRUE(mesh) << mesh.error().front().text();
  EXPECT_TRUE(validate(mesh->scene).empty());
  ASSERT_EQ(mesh->scene.meshes.size(), 1u);
  EXPECT_EQ(mesh->scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(mesh->scene.meshes[0].colors[1], Rgb(0, 1, 0));
}

TEST(Ply, BrokenFilesAreRefused) {
  const std::string mesh(kMesh);
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = mesh;
    text.replace(text.find(from), from.size(), to);
    return error(text, "a.ply");
  };
  EXPECT_THAT(with("4 0 1 2 3", "4 0 1 2 4"), HasSubstr("face 0 names vertex 4, of 4"));
  EXPECT_THAT(with("4 0 1 2 3", "9999 0 1"), HasSubstr("does not fit"));
  EXPECT_THAT(with("1 1 0 0", "1 x 0 0"), HasSubstr("a.ply:15:1: error: expected a number"));
  EXPECT_THAT(with("vertex 4", "vertex 4000000000"), HasSubstr("do not fit in the file"));
  EXPECT_THAT(with("end_header\n", ""), HasSubstr("found"));
  EXPECT_THAT(with("property float z", "property float w"), HasSubstr("no property z"));
  EXPECT_THAT(with("property float z", "property real z"), HasSubstr("expected a type"));
  EXPECT_THAT(with("format ascii 1.0\n", ""), HasSubstr("no line \"format\""));
  EXPECT_THAT(error(ply("binary_little_endian", 50, true).substr(0, 900), "a.ply"),
              HasSubstr("ends within its vertices"));
}

// A strip of `count` quadrilaterals; its rows of text end with `end`.
std::string ply_of_faces(bool binary, int count, const std::string& end = "\n") {
  std::string out = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                    " 1.0\nelement vertex " + std::to_string(2 * count + 2) +
                    "\nproperty list uchar int more\nproperty float x\nproperty float y\n"
                    "property float z\nelement face " +
                    std::to_string(count) +
                    "\nproperty list uchar int vertex_indices\nproperty uchar red\n"
                    "property uchar green\nproperty uchar blue\nend_header\n";
  const auto add = [&](auto number) {
    if (binary)
      out.append(reinterpret_cast<const char*>(&number), sizeof number);
    else
      out += std::to_string(number) + " ";
  };
  for (int i = 0; i < 2 * count + 2; ++i) {
    const int more = i % 3;
    add(uint8_t(more));
    for (int k = 0; k < more; ++k) add(k - 7);
    add(float(i / 2)), add(float(i % 2)), add(float(i % 16) / 16);
    if (!binary) out += end;
  }
  for (int i = 0; i < count; ++i) {
    add(uint8_t(4)), add(2 * i), add(2 * i + 1), add(2 * i + 3), add(2 * i + 2);
    add(uint8_t(i % 5)), add(uint8_t(i % 3)), add(uint8_t(9));
    if (!binary) out += end;
  }
  return out;
}

TEST(Ply, RowsAreReadOnAllThreads) {
  const int faces = 9000;  // some chunks
  const auto binary = read(ply_of_faces(true, faces), "a.ply");
  ASSERT_TRUE(binary) << binary.error().front().text();
  const Mesh& mesh = binary->scene.meshes[0];
  ASSERT_EQ(mesh.triangles.size(), 2u * faces);
  EXPECT_EQ(mesh.positions[17], Vec3f(8, 1, 1.0f / 16));
  EXPECT_EQ(std::ranges::max(mesh.triangles.back()), 2u * faces + 1);
  // Rows that are no lines are found one after another.
  for (const char* end : {"\n", "\r\n", " ", "\n\n", "\t \n"}) {
    const auto text = read(ply_of_faces(false, faces, end), "a.ply");
    ASSERT_TRUE(text) << text.error().front().text();
    EXPECT_EQ(content_hash(text->scene), content_hash(binary->scene));
  }
  // The first of several faults is reported, with its line.
  std::string broken = ply_of_faces(false, faces);
  const auto line_of = [&](size_t at) {
    return std::to_string(std::count(broken.begin(), broken.begin() + ptrdiff_t(at), '\n') + 1);
  };
  const size_t late = broken.find("4 17000 "), early = broken.find("4 8200 8201 ");
  broken[late] = 'x', broken.replace(early + 2, 4, "99999");
  EXPECT_THAT(error(broken, "a.ply"),
              HasSubstr("a.ply:" + line_of(early) + ":1: error: face 4100 names vertex 99999"));
  broken.replace(early + 2, 5, "8200");
  EXPECT_THAT(error(broken, "a.ply"),
              HasSubstr("a.ply:" + line_of(late) + ":1: error: expected a"));
}

TEST(Ply, PropertiesAreColours) {
  const auto scene = read(ply("ascii", 5, false), "a.ply", {.color_by = "z", .colormap = "plasma"});
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->scene.sphere_colors[0], *map_color("plasma", 0));
  EXPECT_EQ(scene->scene.sphere_colors[4], *map_color("plasma", 1));
  EXPECT_EQ(read(kMesh, "a.ply", {.color_by = "y"})->scene.meshes[0].colors[2],
            *map_color("viridis", 1));
  EXPECT_THAT(error(kMesh, "a.ply", {.color_by = "chain"}), HasSubstr("there are \"x\", \"y\""));
  // They are not multiplied by those of the faces.
  const std::string painted =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n";
  const auto color = [&](const ReadOptions& options) {
    const auto got = read(painted, "a.ply", options);
    return got->scene.materials[got->scene.meshes[0].materials[0]].color;
  };
  EXPECT_EQ(color({}), Rgb(1, 0, 0));
  EXPECT_EQ(color({.color_by = "x"}), Rgb(1));
}

// Scanning programs write this for unknown normals.
TEST(Ply, NumbersMayBeNone) {
  const auto with = [](const std::string& type, const std::string& number) {
    return "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
           "float z\nproperty " +
           type + " a\nend_header\n0 0 0 " + number + "\n1 0 0 1\n";
  };
  for (const char* number : {"nan", "-NaN", "inf", "+Infinity", "-nan(ind)"}) {
    const auto got = read(with("float", number), "a.ply");
    ASSERT_TRUE(got) << number << got.error().front().text();
    EXPECT_EQ(got->scene.spheres.size(), 2u);
    EXPECT_THAT(error(with("uchar", number), "a.ply"), HasSubstr("expected a number, found"));
  }
  EXPECT_THAT(error(with("float", "nano"), "a.ply"), HasSubstr("found \"nano\""));
  std::string place = with("float", "1");
  place.replace(place.find("1 0 0 1"), 1, "nan");
  EXPECT_EQ(error(place, "a.ply"), "no error");  // vertices without a position are skipped
}

TEST(Ply, OddsAndEnds) {
  const std::string mesh(kMesh);
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = mesh;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THAT(error(with("4 0 1 2 3", "4 0 1 2 1.5"), "a.ply"), HasSubstr("names vertex 1.5"));
  // Elements without properties take no time, however many there are.
  EXPECT_THAT(error(with("element face", "element nothing 99999999999\nelement face"), "a.ply"),
              HasSubstr("do not fit in the file"));
  // A concave polygon is not triangulated outside of itself: the vertex 1 1 is inside the triangle.
  const auto dart = read(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty uchar red\n"
      "property uchar green\nproperty uchar blue\nend_header\n"
      "0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 0 1 2 3 255 0 0\n",
      "a.ply");
  ASSERT_TRUE(dart) << dart.error().front().text();
  for (const TriangleIndices& t : dart->scene.meshes[0].triangles)
    EXPECT_TRUE(std::ranges::count(t, 2u) && std::ranges::count(t, 0u));
  EXPECT_EQ(dart->scene.materials[dart->scene.meshes[0].materials[0]].color, Rgb(1, 0, 0));
  const auto strip = read(
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 2 3 4\n",
      "a.ply");
  ASSERT_TRUE(strip) << strip.error().front().text();
  const auto& triangles = std::as_const(strip->scene.meshes[0].triangles);
  ASSERT_EQ(triangles.size(), 3u);
  EXPECT_EQ(triangles[1], (TriangleIndices{2, 1, 3}));
  EXPECT_EQ(triangles[2], (TriangleIndices{2, 3, 4}));
  const std::string both =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
      "z\nproperty float radius\nelement tristrips 1\nproperty list int int vertex_indices\n"
      "element face 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0 1\n1 0 0 2\n0 1 0 3\n1 1 0 4\n";
  const auto strip_and_face = read(both + "3 0 1 2\n3 1 3 2\n", "a.ply");
  ASSERT_TRUE(strip_and_face) << strip_and_face.error().front().text();
  EXPECT_EQ(strip_and_face->scene.meshes[0].triangles.size(), 2u);
  // Without a face of three vertices there are only points.
  const auto points = read(both + "2 0 1\n2 1 3\n", "a.ply");
  ASSERT_TRUE(points) << points.error().front().text();
  ASSERT_EQ(points->scene.spheres.size(), 4u);
  EXPECT_EQ(points->scene.spheres[3].radius, 4);
}

TEST(Stl, TextAndBinaryAreTheSame) {
  const auto text = read(kStl, "a.stl");
  ASSERT_TRUE(text) << text.error().front().text();
  EXPECT_TRUE(validate(text->scene).empty());
  ASSERT_EQ(text->scene.meshes[0].triangles.size(), 2u);
  std::string binary(80, ' ');
  const auto add = [&](const auto& number) {
    binary.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(uint32_t(2));
  for (uint32_t t = 0; t < 2; ++t) {
    for (const float n : {0.0f, 0.0f, 1.0f}) add(n);
    for (uint32_t c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) add(std::as_const(text->scene.meshes[0].positions)[3 * t + c][k]);
    add(uint16_t(0));
  }
  const auto other = read(binary, "a.stl");
  ASSERT_TRUE(other) << other.error().front().text();
  EXPECT_EQ(content_hash(other->scene), content_hash(text->scene));
  EXPECT_NE(error(binary.substr(0, 120), "a.stl"), "no error");
  const float nan = NAN;
  std::memcpy(&binary[100], &nan, 4);
  EXPECT_THAT(error(binary, "a.stl"),
              HasSubstr("triangle 0 has a coordinate that is too large or not finite"));
  EXPECT_THAT(error("solid x\nendsolid\n", "a.stl"), HasSubstr("no faces"));
  EXPECT_THAT(error("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", "a.stl"),
              HasSubstr("a.stl:4:12: error: expected a coordinate"));
  EXPECT_THAT(error("solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nendloop\n", "a.stl"),
              HasSubstr("a.stl:6:1: error: expected vertex"));
}

// The material of a blue face, with `more` after the positions of its vertices.
Rgb off_face(const std::string& head, const std::string& more) {
  std::string text = head + "3 1 0\n";
  for (const char* place : {"0 0 0", "1 0 0", "0 1 0"}) text += place + more + "\n";
  const auto got = read(text + "3 0 1 2 0 0 255\n", "a.off");
  if (!got) return {};
  return got->scene.materials[got->scene.meshes[0].materials[0]].color;
}

TEST(Off, VerticesAndFacesHaveColours) {
  const auto mesh = read(
      "COFF # a square\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n1 1 0 0 0 255 255\n"
      "0 1 0 0.5 0.5 0.5 1\n\n3 0 1 2\n3 0 2 3 0 0 255\n2 0 1\n",
      "a.off");
  EXPECT_THAT(mesh.error().front().text(),
              HasSubstr("a.off:10:1: error: expected the end of the file"));
  const auto square = read(
      "COFF # a square\n4 3 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n1 1 0 0 0 255 255\n"
      "0 1 0 0.5 0.5 0.5 1\n\n3 0 1 2\n3 0 2 3 0 0 255\n2 0 1\n",
      "a.off");
  ASSERT_TRUE(square) << square.error().front().text();
  EXPECT_TRUE(validate(square->scene).empty());
  const Mesh& m = square->scene.meshes[0];
  ASSERT_EQ(m.triangles.size(), 2u);
  EXPECT_EQ(m.colors[1], Rgb(0, 1, 0));
  EXPECT_EQ(m.colors[3], Rgb(linear_from_srgb(0.5f)));
  EXPECT_EQ(square->scene.materials[m.materials[0]].color, Rgb(1));
  // Not multiplied into those of the vertices.
  EXPECT_EQ(square->scene.materials[m.materials[1]].color, Rgb(1));
  EXPECT_EQ(off_face("OFF\n", ""), Rgb(0, 0, 1));
  EXPECT_EQ(off_face("COFF\n", " 1 0 0 1"), Rgb(1));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off"),
              HasSubstr("a.off:6:7: error: expected a vertex from 0 to 2"));
  EXPECT_THAT(error("OFF\n99999999 1 0\n0 0 0\n", "a.off"), HasSubstr("the number of vertices"));
  EXPECT_THAT(error("OFF BINARY\n", "a.off"), HasSubstr("write text"));
  EXPECT_THAT(error("4OFF\n3 1 0\n", "a.off"), HasSubstr("expected OFF"));
  EXPECT_THAT(error("OFF\n1 1 0\n0 0 0\n", "a.off"), HasSubstr("the end of the file"));
}

TEST(Obj, FacesHaveNormalsAndTextureCoordinates) {
  const auto mesh = read(std::string(kObj).substr(0, kObj.find("l 1 2")), "a.obj");
  ASSERT_TRUE(mesh) << mesh.error().front().text();
  EXPECT_TRUE(validate(mesh->scene).empty());
  EXPECT_THAT(mesh->notices[0].text(), HasSubstr("found no file \"square.mtl\""));
  const Mesh& m = mesh->scene.meshes[0];
  ASSERT_EQ(m.triangles.size(), 2u);
  // The first vertex has two texture coordinates.
  EXPECT_EQ(m.positions.size(), 5u);
  EXPECT_EQ(m.positions[m.triangles[1][0]], Vec3f(0, 0, 0));
  EXPECT_EQ(m.uv[m.triangles[0][0]], (Uv{0, 0}));
  EXPECT_EQ(m.uv[m.triangles[1][0]], (Uv{1, 1}));
  EXPECT_EQ(m.normals[m.normal_indices[0][2]], Vec3f(0, 0, 1));
  EXPECT_EQ(m.normal_indices[1][0], kNoNormal);
  // Lines are left out; a face may go on in the next line.
  EXPECT_EQ(read(kObj, "a.obj")->scene.meshes[0].triangles.size(), 3u);
}

TEST(Obj, MaterialsComeFromMtlFiles) {
  const std::filesystem::path folder = testing::TempDir() + "raio_obj";
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, std::string_view text) {
    std::ofstream(folder / name) << text;
  };
  write("square.mtl",
        "newmtl red one\nKa 1 1 1\nKd 1 0 0\nmap_Kd a.png\nnewmtl clear\nKd 0 0 1\nd 0.25\n");
  write("a.obj", kObj.substr(0, kObj.find("l 1 2")));
  const auto mesh = read_scene(folder / "a.obj");
  ASSERT_TRUE(mesh) << mesh.error().front().text();
  const Scene& scene = mesh->scene;
  const auto& of = scene.meshes[0].materials;
  EXPECT_EQ(scene.materials[of[0]].color, Rgb(1, 0, 0));
  EXPECT_EQ(scene.materials[of[1]].color, Rgb(0, 0, 1));
  EXPECT_EQ(scene.material_opacity[of[1]], 0.25f);
  ASSERT_EQ(mesh->notices.size(), 1u);
  EXPECT_EQ(mesh->notices[0].text(),
            (folder / "square.mtl").string() +
                ":4:1: warning: the texture \"a.png\": the file does not exist");
  write("square.mtl", "newmtl red one\nKd 1 x 0\n");
  const auto broken = read_scene(folder / "a.obj");
  ASSERT_TRUE(broken);
  EXPECT_THAT(broken->notices.at(0).text(),
              HasSubstr("\"square.mtl\":2:6: expected a part of a colour"));
  // Several files in one line, and one with a blank in its name.
  write("clear.mtl", "newmtl clear\nKd 0 0 1\n");
  write("square.mtl", "newmtl red one\nKd 1 0 0\n");
  write("two words.mtl", "newmtl red one\nKd 0 1 0\n");
  const auto red = [&](std::string_view libraries) {
    std::string text(kObj);
    text.replace(text.find("square.mtl"), 10, libraries);
    write("a.obj", text);
    const auto got = read_scene(folder / "a.obj");
    EXPECT_EQ(got->notices.size(), libraries == "two words.mtl" ? 2u : 1u) << libraries;
    const auto names_missing = [](const Diagnostic& d) {
      return d.text().contains("materials that are not in its MTL files (1: ");
    };
    EXPECT_EQ(std::ranges::any_of(got->notices, names_missing), libraries == "two words.mtl");
    return got->scene.materials[got->scene.meshes[0].materials[0]].color;
  };
  EXPECT_EQ(red("clear.mtl  square.mtl"), Rgb(1, 0, 0));
  EXPECT_EQ(red("two words.mtl"), Rgb(0, 1, 0));
  std::filesystem::remove_all(folder);
}

TEST(Obj, FacesWithFewVerticesAreReported) {
  const auto got = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\nf 3\n", "a.obj");
  ASSERT_TRUE(got) << got.error().front().text();
  ASSERT_EQ(got->notices.size(), 1u);
  EXPECT_THAT(got->notices[0].text(),
              HasSubstr("5:1: left out: faces with fewer than three vertices"));
}

TEST(Obj, BrokenFilesAreRefused) {
  EXPECT_THAT(
      error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a.obj"),
      HasSubstr(
          "a.obj:4:7: error: expected a vertex from 1 to 3 or -1 to -3 (vertices count from 1)"));
  EXPECT_THAT(error("v 0 0 0\nf 0 1 1\n", "a.obj"), HasSubstr("a.obj:2:3"));
  EXPECT_THAT(error("v 0 0 0\nf 1x 1 1\n", "a.obj"), HasSubstr("a face vertex such as"));
  EXPECT_THAT(error("v 0 0\n", "a.obj"), HasSubstr("the end of the line"));
  EXPECT_EQ(read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n", "a.obj")
                ->scene.meshes[0]
                .colors[1],
            Rgb(0, 1, 0));
}

// The vertices of all triangles of a scene's first mesh, with colours, normals and texture
// coordinates.
std::vector<std::array<float, 11>> corners_of(const Scene& scene) {
  std::vector<std::array<float, 11>> out;
  if (scene.meshes.empty()) return out;
  const Mesh& m = scene.meshes[0];
  for (size_t i = 0; i < m.triangles.size(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = m.triangles[i][k];
      const Vec3f p = m.positions[v];
      const uint32_t at = m.normal_indices.empty() ? v : m.normal_indices[i][k];
      const Vec3f n = m.normals.empty() || at == kNoNormal ? Vec3f() : m.normals[at];
      const Rgb own = scene.materials[m.materials[m.materials.size() == 1 ? 0 : i]].color;
      const Rgb c = m.colors.empty() ? own : m.colors[v] * own;
      const Uv uv = m.uv.empty() ? Uv{} : m.uv[v];
      out.push_back({p.x, p.y, p.z, n.x, n.y, n.z, c.x, c.y, c.z, uv[0], uv[1]});
    }
  return out;
}

TEST(PlyWrite, WrittenFilesReadBack) {
  const auto points = read(ply("ascii", 700, true), "a.ply");
  const auto again = read(write_ply(points->scene, "from here"), "a.ply");
  ASSERT_TRUE(again) << again.error().front().text();
  EXPECT_EQ(content_hash(again->scene), content_hash(points->scene));
  EXPECT_EQ(not_in_ply(points->scene), "");
  // Colours of vertices, of materials, normals and texture coordinates.
  for (const auto& [text, name] : {std::pair(kMesh, "a.ply"), {kStl, "a.stl"}, {kObj, "a.obj"}}) {
    const auto mesh = read(text, name);
    ASSERT_TRUE(mesh) << name;
    const auto copy = read(write_ply(mesh->scene), "a.ply");
    ASSERT_TRUE(copy) << name << copy.error().front().text();
    const auto a = corners_of(mesh->scene), b = corners_of(copy->scene);
    ASSERT_EQ(a.size(), b.size()) << name;
    EXPECT_FALSE(a.empty());
    for (size_t i = 0; i < a.size(); ++i) {
      // Flat triangles among smooth ones get their normals written; colours have 256 steps.
      const bool flat = length(Vec3f(a[i][3], a[i][4], a[i][5])) == 0;
      for (size_t k = 0; k < a[i].size(); ++k) {
        const bool color = k >= 6 && k <= 8, normal = k >= 3 && k <= 5;
        if (normal && flat) continue;
        EXPECT_NEAR(a[i][k], b[i][k], color ? 0.004f : 1e-6f) << name << ' ' << i << ' ' << k;
      }
    }
  }
}

TEST(PlyWrite, ReportsOmissions) {
  const auto shapes = read_scene(RAIO_SOURCE_DIR "/scenes/shapes.nff");
  ASSERT_TRUE(shapes);
  const Scene& scene = shapes->scene;
  const std::string lost = not_in_ply(scene);
  EXPECT_THAT(lost, HasSubstr(std::to_string(scene.spheres.size()) + " sphere"));
  EXPECT_THAT(lost, HasSubstr("lights"));
  const auto copy = read(write_ply(scene), "a.ply");
  ASSERT_TRUE(copy) << copy.error().front().text();
  const size_t least = scene.triangles.size() + scene.polygons.size();
  EXPECT_GE(copy->scene.meshes[0].triangles.size(), least);
  // Far from zero, positions are doubles.
  Scene far;
  far.dialect = Dialect::data;
  far.origin = Vec3d(1e9, 0, 0);
  far.materials = {{.color = Rgb(1), .kd = 1}};
  far.spheres = {{{0.25f, 1, 2}, 1}};
  far.sphere_materials = {0};
  EXPECT_THAT(write_ply(far), HasSubstr("property double x"));
}

/// A pyramid with its base perpendicular to an axis: 1 is y, 2 is z.
std::string pyramid(int axis, bool is_closed = true) {
  std::string out;
  for (const auto& [u, v] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
    out += axis == 1 ? fmt::format("v {} 0 {}\n", u, v) : fmt::format("v {} {} 0\n", u, v);
  out += axis == 1 ? "v 0 2 0\n" : "v 0 0 2\n";
  for (int i = 1; i <= 4; ++i) out += fmt::format("f {} {} 5\n", i, i % 4 + 1);
  return out + (is_closed ? "f 4 3 2 1\n" : "");
}

TEST(MeshFiles, StandOnTheirBase) {
  const auto up = [](const std::string& text, const char* name) {
    const auto got = read(text, name);
    EXPECT_TRUE(got) << got.error().front().text();
    return std::pair(nearest_axis(got->scene.camera.up), !got->notices.empty());
  };
  const Vec3f y(0, 1, 0), z(0, 0, 1);
  EXPECT_EQ(up(pyramid(1), "a.obj"), std::pair(y, false));
  EXPECT_EQ(up(pyramid(2), "a.obj"), std::pair(z, true));
  // Without a base, or with one at both ends, it is as in most files.
  EXPECT_EQ(up(pyramid(2, false), "a.obj"), std::pair(y, false));
  EXPECT_EQ(up("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "a.obj"), std::pair(y, false));
  // Or on a face like any other.
  EXPECT_EQ(
      up("v 0 -1 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n", "a.obj"),
      std::pair(y, false));
  EXPECT_EQ(up("OFF 4 1 0\n0 0 0\n1 0 0\n1 1 0.1\n0 1 0\n4 0 1 2 3\n", "a.off").first, y);
  EXPECT_EQ(up("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 1\n"
               "endloop\nendfacet\nendsolid\n",
               "a.stl")
                .first,
            z);
}

}  // namespace
}  // namespace raio::core
