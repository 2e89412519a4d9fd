// Files of atoms, points and meshes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include "base/srgb.h"
#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/colormaps.h"
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

TEST(Xyz, ColumnsAreColoursAndRadii) {
  const std::string text =
      "3\nProperties=pos:R:3:radius:R:1:forces:R:2:charge:R:1\n"
      "0 0 0 0.5 7 1 -1\n4 0 0 1.5 8 3 0\n8 0 0 1 9 2 1\n";
  const auto color = [&](std::string_view column, size_t i) {
    const auto read_one = read(text, "a.xyz", {.color_by = std::string(column)});
    if (!read_one) return Rgb();
    return read_one->scene.materials[read_one->scene.sphere_materials[i]].color;
  };
  EXPECT_EQ(read(text, "a.xyz")->scene.spheres[1].radius, 1.5f);
  EXPECT_EQ(color("charge", 0), *map_color("viridis", 0));
  EXPECT_EQ(color("charge", 1), *map_color("viridis", 0.5f));
  EXPECT_EQ(color("forces.2", 1), *map_color("viridis", 1));
  EXPECT_THAT(
      error(text, "a.xyz", {.color_by = "mass"}),
      HasSubstr("column of the file: pos.1, pos.2, pos.3, radius, forces.1, forces.2, charge"));
  EXPECT_THAT(error(text, "a.xyz", {.color_by = "charge", .colormap = "jet"}),
              HasSubstr("no colour map 'jet'"));
}

// Read in many pieces at once; the first fault is told, whichever thread meets one first.
TEST(Xyz, ManyLines) {
  constexpr int kAtoms = 100'000;
  std::string text = std::to_string(kAtoms) + "\n\n";
  for (int i = 0; i < kAtoms; ++i) text += "C " + std::to_string(i) + " 0 0\r\n";
  const auto scene = read(text, "a.xyz", {.style = AtomStyle::points});
  ASSERT_TRUE(scene) << scene.error().front().text();
  for (const size_t i : {0uz, 4095uz, 4096uz, 77'777uz, 99'999uz})
    EXPECT_EQ(scene->scene.spheres[i].center.x, float(i));
  for (const std::string_view place : {"\nC 30000 ", "\nC 70000 ", "\nC 99999 "}) {
    std::string broken = text;
    for (const std::string_view at : {place, std::string_view("\nC 99998 ")})
      broken[broken.find(at) + 3] = 'x';
    const std::string line = place == "\nC 30000 "   ? "a.xyz:30003:3"
                             : place == "\nC 70000 " ? "a.xyz:70003:3"
                                                     : "a.xyz:100001:3";
    EXPECT_THAT(error(broken, "a.xyz"), HasSubstr(line));
  }
}

constexpr std::string_view kDump =
    "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-1 1\n0 4\n0 8\n"
    "ITEM: ATOMS id type xs ys zs c_pe\n1 1 0.5 0.25 0.5 -3\n2 2 1 1 1 -2\n"
    "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n1\n"
    "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 12 2\n0 10 0\n0 10 0\n"
    "ITEM: ATOMS id element xs ys zs diameter\n1 Fe 0.5 0.5 0.5 3\n";

TEST(Lammps, DumpsAreFrames) {
  const auto first = read(kDump, "a.dump");
  ASSERT_TRUE(first) << first.error().front().text();
  const Scene& scene = first->scene;
  ASSERT_EQ(scene.spheres.size(), 2u);
  EXPECT_EQ(scene.spheres[0].center, Vec3f(0, 1, 4));
  EXPECT_EQ(scene.spheres[1].center, Vec3f(1, 4, 8));
  // No elements: types have colours, and half of the mean spacing is the radius.
  EXPECT_EQ(scene.materials[scene.sphere_materials[1]].color, distinct_color(1));
  EXPECT_FLOAT_EQ(scene.spheres[0].radius, std::cbrt(1.0f * 3 * 4 / 2) / 2);
  EXPECT_TRUE(scene.cones.empty());
  // Tilted by 2: from the bounds 0 to 12 it is 10 wide.
  const auto second = read(kDump, "a.dump", {.frame = -1});
  ASSERT_TRUE(second) << second.error().front().text();
  EXPECT_EQ(second->scene.spheres[0].center, Vec3f(6, 5, 5));
  EXPECT_EQ(second->scene.materials[second->scene.sphere_materials[0]].color, element_color(26));
  const auto spheres = read(kDump, "a.dump", {.style = AtomStyle::space_filling, .frame = 1});
  EXPECT_EQ(spheres->scene.spheres[0].radius, 1.5f);
  const auto by_energy = read(kDump, "a.dump", {.color_by = "c_pe"});
  EXPECT_EQ(by_energy->scene.materials[by_energy->scene.sphere_materials[1]].color,
            *map_color("viridis", 1));
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text(kDump);
    text.replace(text.find(from), from.size(), to);
    return error(text, "a.dump");
  };
  EXPECT_THAT(with("ATOMS\n2", "ATOMS\n99"), HasSubstr("expected 99 atoms, found 17"));
  EXPECT_THAT(with("xs ys zs c_pe", "xs ys c_pe"), HasSubstr("columns of places"));
  EXPECT_THAT(with("1 1 0.5 0.25", "1 1 0.5 a"),
              HasSubstr("a.dump:10:9: error: expected a coordinate"));
  EXPECT_THAT(with("-1 1\n0 4", "-1 1\n0"), HasSubstr("as many numbers in each line"));
  EXPECT_THAT(with("1 1 0.5", "1 0 0.5"), HasSubstr("expected a type"));
  EXPECT_THAT(error("ITEM: TIMESTEP\n0\n", "a.dump"), HasSubstr("ends before the atoms"));
}

constexpr std::string_view kData =
    "LAMMPS data file\n\n3 atoms\n2 bonds\n2 atom types\n0 20 xlo xhi\n0 20 ylo yhi\n"
    "0 20 zlo zhi\n\nMasses\n\n1 15.9994 # O\n2 1.008\n\nAtoms # full\n\n"
    "7 1 1 -0.8 1 1 1 0 0 0\n9 1 2 0.4 2 1 1 0 0 0\n8 1 2 0.4 1 19 1 0 0 0\n\n"
    "Velocities\n\n7 0 0 0\n9 0 0 0\n8 0 0 0\n\nBonds\n\n1 1 7 9\n2 1 7 8\n";

TEST(Lammps, DataFilesSayTheirBonds) {
  const auto water = read(kData, "water.lmp");
  ASSERT_TRUE(water) << water.error().front().text();
  const Scene& scene = water->scene;
  ASSERT_EQ(scene.spheres.size(), 3u);
  EXPECT_EQ(scene.spheres[1].center, Vec3f(2, 1, 1));
  EXPECT_EQ(scene.materials[scene.sphere_materials[0]].color, element_color(8));
  EXPECT_EQ(scene.materials[scene.sphere_materials[2]].color, element_color(1));
  EXPECT_EQ(scene.cones.size(), 2u);  // the other bond leads through a side of the box
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text(kData);
    text.replace(text.find(from), from.size(), to);
    return error(text, "water.lmp");
  };
  EXPECT_THAT(with("Atoms # full", "Atoms"), HasSubstr("the style of the atoms"));
  EXPECT_THAT(with("Atoms # full", "Atoms # magic"), HasSubstr("water.lmp:15:7: error: expected"));
  EXPECT_THAT(with("1 7 8", "1 7 6"), HasSubstr("a bond names atom 6"));
  EXPECT_THAT(with("3 atoms", "3000 atoms"), HasSubstr("expected 3000 atoms"));
  EXPECT_THAT(with("9 1 2 0.4 2 1 1", "9 1 2 0.4 2 1 z"), HasSubstr("water.lmp:18:15: error"));
}

constexpr std::string_view kGro =
    "Water and an ion t= 0.0\n    4\n"
    "    1SOL     OW    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1SOL    HW1    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n"
    "    1SOL    HW2    3   0.177   1.568   1.613-12.9045 -0.0580  0.0434\n"
    "    2CA      CA    4-999.900   1.568   1.613\n"
    "   1.86824   1.86824   1.86824\n";

TEST(Gro, NamesAreElements) {
  const auto scene = read(kGro, "a.gro");
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->scene.spheres.size(), 4u);
  EXPECT_FLOAT_EQ(scene->scene.spheres[0].center.y, 16.24f);
  EXPECT_FLOAT_EQ(scene->scene.spheres[3].center.x, -9999);
  const auto color = [&](size_t i) {
    return scene->scene.materials[scene->scene.sphere_materials[i]].color;
  };
  EXPECT_EQ(color(0), element_color(8));
  EXPECT_EQ(color(2), element_color(1));
  EXPECT_EQ(color(3), element_color(20));
  const std::string two = std::string(kGro) + std::string(kGro);
  EXPECT_EQ(read(two, "a.gro", {.frame = 1})->scene.spheres.size(), 4u);
  EXPECT_THAT(error(two, "a.gro", {.frame = 2}), HasSubstr("there is no frame 2; the file has 2"));
  EXPECT_THAT(error(kGro.substr(0, 120), "a.gro"), HasSubstr("expected 4 atoms, found 1"));
  std::string broken(kGro);
  broken.replace(broken.find("1.661"), 5, "1.x61");
  EXPECT_THAT(error(broken, "a.gro"), HasSubstr("a.gro:4:29: error: expected a coordinate"));
}

TEST(Pdb, ListedBondsAreDrawn) {
  const std::string text =
      "HETATM    1  C1  LIG A   1       0.000   0.000   0.000  1.00  0.00           C\n"
      "HETATM    2  C2  LIG A   1       5.000   0.000   0.000  1.00  0.00           C\n"
      "HETATM    3  C3  LIG A   1       9.000   0.000   0.000  1.00  0.00           C\n";
  EXPECT_TRUE(read(text, "a.pdb")->scene.cones.empty());
  EXPECT_EQ(read(text + "CONECT    1    2    3\nCONECT    2    1\n", "a.pdb")->scene.cones.size(),
            2u);
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
  EXPECT_THAT(error("99999999999\n\nO 0 0 0\n", "a.xyz"),
              HasSubstr("expected 99999999999 atoms, found 1"));
  EXPECT_THAT(error("1\nProperties=species:S:1\nO 0 0 0\n", "a.xyz"), HasSubstr("pos:R:3"));
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
  EXPECT_THAT(error(ply("ascii", 5, false), "a.ply", {.style = AtomStyle::points}),
              HasSubstr("style has no effect"));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "a.off", {.color_by = "x"}),
              HasSubstr("color-by has no effect"));
}

TEST(Files, FarCoordinatesHaveACamera) {
  const auto far = read("2\n\nC 0 0 0\nC 1e24 0 0\n", "a.xyz");
  ASSERT_TRUE(far);
  EXPECT_TRUE(validate(far->scene).empty());
}

// Seen along a row of ions a crystal would hide most of them.
TEST(Files, CrystalsAreSeenAtAnAngle) {
  const auto salt = read_scene(RAIO_SOURCE_DIR "/scenes/salt.xyz");
  ASSERT_TRUE(salt) << salt.error().front().text();
  const Camera& camera = salt->scene.camera;
  const Vec3f forward = normalize(camera.at - camera.from);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GT(std::abs(forward[axis]), 0.3f);
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

TEST(Ply, PropertiesAreColours) {
  const auto scene = read(ply("ascii", 5, false), "a.ply", {.color_by = "z", .colormap = "plasma"});
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_EQ(scene->scene.sphere_colors[0], *map_color("plasma", 0));
  EXPECT_EQ(scene->scene.sphere_colors[4], *map_color("plasma", 1));
  EXPECT_EQ(read(kMesh, "a.ply", {.color_by = "y"})->scene.meshes[0].colors[2],
            *map_color("viridis", 1));
  EXPECT_THAT(error(kMesh, "a.ply", {.color_by = "chain"}), HasSubstr("there are \"x\", \"y\""));
}

TEST(Ply, OddsAndEnds) {
  const std::string mesh(kMesh);
  const auto with = [&](std::string_view from, std::string_view to) {
    std::string text = mesh;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THAT(error(with("4 0 1 2 3", "4 0 1 2 1.5"), "a.ply"), HasSubstr("names vertex 1.5"));
  // Elements of nothing take no time, however many there are.
  EXPECT_THAT(error(with("element face", "element nothing 99999999999\nelement face"), "a.ply"),
              HasSubstr("do not fit into the file"));
  EXPECT_THAT(
      error("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
            "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
            "a.ply"),
      HasSubstr("write the vertices first"));
  // A concave polygon is not cut outside of it: the corner 1 1 lies inside of the triangle.
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
}

constexpr std::string_view kStl =
    "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
    "   vertex 0 1 0\n  endloop\n endfacet\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 0 0\n"
    "VERTEX 1 1 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nendsolid two\n";

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
  EXPECT_NE(error(binary.substr(0, 150), "a.stl"), "no error");
  const float nan = NAN;
  std::memcpy(&binary[100], &nan, 4);
  EXPECT_THAT(error(binary, "a.stl"), HasSubstr("triangle 0 has no finite place"));
  EXPECT_THAT(error("solid x\nendsolid\n", "a.stl"), HasSubstr("no faces"));
  EXPECT_THAT(error("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 x\n", "a.stl"),
              HasSubstr("a.stl:4:12: error: expected a coordinate"));
  EXPECT_THAT(error("solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nendloop\n", "a.stl"),
              HasSubstr("a.stl:6:1: error: expected vertex"));
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
  EXPECT_EQ(square->scene.materials[m.materials[1]].color, Rgb(0, 0, 1));
  EXPECT_THAT(error("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off"),
              HasSubstr("a.off:6:7: error: expected a vertex from 0 to 2"));
  EXPECT_THAT(error("OFF\n99999999 1 0\n0 0 0\n", "a.off"), HasSubstr("the number of vertices"));
  EXPECT_THAT(error("OFF BINARY\n", "a.off"), HasSubstr("write text"));
  EXPECT_THAT(error("4OFF\n3 1 0\n", "a.off"), HasSubstr("expected OFF"));
  EXPECT_THAT(error("OFF\n1 1 0\n0 0 0\n", "a.off"), HasSubstr("the end of the file"));
}

constexpr std::string_view kObj =
    "# a square\nmtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
    "vt 1 1\nvn 0 0 2\nusemtl red one\nf 1/1/1 2/2/1 3/3/1\nusemtl clear\nf -4/3 -2/3 -1\n"
    "l 1 2\nf 1 2 \\\n3\n";

TEST(Obj, FacesHaveNormalsAndPlaces) {
  const auto mesh = read(std::string(kObj).substr(0, kObj.find("l 1 2")), "a.obj");
  ASSERT_TRUE(mesh) << mesh.error().front().text();
  EXPECT_TRUE(validate(mesh->scene).empty());
  EXPECT_THAT(mesh->warnings[0].text(), HasSubstr("there is no file \"square.mtl\""));
  const Mesh& m = mesh->scene.meshes[0];
  ASSERT_EQ(m.triangles.size(), 2u);
  // The first corner has two places on a texture.
  EXPECT_EQ(m.positions.size(), 5u);
  EXPECT_EQ(m.positions[m.triangles[1][0]], Vec3f(0, 0, 0));
  EXPECT_EQ(m.uv[m.triangles[0][0]], (Uv{0, 0}));
  EXPECT_EQ(m.uv[m.triangles[1][0]], (Uv{1, 1}));
  EXPECT_EQ(m.normals[m.normal_indices[0][2]], Vec3f(0, 0, 1));
  EXPECT_EQ(m.normal_indices[1][0], kNoNormal);
  // Lines are left out; a face may go on in the next line.
  EXPECT_EQ(read(kObj, "a.obj")->scene.meshes[0].triangles.size(), 3u);
}

TEST(Obj, MaterialsComeFromFilesBeside) {
  const std::filesystem::path folder = ::testing::TempDir() + "raio_obj";
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
  EXPECT_THAT(mesh->warnings.at(0).message, HasSubstr("1 textures are left out"));
  write("square.mtl", "newmtl red one\nKd 1 x 0\n");
  const auto broken = read_scene(folder / "a.obj");
  ASSERT_TRUE(broken);
  EXPECT_THAT(broken->warnings.at(0).text(),
              HasSubstr("\"square.mtl\":2:6: expected a part of a colour"));
  std::filesystem::remove_all(folder);
}

TEST(Obj, BrokenFilesAreRefused) {
  EXPECT_THAT(error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "a.obj"),
              HasSubstr("a.obj:4:7: error: expected a vertex from 1 to 3 or -1 to -3"));
  EXPECT_THAT(error("v 0 0 0\nf 1/1 1/1 1/1\n", "a.obj"), HasSubstr("no texture coordinate"));
  EXPECT_THAT(error("v 0 0 0\nf 0 1 1\n", "a.obj"), HasSubstr("a.obj:2:3"));
  EXPECT_THAT(error("v 0 0 0\nf 1x 1 1\n", "a.obj"), HasSubstr("a corner such as"));
  EXPECT_THAT(error("v 0 0\n", "a.obj"), HasSubstr("the end of the line"));
  EXPECT_THAT(error("v 0 0 0\n", "a.obj"), HasSubstr("no faces"));
  EXPECT_THAT(error("v 0 0 0\nvn 0 0 1\nf 1//1 1 1\n", "a.obj"), HasSubstr("some corners"));
  EXPECT_EQ(read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n", "a.obj")
                ->scene.meshes[0]
                .colors[1],
            Rgb(0, 1, 0));
}

// Whatever the bytes are: a scene, or an error that says something.
TEST(Files, AnyBytesEndWell) {
  std::mt19937 rng(9);
  const std::string seeds[] = {std::string(kWater),     std::string(kPdb),
                               std::string(kMesh),      ply("binary_little_endian", 20, true),
                               ply("ascii", 20, false), std::string(kDump),
                               std::string(kData),      std::string(kGro),
                               std::string(kStl),       std::string(kObj)};
  const char* names[] = {"a.xyz",  "a.pdb", "a.ply", "a.ply", "a.ply",
                         "a.dump", "a.lmp", "a.gro", "a.stl", "a.obj"};
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
