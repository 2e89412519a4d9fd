// Files of LAMMPS: dumps and data.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/colormaps.h"
#include "io/scene_file.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

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
  EXPECT_THAT(with("ATOMS\n2", "ATOMS\n99"), HasSubstr("expected 99 atoms, found 2"));
  EXPECT_THAT(with("xs ys zs c_pe", "xs ys c_pe"), HasSubstr("position columns"));
  EXPECT_THAT(with("1 1 0.5 0.25", "1 1 0.5 a"),
              HasSubstr("a.dump:10:9: error: expected a coordinate"));
  EXPECT_THAT(with("-1 1\n0 4", "-1 1\n0"), HasSubstr("as many numbers in each line"));
  EXPECT_THAT(with("1 1 0.5", "1 0 0.5"), HasSubstr("expected a type"));
  EXPECT_THAT(error("ITEM: TIMESTEP\n0\n", "a.dump"), HasSubstr("ends before the atoms"));
}

TEST(Lammps, PositionsHaveOneConvention) {
  // z stands alone, and xs has no ys: neither counts.
  const auto got = read(
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp pp\n0 10\n0 10\n0 10\n"
      "ITEM: ATOMS id z xs zs xu y yu zu\n1 7 0.5 0.7 -5 3 13 27\n",
      "a.dump");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.spheres[0].center, Vec3f(-5, 13, 27));
}

TEST(Lammps, SurplusRowsAreReported) {
  std::string text(kData);
  text.replace(text.find("3 atoms"), 7, "2 atoms");
  text.replace(text.find("2 bonds"), 7, "1 bonds");
  const auto got = read(text, "a.data");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.spheres.size(), 2u);
  std::string told;
  for (const Diagnostic& notice : got->notices) told += notice.text() + '\n';
  EXPECT_THAT(told, HasSubstr("rows of Atoms beyond the header's number of atoms (1: 8)"));
  EXPECT_THAT(told, HasSubstr("rows of Bonds beyond the header's number of bonds (1: 2)"));
}

// Old files of the style spin have a column before x.
TEST(Lammps, CoincidentAtomsAreReported) {
  const auto got = read(
      "LAMMPS data file\n\n2 atoms\n1 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n"
      "Atoms # spin\n\n7 1 1.72 0.0 0.0 0.0 0.6 -0.8 1.0\n8 1 1.72 0.0 0.0 1.77 0.8 0.6 1.0\n",
      "a.data");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_THAT(got->notices.back().text(),
              HasSubstr("atoms at the same position as another (1: 8)"));
}

// LAMMPS ignores the line after the name of a section.
TEST(Lammps, CommentsMayStandAboveRows) {
  std::string text(kData);
  for (const std::string name : {"Masses\n", "Atoms # full\n", "Bonds\n"}) {
    ASSERT_NE(text.find(name), text.npos) << name;
    text.insert(text.find(name) + name.size(), "# columns\n");
  }
  const auto plain = read(kData, "a.data"), got = read(text, "a.data");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.cones.size(), plain->scene.cones.size());
  EXPECT_EQ(got->scene.materials[got->scene.sphere_materials[0]].color, element_color(8));
  text.replace(text.find("Atoms # full"), 12, "Atoms");
  EXPECT_TRUE(read(text, "a.data")) << "the columns are those of full";
}

// Densities of rheo are not 0.
TEST(Lammps, ChargesMayBeZero) {
  const auto got = read(
      "LAMMPS data file\n\n2 atoms\n2 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n"
      "Atoms\n\n1 1 1 0.0 1 2 3.5\n2 1 2 0.0 3 4 4.5\n",
      "a.data");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.spheres[0].center, Vec3f(1, 2, 3.5f));
}

TEST(Lammps, DataFilesDefineBonds) {
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
  EXPECT_EQ(with("Atoms # full", "Atoms # magic"), "no error") << "the columns are those of full";
  EXPECT_THAT(with("1 7 8", "1 7 6"), HasSubstr("a bond refers to atom 6"));
  EXPECT_THAT(with("3 atoms", "3000 atoms"), HasSubstr("expected 3000 atoms"));
  EXPECT_THAT(with("9 1 2 0.4 2 1 1", "9 1 2 0.4 2 1 z"), HasSubstr("water.lmp:18:15: error"));
}

TEST(Lammps, TypesMayHaveNames) {
  std::string text(kData);
  for (const auto& [from, to] :
       {std::pair("Masses\n\n1 15.9994 # O\n2 ",
                  "Atom Type Labels\n\n1 ow\n2 H\n\nMasses\n\now 15.9994\nH "),
        {"7 1 1 ", "7 1 ow "},
        {"9 1 2 ", "9 1 H "},
        {"8 1 2 ", "8 1 H "}})
    text.replace(text.find(from), std::string_view(from).size(), to);
  const auto got = read(text, "water.lmp"), as_numbers = read(kData, "water.lmp");
  ASSERT_TRUE(got) << got.error().front().text();
  ASSERT_EQ(got->scene.spheres.size(), 3u);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_EQ(got->scene.materials[got->scene.sphere_materials[i]].color,
              as_numbers->scene.materials[as_numbers->scene.sphere_materials[i]].color);
}

TEST(Lammps, MassesOverrideNames) {
  const auto element_of = [](std::string_view mass) {
    std::string text(kData);
    text.replace(text.find("15.9994 # O"), 11, mass);
    const auto got = read(text, "a.lmp");
    if (!got) return -1;
    const Rgb color = got->scene.materials[got->scene.sphere_materials[0]].color;
    for (int i = 1; i < 100; ++i)
      if (color == element_color(i)) return i;
    return 0;
  };
  EXPECT_EQ(element_of("15.9994 # O"), 8);
  EXPECT_EQ(element_of("12.011 # CA"), 6);
  EXPECT_EQ(element_of("40.078 # CA"), 20);
  EXPECT_EQ(element_of("16.0 # os"), 8);
  EXPECT_EQ(element_of("16.043 # C"), 6) << "CH4 in one";
  EXPECT_EQ(element_of("14.007 # HE"), 7);
}

TEST(Lammps, BondsConnectPeriodicImages) {
  const std::string chain =
      "a chain\n\n2 atoms\n1 bonds\n0 3 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n0 0 0.5 xy xz yz\n\n"
      "Masses\n\n1 12.011\n\nAtoms # bond\n\n1 1 1 0 0.1 0.1\n2 1 1 1.5 0.1 8.9\n\n"
      "Bonds\n\n1 1 1 2\n";
  const auto count = [&](std::array<int, 3> images) {
    const auto got = read(chain, "a.data", {.style = AtomStyle::sticks, .images = images});
    return got ? got->scene.cones.size() : 99;
  };
  EXPECT_EQ(count({1, 1, 1}), 0u);
  EXPECT_EQ(count({4, 1, 1}), 0u);
  EXPECT_EQ(count({1, 1, 3}), 2u) << "both atoms of the copies above and below";
  const auto got = read(chain, "a.data", {.style = AtomStyle::sticks, .images = {1, 1, 2}});
  ASSERT_TRUE(got) << got.error().front().text();
  for (const Cone& bond : got->scene.cones) EXPECT_LT(length(bond.apex - bond.base), 1.7f);
}

TEST(Lammps, EmptyFramesAreSkipped) {
  const std::string text =
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n0\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n"
      "ITEM: ATOMS id type xs ys zs\n" +
      std::string(kDump);
  EXPECT_THAT(error(text, "a.dump"), HasSubstr("frame 0 has no atoms; the file has 3"));
  EXPECT_EQ(read(text, "a.dump", {.frame = 1})->scene.spheres.size(), 2u);
  EXPECT_EQ(read(text, "a.dump", {.frame = -1})->scene.spheres.size(), 1u);
}

TEST(Lammps, PointsHaveTheUsualRadius) {
  const std::string text =
      "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n3\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n"
      "ITEM: ATOMS id x y z radius\n1 0 0 0 2\n2 0 0 5 0\n3 0 0 9 0\n";
  const auto got = read(text, "a.dump", {.radius = 0.5f});
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_EQ(got->scene.spheres[0].radius, 2);
  EXPECT_EQ(got->scene.spheres[1].radius, 0.5f);
  EXPECT_GT(read(text, "a.dump")->scene.spheres[2].radius, 0);
}

}  // namespace
}  // namespace raio::core
