// Files of atoms, and styles of atoms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "base/srgb.h"
#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/colormaps.h"
#include "io/scene_file.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The notices about a file.
std::string said(std::string_view text, std::string_view file, const ReadOptions& options) {
  std::string out;
  const auto read_scene = read(text, file, options);
  for (const Diagnostic& d : read_scene->notices) out += d.text() + '\n';
  return out;
}

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

TEST(Xyz, ExtendedOnesNameTheirColumns) {
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
      HasSubstr("the file has element, index, pos.1, pos.2, pos.3, radius, forces.1, forces.2, "
                "charge"));
  EXPECT_THAT(error(text, "a.xyz", {.color_by = "charge", .colormap = "jet"}),
              HasSubstr("unknown colour map 'jet'"));
}

// Read in many pieces at once; the first fault is reported, whichever thread finds one first.
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

// Names of types are those of a force field as often as of elements. Bonds across the periodic
// boundary, in a tilted box, too.
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
  EXPECT_THAT(error(broken, "a.gro"),
              HasSubstr("a.gro:4:32: error: expected a coordinate, found \"1.x61\""));
}

TEST(Gro, NumbersOfABoxMayTouch) {
  const auto box = [](std::string_view line) {
    std::string text(kGro);
    text.replace(text.rfind("   1.86824   1.86824   1.86824"), 30, line);
    const auto got = read(text, "a.gro", {.style = AtomStyle::points, .cell = true});
    return got ? got->scene.cones.front().apex - got->scene.cones.front().base : Vec3f();
  };
  EXPECT_FLOAT_EQ(length(box("40000.0000040000.0000020000.00000")), 400000);
  EXPECT_FLOAT_EQ(length(box("50.0 6 7")), 500);
}

TEST(Pdb, ListedBondsAreDrawn) {
  const std::string text =
      "HETATM    1  C1  LIG A   1       0.000   0.000   0.000  1.00  0.00           C\n"
      "HETATM    2  C2  LIG A   1       5.000   0.000   0.000  1.00  0.00           C\n"
      "HETATM    3  C3  LIG A   1       9.000   0.000   0.000  1.00  0.00           C\n";
  EXPECT_TRUE(read(text, "a.pdb")->scene.cones.empty());
  EXPECT_EQ(read(text + "CONECT    1    2    3\nCONECT    2    1\n", "a.pdb")->scene.cones.size(),
            2u);
  EXPECT_EQ(read(text + "CONECT    3    1\n", "a.pdb")->scene.cones.size(), 1u) << "one way";
  // Numbers beyond 99999, and those that several atoms have.
  std::string many = text;
  many.replace(many.find("    1  C1"), 5, "A0000");
  EXPECT_EQ(read(many + "CONECT    2A0000\n", "a.pdb")->scene.cones.size(), 1u);
  many = text;
  many.replace(many.find("    3  C3"), 5, "    2");
  EXPECT_EQ(read(many + "CONECT    1    2\n", "a.pdb")->scene.cones.size(), 0u);
}

class TrajectoryFile : public TemporaryFolder {};

TEST_F(TrajectoryFile, FramesAreFoundOnce) {
  const std::filesystem::path path = file("a.xyz");
  std::string text;
  for (int k = 0; k < 9; ++k) {
    text += std::to_string(k + 1) + "\nProperties=species:S:1:pos:R:3:a:R:1:b:R:1\n";
    for (int i = 0; i <= k; ++i)
      text += "C " + std::to_string(i) + " 0 " + std::to_string(k) + " " + std::to_string(i) + " " +
              std::to_string(k - i) + "\n";
  }
  put(path, text);
  SceneFrames frames(path);
  const std::vector<ReadOptions> wanted = {{.frame = 3},
                                           {.frame = 0},
                                           {.frame = -1},
                                           {.color_by = "a", .frame = 4},
                                           {.color_by = "b", .frame = 4},
                                           {.frame = 8}};
  std::vector<std::string> alone;
  for (const ReadOptions& options : wanted)
    alone.push_back(content_hash(read_scene(path, options)->scene));
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto read = frames.read(wanted[i]);
    ASSERT_TRUE(read) << read.error().front().text();
    EXPECT_EQ(content_hash(read->scene), alone[i]);
    EXPECT_EQ(read->frames, 9u);
    std::filesystem::remove(path);  // the file is not reopened
  }
  EXPECT_THAT(frames.read({.frame = 9}).error().front().text(), HasSubstr("the file has 9"));
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

TEST(Xyz, CoincidentAtomsAreReported) {
  EXPECT_THAT(said("3\n\nC 0 0 0\nO 0 0 1.2\nN 0 0 0\n", "a.xyz", {}),
              HasSubstr("warning: atoms at the same position as another (1: 3)"));
  EXPECT_EQ(said("2\n\nC 0 0 0\nO 0 0 1.2\n", "a.xyz", {}), "");
}

TEST(Xyz, NumbersOfElementsMayBeCalledZ) {
  const auto got = read("1\nProperties=pos:R:3:Z:I:1\n0 0 0 16\n", "a.xyz");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.materials[got->scene.sphere_materials[0]].color, element_color(16));
  // Symbols take precedence.
  EXPECT_TRUE(read("1\nProperties=Z:I:1:species:S:1:pos:R:3\n16 O 0 0 0\n", "a.xyz"));
}

TEST(Xyz, FaultsHaveLocations) {
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
  // Missing columns, and columns with the names of built-in ones. Missing numbers are refused, not
  // replaced by defaults.
  const std::string short_lines = "ATOM      1  CA  ALA A   1       1.000   2.000   3.000\n";
  for (const char* by : {"bfactor", "occupancy"}) {
    EXPECT_THAT(error(short_lines, "a.pdb", {.color_by = by}), HasSubstr("cannot colour by"));
    EXPECT_THAT(error(kSalt, "a.cif", {.color_by = by}), HasSubstr("cannot colour by"));
    EXPECT_TRUE(read(short_lines.substr(0, short_lines.size() - 1) + "  0.50 12.00\n", "a.pdb",
                     {.color_by = by}));
  }
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "bfactor"}),
              HasSubstr("cannot colour by 'bfactor'; the file has element, index"));
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "chain"}), HasSubstr("cannot colour by"));
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "residue"}), HasSubstr("cannot colour by"));
  const auto own = read("2\nProperties=pos:R:3:occupancy:R:1\n0 0 0 0.25\n4 0 0 0.5\n", "a.xyz",
                        {.color_by = "occupancy"});
  ASSERT_TRUE(own && own->colors);
  EXPECT_EQ(own->colors->most, 0.5);
  EXPECT_THAT(error(kWater, "a.xyz", {.color_by = "index", .colormap = "jet"}),
              HasSubstr("unknown colour map 'jet'"));
  EXPECT_THAT(error(kWater, "a.xyz", {.colormap = "viridis"}), HasSubstr("has no effect"));
  const auto by_index = read(kWater, "a.xyz", {.color_by = "index"});
  EXPECT_EQ(by_index->scene.materials[by_index->scene.sphere_materials[0]].color,
            *map_color("viridis", 0));
  EXPECT_EQ(by_index->scene.materials[by_index->scene.sphere_materials[2]].color,
            *map_color("viridis", 1));
}

TEST(Atoms, ColourRangesHoldForAllFrames) {
  const ReadOptions by_index{.color_by = "index", .color_range = std::array{1.0, 3.0}};
  const auto got = read(kWater, "a.xyz", by_index);
  ASSERT_TRUE(got) << got.error().front().text();
  const auto color = [&](size_t i) {
    return got->scene.materials[got->scene.sphere_materials[i]].color;
  };
  EXPECT_EQ(color(0), *map_color("viridis", 0));  // beyond the end
  EXPECT_EQ(color(1), *map_color("viridis", 0));
  EXPECT_EQ(color(2), *map_color("viridis", 0.5f));
  ASSERT_TRUE(got->colors);
  EXPECT_EQ(got->colors->name, "index");
  EXPECT_EQ(got->colors->most, 3);
  // The other way round.
  const auto turned =
      read(kWater, "a.xyz", {.color_by = "index", .color_range = std::array{2.0, 0.0}});
  EXPECT_EQ(turned->scene.materials[turned->scene.sphere_materials[0]].color,
            *map_color("viridis", 1));
  EXPECT_THAT(error(kWater, "a.xyz", {.color_range = std::array{0.0, 1.0}}),
              HasSubstr("has no effect"));
  EXPECT_THAT(error(kMesh, "a.ply", {.color_range = std::array{0.0, 1.0}}),
              HasSubstr("has no effect without color-by"));
  EXPECT_THAT(error(kStl, "a.stl", {.color_range = std::array{0.0, 1.0}}),
              HasSubstr("color-range has no effect"));
  EXPECT_FALSE(read(kWater, "a.xyz")->colors);
}

// The ends of the maps as published.
TEST(Atoms, NumbersOfAScaleDiffer) {
  const ColorScale usual{.name = {}, .map = {}, .least = 0, .most = 0.3};
  EXPECT_EQ(scale_text(usual, 0.1), "0.1");
  const ColorScale narrow{.name = {}, .map = {}, .least = 1000000, .most = 1000010};
  EXPECT_EQ(scale_text(narrow, 1000002), "1000002");
}

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
TEST(Atoms, BondsMatchATestOfAllPairs) {
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
  // Iron has no bond through an oxygen atom in between.
  const auto all = std::set(expected.begin(), expected.end());
  const auto squared = [&](uint32_t i, uint32_t j) {
    float sum = 0;
    for (size_t k = 0; k < 3; ++k)
      sum += (atoms[i].place[k] - atoms[j].place[k]) * (atoms[i].place[k] - atoms[j].place[k]);
    return sum;
  };
  const auto is_behind = [&](uint32_t iron, uint32_t other) {
    if (atoms[iron].element != 26 || atoms[other].element == 8) return false;
    for (uint32_t k = 0; k < atoms.size(); ++k)
      if (atoms[k].element == 8 && all.contains({std::min(iron, k), std::max(iron, k)}) &&
          all.contains({std::min(other, k), std::max(other, k)}) &&
          squared(iron, k) < squared(iron, other))
        return true;
    return false;
  };
  std::erase_if(expected, [&](const auto& bond) {
    return is_behind(bond[0], bond[1]) || is_behind(bond[1], bond[0]);
  });
  EXPECT_GT(all.size(), expected.size());
  EXPECT_EQ(*find_bonds(atoms), expected);
  // No molecule, and no work for hours.
  EXPECT_FALSE(find_bonds(std::vector<Atom>(200'000)));
}

// A row of potassium, oxygen and aluminium: the metals touch, but only through the oxygen. Two
// atoms of a pure metal are bonded.
TEST(Atoms, MetalsHaveNoBondsThroughAnions) {
  const std::vector<Atom> mineral = {{.place = {0, 0, 0}, .element = 19},
                                     {.place = {2.6f, 0, 0}, .element = 8},
                                     {.place = {3.2f, 1.7f, 0}, .element = 13}};
  EXPECT_EQ(*find_bonds(mineral), (Bonds{{0, 1}, {1, 2}}));
  const std::vector<Atom> metal = {{.place = {0, 0, 0}, .element = 29},
                                   {.place = {2.5f, 0, 0}, .element = 29}};
  EXPECT_EQ(*find_bonds(metal), (Bonds{{0, 1}}));
}

// A trace has a bond from each residue to the next, within a chain, if none is missing.
TEST(Atoms, TracesAreJoined) {
  const auto alpha = [](int number, char chain, double x) {
    return fmt::format(
        "ATOM  {:5}  CA  ALA {}{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C\n", number,
        chain, number, x, 0.0, 0.0);
  };
  const auto trace = read(alpha(1, 'A', 0) + alpha(2, 'A', 3.8) + alpha(3, 'A', 7.6) +
                              alpha(4, 'A', 15) + alpha(5, 'B', 18.8) + alpha(6, 'B', 22.6),
                          "a.pdb");
  ASSERT_TRUE(trace) << trace.error().front().text();
  EXPECT_EQ(trace->scene.cones.size(), 3u);
  EXPECT_EQ(trace->notices.back().message, "bonds along the chains (3)");
}

TEST(Atoms, FewWithoutBondsFillTheirSpace) {
  const auto gas = read("3\n\nAr 0 0 0\nAr 9 0 0\nAr 0 9 0\n", "a.xyz");
  ASSERT_TRUE(gas);
  EXPECT_EQ(gas->scene.spheres[0].radius, van_der_waals_radius(18));
  const auto asked = read("1\n\nAr 0 0 0\n", "a.xyz", {.style = AtomStyle::ball_and_stick});
  EXPECT_LT(asked->scene.spheres[0].radius, van_der_waals_radius(18));
}

TEST(Atoms, CagesOfCarbonShowTheirBonds) {
  const auto tube = [](std::string_view last) {
    std::string text = "400\n\n";
    for (int i = 0; i < 399; ++i) text += fmt::format("C {} 0 0\n", 1.4 * i);
    return read(text + fmt::format("{} {} 0 0\n", last, 1.4 * 399), "a.xyz");
  };
  EXPECT_EQ(tube("C")->scene.cones.size(), 399u);
  EXPECT_TRUE(tube("N")->scene.cones.empty());
}

TEST(Atoms, SkippedFramesAreReported) {
  const std::string text = "1\n\nC 0 0 0\n1\n\nC 1 0 0\n1\n\nC 2 0 0\n";
  EXPECT_THAT(said(text, "a.xyz", {}),
              HasSubstr("frames or models after the first (2); frame selects one"));
  EXPECT_EQ(said(text, "a.xyz", {.frame = 1}), "");
}

// Two chains of 3,000 atoms have a colour each; where one is water, elements have.
TEST(Pdb, LargeAssembliesShowTheirChains) {
  const auto chains = [](int atoms_of_a_residue) {
    std::string text;
    for (int i = 0; i < 6000; ++i)
      text += fmt::format(
          "ATOM  {:5}  {}   XYZ {}{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           {}\n", i,
          i % 2 ? 'C' : 'O', i < 3000 ? 'A' : 'B',
          i < 3000 ? i / 10 : i / atoms_of_a_residue % 1000, double(i % 80), double(i / 80), 0.0,
          i % 2 ? 'C' : 'O');
    const auto scene = read(text, "a.pdb");
    std::string names;
    for (const LegendEntry& entry : scene->legend) names += entry.name + ' ';
    return names;
  };
  EXPECT_EQ(chains(10), "chain A chain B ");
  EXPECT_EQ(chains(1), "C O ");
}

TEST(Pdb, AssembliesRepeatTheirChains) {
  const auto whole = read(kPdb, "a.pdb", {.style = AtomStyle::space_filling});
  ASSERT_TRUE(whole) << whole.error().front().text();
  // Only chain A, with the first position of its disordered atom.
  ASSERT_EQ(whole->scene.spheres.size(), 4u);
  EXPECT_EQ(whole->scene.spheres[1].center, Vec3f(2.4f, 2, 3));
  EXPECT_FLOAT_EQ(whole->scene.spheres[3].center.x, 7.6f);
  const auto unit = read(kPdb, "a.pdb", {.style = AtomStyle::space_filling, .assembly = 0});
  ASSERT_EQ(unit->scene.spheres.size(), 3u);
  EXPECT_EQ(unit->scene.materials[unit->scene.sphere_materials[2]].color, element_color(20));
  const auto copied = read(kPdb, "a.pdb", {.style = AtomStyle::space_filling, .instances = true});
  ASSERT_EQ(copied->scene.prototypes.size(), 1u);
  EXPECT_EQ(copied->scene.prototypes[0].spheres.size(), 2u);
  ASSERT_EQ(copied->scene.instances.size(), 2u);
  EXPECT_EQ(copied->scene.instances[1].matrix[3], 10);
  EXPECT_TRUE(copied->scene.spheres.empty());
  EXPECT_THAT(copied->scene.object_names, ElementsAre("copy 1", "copy 2"));
  EXPECT_EQ(object_of(copied->scene, PoolKind::instance, 1), 2u);
  EXPECT_EQ(object_of(whole->scene, PoolKind::sphere, 3), 2u);
  EXPECT_EQ(copied->scene.camera.from, whole->scene.camera.from);
  EXPECT_THAT(error(kPdb, "a.pdb", {.assembly = 2}),
              HasSubstr("assembly 2 does not exist; the file has 1"));
  EXPECT_THAT(error("1\n\nC 0 0 0\n", "a.xyz", {.assembly = 1}), HasSubstr("has no assemblies"));
  EXPECT_EQ(read(kPdb, "a.pdb")->scene.cones.size(), 2u);  // few atoms: with bonds
}

// Some programs name atoms by their elements, or list alternate positions one after the other.
TEST(Pdb, AtomsOfOneNameAreSeveral) {
  auto atom = [serial = 0](const char* name_and_altloc, const char* residue, double x) mutable {
    return fmt::format("HETATM{:5} {}{}    {:8.3f}   0.000   0.000  1.00  0.00           C\n",
                       ++serial, name_and_altloc, residue, x);
  };
  const auto spheres = [](const std::string& text) {
    const auto got = read(text, "a.pdb", {.style = AtomStyle::space_filling});
    return got ? got->scene.spheres.size() : 0;
  };
  std::string ring, blocks, ions, mixed;
  for (int i = 0; i < 6; ++i) ring += atom(" C   ", "UNL     1", 1.4 * i);
  EXPECT_EQ(spheres(ring), 6u);
  for (const char* name : {" N  A", " CA A", " N  B", " CA B"})
    blocks += atom(name, "ALA A   1", 1);
  EXPECT_EQ(spheres(blocks), 2u);
  ions = atom("NA   ", " NA A   1", 0) + atom("CL   ", " CL A   1", 5);
  EXPECT_EQ(spheres(ions), 2u);
  mixed = atom(" CA A", "SER A   1", 0) + atom(" CA B", "THR A   1", 1);
  EXPECT_EQ(spheres(mixed), 1u);
}

// A fragment with the header of the whole is drawn as it is, unless the assembly is requested.
TEST(Pdb, AssembliesOfOtherChainsAreSkipped) {
  std::string other(kPdb);
  other.replace(other.find("CHAINS: A"), 9, "CHAINS: C");
  const auto got = read(other, "a.pdb", {.style = AtomStyle::space_filling});
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.spheres.size(), 3u);
  EXPECT_THAT(error(other, "a.pdb", {.style = AtomStyle::space_filling, .assembly = 1}),
              HasSubstr("the assembly has no atoms"));
}

TEST(Pdb, BrokenFilesAreRefused) {
  std::string flat(kPdb);
  flat.replace(flat.find("-1.000000"), 9, " 0.000000");
  EXPECT_THAT(error(flat, "a.pdb", {.style = AtomStyle::space_filling}),
              HasSubstr("a matrix of an assembly has no inverse"));
  EXPECT_NE(error("HEADER    x\nATOM      1  N   ALA A   1       x\n", "a.pdb"), "no error");
  EXPECT_NE(error("HEADER    nothing\nEND\n", "a.pdb"), "no error");
  EXPECT_NE(error("data_x\nloop_\n_atom_site.id\n", "a.cif"), "no error");
  EXPECT_NE(error("data_x\n_cell.length_a 1\n", "a.cif"), "no error");
}

// Numbers of the maximum length, and longer ones, which are invalid.
TEST(Xyz, NumbersOfFortranMayBeLong) {
  const std::string digits(58, '0');
  const auto places = read("1\n\nC 1." + digits + "D+01 2 3\n", "a.xyz");
  ASSERT_TRUE(places) << places.error().front().text();
  EXPECT_EQ(places->scene.spheres[0].center, Vec3f(10, 2, 3));
  EXPECT_FALSE(read("1\n\nC 1." + digits + "0D+01 2 3\n", "a.xyz"));
}

// The sides of the cell by the ends of the lines that are drawn along them.
std::array<Vec3f, 3> sides_drawn(std::string_view text, std::string_view name,
                                 ReadOptions options = {}) {
  options.cell = true, options.style = AtomStyle::space_filling, options.frame = -1;
  const auto got = read(text, name, options);
  if (!got || got->scene.cones.size() < 12) return {};
  const auto& lines = got->scene.cones;
  const auto line = [&](size_t i) { return lines[i].apex - lines[i].base; };
  const auto& n = options.images;
  const size_t first = size_t((n[1] + 1) * (n[2] + 1)), second = size_t((n[2] + 1) * (n[0] + 1));
  return {line(0), line(first), line(first + second)};
}

TEST(Atoms, CellsAreThoseOfTheFiles) {
  using Sides = std::array<Vec3f, 3>;
  const auto near = [](const Sides& a, const Sides& b) {
    for (size_t i = 0; i < 3; ++i)
      if (length(a[i] - b[i]) > 1e-4f) return false;
    return true;
  };
  EXPECT_TRUE(near(sides_drawn(kSalt, "a.cif"),
                   Sides{Vec3f(5.64f, 0, 0), Vec3f(0, 5.64f, 0), Vec3f(0, 0, 5.64f)}));
  EXPECT_TRUE(near(sides_drawn(kSalt, "a.cif", {.images = {2, 1, 3}}),
                   Sides{Vec3f(11.28f, 0, 0), Vec3f(0, 5.64f, 0), Vec3f(0, 0, 16.92f)}));
  EXPECT_TRUE(
      near(sides_drawn(kDump, "a.dump"), Sides{Vec3f(10, 0, 0), Vec3f(2, 10, 0), Vec3f(0, 0, 10)}));
  EXPECT_TRUE(
      near(sides_drawn(kData, "a.lmp"), Sides{Vec3f(20, 0, 0), Vec3f(0, 20, 0), Vec3f(0, 0, 20)}));
  std::string leaning(kData);
  leaning.replace(leaning.find("zlo zhi"), 7, "zlo zhi\n1 2 3 xy xz yz");
  EXPECT_TRUE(near(sides_drawn(leaning, "a.lmp"),
                   Sides{Vec3f(20, 0, 0), Vec3f(1, 20, 0), Vec3f(2, 3, 20)}));
  EXPECT_TRUE(near(sides_drawn(kGro, "a.gro"),
                   Sides{Vec3f(18.6824f, 0, 0), Vec3f(0, 18.6824f, 0), Vec3f(0, 0, 18.6824f)}));
  std::string nine(kGro);
  nine.insert(nine.size() - 1, " 0 0 0.5 0 0.25 0.125");
  EXPECT_TRUE(near(sides_drawn(nine, "a.gro"), Sides{Vec3f(18.6824f, 0, 0), Vec3f(5, 18.6824f, 0),
                                                     Vec3f(2.5f, 1.25f, 18.6824f)}));
  EXPECT_TRUE(
      near(sides_drawn("1\nLattice=\"4 0 0 1 5 0 0 1 6\" Origin=\"1 2 3\"\nAr 1 1 1\n", "a.xyz"),
           Sides{Vec3f(4, 0, 0), Vec3f(1, 5, 0), Vec3f(0, 1, 6)}));
  const std::string crystal =
      "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n";
  EXPECT_TRUE(near(sides_drawn(crystal + std::string(kPdb), "a.pdb"),
                   Sides{Vec3f(10, 0, 0), Vec3f(0, 20, 0), Vec3f(0, 0, 30)}));
  std::string general(kDump);
  general.replace(general.rfind("ITEM: BOX BOUNDS"), 56,
                  "ITEM: BOX BOUNDS abc origin pp pp pp\n3 0 0 7\n1 4 0 8\n1 1 5 9\n");
  EXPECT_TRUE(
      near(sides_drawn(general, "a.dump"), Sides{Vec3f(3, 0, 0), Vec3f(1, 4, 0), Vec3f(1, 1, 5)}));
  EXPECT_THAT(error(kWater, "a.xyz", {.cell = true}), HasSubstr("cell needs a cell"));
  EXPECT_THAT(error(kPdb, "a.pdb", {.images = {2, 1, 1}}), HasSubstr("images needs a cell"));
  EXPECT_THAT(error("1\nLattice=\"inf 0 0 1 5 0 0 1 6\"\nAr 1 1 1\n", "a.xyz", {.cell = true}),
              HasSubstr("cell"));
}

// Pictures show the cell of a crystal, with the atoms of its corner, edge and face on all sides.
TEST(Atoms, SmallCellsAreComplete) {
  const std::string atoms =
      "4\nLattice=\"4 0 0 1 5 0 0 1 6\" Origin=\"1 2 3\"\n"
      "Ar 1 2 3\nNe 3.5 5 6.5\nHe 3 2 3\nKr 2.5 5 3\n";
  const auto drawn = [&](std::string_view text, ReadOptions options) {
    options.style = AtomStyle::points;
    const auto got = read(text, "a.xyz", options);
    return std::pair(got->scene.spheres.size(), got->scene.cones.size());
  };
  EXPECT_EQ(drawn(atoms, {}), std::pair(4zu, 0zu)) << "conversions have the file's atoms";
  // Eight corners, four edges, two faces and one inside; the edges of the cell have eight spheres.
  EXPECT_EQ(drawn(atoms, kForPictures), std::pair(15zu + 8, 12zu));
  EXPECT_EQ(drawn(atoms, {.cell = false}), std::pair(4zu, 0zu));
  EXPECT_EQ(drawn(atoms, {.cell = std::nullopt, .images = {2, 1, 1}}),
            std::pair(12 + 8 + 4 + 2 + 12zu, 12 + 4zu));
  // Not in a direction without periodicity according to the file, nor in frames.
  std::string slab = atoms;
  slab.insert(slab.find(" Origin"), " pbc=\"T F T\"");
  EXPECT_EQ(drawn(slab, kForPictures), std::pair(9zu + 8, 12zu));
  EXPECT_THAT(said(slab, "a.xyz", {.cell = std::nullopt, .images = {1, 2, 1}}),
              HasSubstr("the file is not periodic along b"));
  EXPECT_EQ(drawn(atoms + atoms, kForPictures), std::pair(4zu + 8, 12zu));
  // A drop in a box shows no cell, unless requested.
  const std::string drop = "2\nLattice=\"40 0 0 0 50 0 0 0 60\"\nAr 1 2 3\nAr 4 2 3\n";
  EXPECT_EQ(drawn(drop, kForPictures), std::pair(2zu, 0zu));
  EXPECT_EQ(drawn(drop, {.cell = true}), std::pair(2 + 8zu, 12zu));
  const auto got = read(atoms, "a.xyz", kForPictures);
  EXPECT_EQ(got->notices.back().message, "images of atoms on the faces of the cell");
}

// As instances, as primitives and as atoms with bonds between the images.
TEST(Atoms, ImagesFillTheirCells) {
  const std::string chain = "2\nLattice=\"3 0 0 0 9 0 0 0 9\"\nC 0 0 0\nC 1.5 0 0\n";
  const ReadOptions filled{.style = AtomStyle::space_filling, .images = {4, 2, 1}};
  const auto whole = read(chain, "a.xyz", filled);
  ASSERT_TRUE(whole) << whole.error().front().text();
  ASSERT_EQ(whole->scene.spheres.size(), 16u);
  EXPECT_EQ(whole->scene.spheres[15].center, Vec3f(10.5f, 9, 0));
  ReadOptions copies = filled;
  copies.instances = true;
  const auto copied = read(chain, "a.xyz", copies);
  EXPECT_EQ(copied->scene.instances.size(), 8u);
  EXPECT_EQ(copied->scene.instances[1].matrix[3], 3);
  EXPECT_EQ(copied->scene.prototypes[0].spheres.size(), 2u);
  const auto bonds = read(chain, "a.xyz", {.images = {4, 2, 1}});
  EXPECT_EQ(bonds->scene.spheres.size(), 16u);
  EXPECT_EQ(bonds->scene.cones.size(), 14u);  // of two chains of eight
  EXPECT_EQ(bonds->scene.spheres[15].center, Vec3f(10.5f, 9, 0));
  EXPECT_THAT(
      error(chain, "a.xyz", {.style = AtomStyle::space_filling, .images = {1000, 1000, 1000}}),
      HasSubstr("images of the cell are too many; expected at most 10000000"));
  const std::string crystal =
      "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n";
  EXPECT_THAT(error(crystal + std::string(kPdb), "a.pdb", {.assembly = 1, .images = {1, 2, 1}}),
              HasSubstr("leave out assembly or images"));
  // The asymmetric unit, not the assembly, fills the cell.
  EXPECT_EQ(read(crystal + std::string(kPdb), "a.pdb",
                 {.style = AtomStyle::space_filling, .images = {1, 2, 1}})
                ->scene.spheres.size(),
            6u);
}

TEST(Pdb, AssembliesHaveBonds) {
  const auto whole = read(kPdb, "a.pdb", {.style = AtomStyle::sticks, .assembly = 1});
  ASSERT_TRUE(whole) << whole.error().front().text();
  EXPECT_EQ(whole->scene.spheres.size(), 4u);
  EXPECT_EQ(whole->scene.cones.size(), 4u);
}

TEST(Pdb, LinksAreBonds) {
  const auto bonds = [](std::string_view second, std::string_view head) {
    const std::string text =
        std::string(head) +
        "ATOM      1  SG  CYS A   3       0.000   0.000   0.000  1.00  0.00           S\n"
        "ATOM      2  SG  CYS A  40    " +
        std::string(second) + "  1.00  0.00           S\n";
    const auto got = read(text, "a.pdb");
    return got ? got->scene.cones.size() : 99;
  };
  const std::string_view bridge =
      "SSBOND   1 CYS A    3    CYS A   40                          1555   1555  2.03\n";
  EXPECT_EQ(bonds("   5.000   0.000   0.000", ""), 0u);
  EXPECT_EQ(bonds("   5.000   0.000   0.000", bridge), 1u);
  std::string elsewhere(bridge);
  elsewhere.replace(elsewhere.find("1555", 66), 4, "2555");
  EXPECT_EQ(bonds("   5.000   0.000   0.000", elsewhere), 0u);
}

}  // namespace
}  // namespace raio::core
