// Files of atoms, points and meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/srgb.h"
#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/scene_file.h"

namespace raio {
namespace {

using ::testing::HasSubstr;

std::expected<ReadScene, Diagnostics> read(std::string_view text, std::string_view name,
                                           const ReadOptions& options = {}) {
  return parse_scene(text, name, options);
}

std::string error(std::string_view text, std::string_view name, const ReadOptions& options = {}) {
  const auto result = read(text, name, options);
  if (result) return "no error";
  return result.error().front().text();
}

std::string ply(std::string_view format, int count, bool clear);

constexpr std::string_view kWater =
    "3\n"
    "water\n"
    "O 0 0 0\n"
    "H 0.9572 0 0\n"
    "H -0.24 0.927 0\n";

TEST(Xyz, AtomsBecomeSpheresAndBonds) {
  auto water = read(kWater, "water.xyz");
  ASSERT_TRUE(water) << water.error().front().text();
  const Scene& scene = water->scene;
  EXPECT_EQ(scene.name, "water");
  EXPECT_EQ(scene.dialect, Dialect::data);
  EXPECT_TRUE(validate(scene).empty());
  EXPECT_EQ(scene.spheres.size(), 3u);
  EXPECT_EQ(scene.cones.size(), 4u);  // two bonds, each in two colours
  EXPECT_EQ(scene.materials[scene.sphere_materials[0]].color, element_color(8));
  EXPECT_EQ(scene.materials[scene.sphere_materials[1]].color, element_color(1));
  water = read(kWater, "water.xyz", {.style = AtomStyle::space_filling});
  EXPECT_TRUE(water->scene.cones.empty());
  EXPECT_FLOAT_EQ(water->scene.spheres[0].radius, van_der_waals_radius(8));
  water = read(kWater, "water.xyz", {.style = AtomStyle::sticks});
  EXPECT_EQ(water->scene.spheres[0].radius, water->scene.cones[0].base_radius);
}

TEST(Xyz, ExtendedOnesSayTheirColumns) {
  const auto scene = read(
      "2\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=id:I:1:pos:R:3:species:S:1 x=1\n"
      "1 1 2 3 Fe\n2 4 5 6 8\n",
      "a.xyz");
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->scene.spheres[0].center, Vec3f(1, 2, 3));
  EXPECT_EQ(scene->scene.materials[scene->scene.sphere_materials[0]].color, element_color(26));
  EXPECT_EQ(scene->scene.materials[scene->scene.sphere_materials[1]].color, element_color(8));
}

TEST(Xyz, FramesAreChosen) {
  const std::string two = std::string(kWater) + "1\nnext\nHe 7 0 0\n\n";
  EXPECT_EQ(read(two, "a.xyz")->scene.spheres.size(), 3u);
  for (const int frame : {1, -1}) {
    const auto helium = read(two, "a.xyz", {.frame = frame});
    ASSERT_EQ(helium->scene.spheres.size(), 1u);
    EXPECT_EQ(helium->scene.spheres[0].center.x, 7);
  }
  EXPECT_THAT(error(two, "a.xyz", {.frame = 2}), HasSubstr("there is no frame 2; the file has 2"));
}

TEST(Xyz, FaultsHaveTheirPlace) {
  EXPECT_THAT(error("3\n\nO 0 0 0\nH 1 x 0\nH 0 0 0\n", "a.xyz"), HasSubstr("a.xyz:4:5: error"));
  EXPECT_THAT(error("3\n\nO 0 0 0\nH 1\nH 0 0 0\n", "a.xyz"), HasSubstr("the end of the line"));
  EXPECT_THAT(error("3\nthree atoms\nO 0.000 0.000 0.000\n", "a.xyz"),
              HasSubstr("expected 3 atoms, found 1"));
  EXPECT_THAT(error("x\n\nO 0 0 0\n", "a.xyz"), HasSubstr("number of atoms"));
  EXPECT_THAT(error("99999999999\n\nO 0 0 0\n", "a.xyz"), HasSubstr("number of atoms"));
  EXPECT_THAT(error("1\nProperties=pos:R:3\nO 0 0 0\n", "a.xyz"), HasSubstr("species:S:1"));
  EXPECT_THAT(error("1\n\nO 0 0 1e999\n", "a.xyz"), HasSubstr("finite"));
}

TEST(Atoms, ColoursAreNamed) {
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "mass"}), HasSubstr("cannot colour by 'mass'"));
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "index", .colormap = "jet"}),
              HasSubstr("no colour map 'jet'"));
  EXPECT_THAT(error(kWater, "a.xyz", {.colormap = "viridis"}), HasSubstr("has no effect"));
  const auto by_index = read(kWater, "a.xyz", {.color_by = "index"});
  EXPECT_EQ(by_index->scene.materials[by_index->scene.sphere_materials[0]].color,
            *map_color("viridis", 0));
  EXPECT_EQ(by_index->scene.materials[by_index->scene.sphere_materials[2]].color,
            *map_color("viridis", 1));
}

// The ends of the maps as published.
TEST(Atoms, ColourMapsAreThePublishedOnes) {
  const auto display = [](std::string_view map, float part) {
    const Rgb c = *map_color(map, part);
    const auto byte = [](float x) { return int(std::lround(srgb_from_linear(x) * 255)); };
    return std::array{byte(c.x), byte(c.y), byte(c.z)};
  };
  EXPECT_EQ(display("viridis", 0), (std::array{68, 1, 84}));
  EXPECT_EQ(display("viridis", 1), (std::array{253, 231, 37}));
  EXPECT_EQ(display("cividis", 0), (std::array{0, 34, 78}));
  EXPECT_EQ(display("coolwarm", 1), (std::array{180, 4, 38}));
  EXPECT_EQ(display("plasma", 1), (std::array{240, 249, 33}));
}

// All pairs, tried one by one.
TEST(Atoms, BondsAreThoseOfAllPairs) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> place(-9, 9);
  std::vector<Atom> atoms(800);
  for (Atom& atom : atoms) {
    for (float& x : atom.place) x = place(rng);
    atom.element = std::array<uint8_t, 4>{1, 6, 8, 26}[rng() % 4];
  }
  std::vector<std::array<uint32_t, 2>> expected;
  for (uint32_t i = 0; i < atoms.size(); ++i)
    for (uint32_t j = i + 1; j < atoms.size(); ++j) {
      const auto &a = atoms[i].place, &b = atoms[j].place;
      const float d = std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      const float most =
          covalent_radius(atoms[i].element) + covalent_radius(atoms[j].element) + 0.45f;
      if (d <= most && d >= 0.4f && atoms[i].element + atoms[j].element > 2)
        expected.push_back({i, j});
    }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(*find_bonds(atoms), expected);
  // No molecule, and no work for hours.
  EXPECT_FALSE(find_bonds(std::vector<Atom>(200'000)));
}

constexpr std::string_view kPdb =
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1 1000 -1.000000  0.000000  0.000000       10.00000\n"
    "REMARK 350   BIOMT2 1000  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3 1000  0.000000  0.000000  1.000000        5.00000\n"
    "ATOM      1  N   ALA A   1       1.000   2.000   3.000  1.00 10.00           N\n"
    "ATOM      2  CA AALA A   1       2.400   2.000   3.000  0.40 20.00           C\n"
    "ATOM      3  CA BALA A   1       2.500   2.000   3.000  0.60 20.00           C\n"
    "HETATM    4 CA    CA B   2       8.000   2.000   3.000  1.00 30.00          CA\n"
    "END\n";

TEST(Pdb, AssembliesCopyTheirChains) {
  const auto whole = read(kPdb, "a.pdb", {.style = AtomStyle::space_filling});
  ASSERT_TRUE(whole) << whole.error().front().text();
  // Of chain A alone, of its atom in two places the first.
  ASSERT_EQ(whole->scene.spheres.size(), 4u);
  EXPECT_EQ(whole->scene.spheres[1].center, Vec3f(2.4f, 2, 3));
  EXPECT_FLOAT_EQ(whole->scene.spheres[3].center.x, 7.6f);
  const auto unit = read(kPdb, "a.pdb", {.style = AtomStyle::space_filling, .assembly = 0});
  ASSERT_EQ(unit->scene.spheres.size(), 3u);
  EXPECT_EQ(unit->scene.materials[unit->scene.sphere_materials[2]].color, element_color(20));
  EXPECT_THAT(error(kPdb, "a.pdb", {.assembly = 2}), HasSubstr("no assembly 2; the file has 1"));
  EXPECT_EQ(read(kPdb, "a.pdb")->scene.cones.size(), 2u);  // few atoms: with bonds
}

TEST(Files, OptionsWithoutEffectAreRefused) {
  EXPECT_THAT(error("s 0 0 0 1\n", "a.nff", {.style = AtomStyle::points}),
              HasSubstr("style has no effect on this file"));
  EXPECT_THAT(error(ply("ascii", 5, false), "a.ply", {.color_by = "chain"}),
              HasSubstr("color-by has no effect"));
}

TEST(Files, FarCoordinatesHaveACamera) {
  const auto far = read("2\n\nC 0 0 0\nC 1e24 0 0\n", "a.xyz");
  ASSERT_TRUE(far);
  EXPECT_TRUE(validate(far->scene).empty());
}

TEST(Pdb, BrokenFilesAreRefused) {
  EXPECT_NE(error("HEADER    x\nATOM      1  N   ALA A   1       x\n", "a.pdb"), "no error");
  EXPECT_NE(error("HEADER    nothing\nEND\n", "a.pdb"), "no error");
  EXPECT_NE(error("data_x\nloop_\n_atom_site.id\n", "a.cif"), "no error");
  EXPECT_NE(error("data_x\n_cell.length_a 1\n", "a.cif"), "no error");
}

TEST(Cif, AtomsAreRead) {
  const auto scene = read(
      "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
      "_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n"
      "_atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.auth_seq_id\n"
      "_atom_site.auth_asym_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
      "_atom_site.occupancy\n_atom_site.B_iso_or_equiv\n_atom_site.pdbx_PDB_model_num\n"
      "ATOM 1 N N . ALA A 1 1 A 1 2 3 1 10 1\nATOM 2 C CA . ALA A 1 1 A 2.4 2 3 1 20 1\n",
      "a.cif");
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->scene.spheres.size(), 2u);
  EXPECT_EQ(scene->scene.cones.size(), 2u);
}

// The same points as text and in both byte orders.
std::string ply(std::string_view format, int count, bool clear) {
  std::string out =
      "ply\nformat " + std::string(format) + " 1.0\ncomment made here\nelement vertex " +
      std::to_string(count) +
      "\nproperty float x\nproperty float y\nproperty double z\nproperty float radius\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nend_header\n";
  const auto add = [&](const auto& number) {
    std::array<char, sizeof number> bytes;
    std::memcpy(bytes.data(), &number, bytes.size());
    if (format == "binary_big_endian") std::ranges::reverse(bytes);
    out.append(bytes.data(), bytes.size());
  };
  for (int i = 0; i < count; ++i) {
    const float x = float(i), y = float(i % 7) * 0.5f, r = 0.25f + float(i % 3);
    const double z = 0.125 * (i % 5);
    const auto red = uint8_t(i % 256), alpha = uint8_t(clear && i % 2 ? 128 : 255);
    if (format == "ascii") {
      out += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " " +
             std::to_string(r) + " " + std::to_string(red) + " 0 255 " + std::to_string(alpha) +
             "\n";
    } else {
      add(x), add(y), add(z), add(r), add(red), add(uint8_t(0)), add(uint8_t(255)), add(alpha);
    }
  }
  return out;
}

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

constexpr std::string_view kMesh =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 255 255 255\n4 0 1 2 3\n";

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
  EXPECT_THAT(with("1 1 0 0", "1 x 0 0"), HasSubstr("a.ply:14:1: error: expected a number"));
  EXPECT_THAT(with("vertex 4", "vertex 4000000000"), HasSubstr("do not fit into the file"));
  EXPECT_THAT(with("end_header\n", ""), HasSubstr("found"));
  EXPECT_THAT(with("property float z", "property float w"), HasSubstr("no property z"));
  EXPECT_THAT(with("property float z", "property real z"), HasSubstr("expected a type"));
  EXPECT_THAT(with("format ascii 1.0\n", ""), HasSubstr("no line \"format\""));
  EXPECT_THAT(error(ply("binary_little_endian", 50, true).substr(0, 900), "a.ply"),
              HasSubstr("ends within its vertices"));
}

// Whatever the bytes are: a scene, or an error that says something.
TEST(Files, AnyBytesEndWell) {
  std::mt19937 rng(9);
  const std::string seeds[] = {std::string(kWater), std::string(kPdb), std::string(kMesh),
                               ply("binary_little_endian", 20, true), ply("ascii", 20, false)};
  const char* names[] = {"a.xyz", "a.pdb", "a.ply", "a.ply", "a.ply"};
  for (size_t s = 0; s < std::size(seeds); ++s)
    for (int round = 0; round < 1500; ++round) {
      std::string text = seeds[s];
      for (size_t k = 0, changes = 1 + rng() % 4; k < changes; ++k) {
        const size_t at = rng() % text.size();
        switch (rng() % 4) {
          case 0:
            text[at] = char(rng());
            break;
          case 1:
            text.erase(at, 1 + rng() % 8);
            break;
          case 2:
            text.insert(at, 1 + rng() % 3, "0123456789 .-e\nxA"[rng() % 17]);
            break;
          case 3:
            text.resize(at);
            break;
        }
        if (text.empty()) text = "x";
      }
      if (const auto result = read(text, names[s]))
        EXPECT_TRUE(validate(result->scene).empty()) << text;
      else
        EXPECT_FALSE(result.error().front().message.empty());
    }
}

}  // namespace
}  // namespace raio
