// Crystals and molecules in CIF.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/atoms/site_values.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

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

TEST(Cif, ColumnsMayBeLeftOut) {
  const auto few = read(
      "data_x\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.Cartn_x\n"
      "_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 N 1 2 3\n2 C 2.4 2 3\n",
      "a.cif");
  ASSERT_TRUE(few) << few.error().front().text();
  ASSERT_EQ(few->scene.spheres.size(), 2u);
  EXPECT_EQ(few->scene.spheres[1].center, Vec3f(2.4f, 2, 3));
  const auto places = read(
      "data_x\nloop_\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 2 3\n5 2 3\n",
      "a.cif");
  ASSERT_TRUE(places) << places.error().front().text();
  EXPECT_EQ(places->scene.spheres.size(), 2u);
  const auto long_number = read(
      "data_x\nloop_\n_atom_site.id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
      "66666666666 1 2 3\n2147483647 2 2 3\nLONG-NAME-OF-AN-ATOM 3 2 3\n",
      "a.cif");
  ASSERT_TRUE(long_number) << long_number.error().front().text();
  EXPECT_THAT(long_number->notices, testing::Contains(testing::ResultOf(
                                        [](const Diagnostic& d) { return d.text(); },
                                        testing::HasSubstr("do not fit in 32 bits (1: 666"))));
}

// Products of operations, the last applied first; and ranges with mostly missing numbers.
TEST(Cif, AssembliesMultiplyTheirOperations) {
  const auto copies = [](const std::string& expression) {
    return "data_x\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_asym_id\n"
           "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 N A 1 2 3\n"
           "loop_\n_pdbx_struct_assembly_gen.assembly_id\n"
           "_pdbx_struct_assembly_gen.oper_expression\n_pdbx_struct_assembly_gen.asym_id_list\n1 "
           "'" +
           expression +
           "' A\nloop_\n_pdbx_struct_oper_list.id\n"
           "_pdbx_struct_oper_list.matrix[1][1]\n_pdbx_struct_oper_list.matrix[1][2]\n"
           "_pdbx_struct_oper_list.matrix[1][3]\n_pdbx_struct_oper_list.vector[1]\n"
           "_pdbx_struct_oper_list.matrix[2][1]\n_pdbx_struct_oper_list.matrix[2][2]\n"
           "_pdbx_struct_oper_list.matrix[2][3]\n_pdbx_struct_oper_list.vector[2]\n"
           "_pdbx_struct_oper_list.matrix[3][1]\n_pdbx_struct_oper_list.matrix[3][2]\n"
           "_pdbx_struct_oper_list.matrix[3][3]\n_pdbx_struct_oper_list.vector[3]\n"
           "1 1 0 0 0 0 1 0 0 0 0 1 0\n2 1 0 0 10 0 1 0 0 0 0 1 0\n"
           "P 0 -1 0 0 1 0 0 0 0 0 1 0\n";
  };
  const auto first_x = [&](const std::string& expression) {
    const auto got = read(copies(expression), "a.cif", {.style = AtomStyle::space_filling});
    std::vector<float> x;
    if (got)
      for (const Sphere& s : got->scene.spheres) x.push_back(s.center.x);
    return x;
  };
  EXPECT_THAT(first_x("1,2"), ElementsAre(1, 11));
  EXPECT_THAT(first_x("(1-2)"), ElementsAre(1, 11));
  EXPECT_THAT(first_x("(1-2000000000)"), ElementsAre(1, 11));
  EXPECT_THAT(first_x("(2)(P)"), ElementsAre(8));
  EXPECT_THAT(first_x("(P)(2)"), ElementsAre(-2));
  EXPECT_THAT(first_x("(1,2)(1-2)"), ElementsAre(1, 11, 11, 21));
  std::string many;
  for (int i = 0; i < 30; ++i) many += "(1-2)";
  EXPECT_THAT(error(copies(many), "a.cif", {.style = AtomStyle::space_filling}),
              HasSubstr("more than a million instances"));
}

// Its 192 operations map each atom to four positions.
TEST(Cif, CrystalsFillTheirCell) {
  const auto salt = read(kSalt, "salt.cif", {.style = AtomStyle::space_filling});
  ASSERT_TRUE(salt) << salt.error().front().text();
  const Scene& scene = salt->scene;
  ASSERT_EQ(scene.spheres.size(), 8u);
  for (size_t i = 0; i < 8; ++i) {
    // Sodium where the halves are even, chlorine where they are odd.
    const Vec3f c = scene.spheres[i].center * (2 / 5.64f);
    EXPECT_NEAR(std::remainder(c.x + c.y + c.z - float(i / 4), 2), 0, 1e-4) << i;
    EXPECT_EQ(scene.materials[scene.sphere_materials[i]].color, element_color(i < 4 ? 11 : 17));
  }
  // As the file lists them, which is more specific than a name.
  std::string text(kSalt);
  text += "loop_\n_symmetry_equiv_pos_as_xyz\n'x,y,z'\n'-x,-y,1/4+z'\n";
  EXPECT_EQ(read(text, "salt.cif")->scene.spheres.size(), 4u);
  EXPECT_THAT(error(std::string(kSalt) + "loop_\n_symmetry_equiv_pos_as_xyz\n'x,y'\n", "salt.cif"),
              HasSubstr("salt.cif: error: "));
  EXPECT_THAT(error(kSalt, "salt.cif", {.frame = 1}), HasSubstr("no frame 1; the file has 1"));
}

TEST(Cif, OperationsMayHaveDecimals) {
  const auto atoms = [](std::string_view shift) {
    std::string text(kSalt);
    const std::string_view name = "_symmetry_space_group_name_H-M 'F m -3 m'\n";
    text.replace(text.find(name), name.size(),
                 "loop_\n_symmetry_equiv_pos_as_xyz\nx,y,z\n'x,.5+y," + std::string(shift) + "'\n");
    const auto got = read(text, "a.cif", {.style = AtomStyle::space_filling});
    return got ? std::to_string(got->scene.spheres.size()) : got.error().front().text();
  };
  EXPECT_EQ(atoms("0.6667+z"), "4");
  EXPECT_EQ(atoms("z-0.33"), "4");
  EXPECT_THAT(atoms("z+0.11"), HasSubstr("found 'x,.5+y,z+0.11'"));
  EXPECT_THAT(atoms("q"), HasSubstr("expected symmetry operations such as 'x,y,z+1/2'"));
  EXPECT_THAT(atoms("y"), HasSubstr("found 'x,.5+y,y'")) << "a plane";
  std::string text(kSalt);
  const std::string_view number = "_symmetry_space_group_name_H-M 'F m -3 m'\n";
  text.insert(text.find(number) + number.size(), "loop_\n_symmetry_equiv_pos_as_xyz\nx,y,z\n");
  const auto told = read(text, "a.cif");
  ASSERT_TRUE(told) << told.error().front().text();
  EXPECT_TRUE(std::ranges::any_of(told->notices, [](const Diagnostic& notice) {
    return notice.text().contains("differ from those of its space group 'F m -3 m'");
  }));
}

TEST(Cif, MissingAnglesAreRightAngles) {
  const std::string head = "data_a\n_cell_length_a 9\n_cell_length_b 9\n_cell_length_c 9\n";
  const std::string atom =
      "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n"
      "O1 0.1 0.2 0.3\n";
  const auto got = read(head + "_cell_angle_beta ?\n_cell_angle_gamma 90\n" + atom, "a.cif");
  ASSERT_TRUE(got) << got.error().front().text();
  EXPECT_LT(length(got->scene.spheres[0].center - Vec3f(0.9f, 1.8f, 2.7f)), 1e-5f);
  EXPECT_TRUE(std::ranges::any_of(got->notices, [](const Diagnostic& notice) {
    return notice.text().contains(
        "missing angles of the cell, taken as 90 degrees (2: alpha, beta)");
  }));
}

TEST(Cif, WatIsWater) {
  const auto got = read(
      "data_a\n_cell_length_a 9\n_cell_length_b 9\n_cell_length_c 9\n_cell_angle_alpha 90\n"
      "_cell_angle_beta 90\n_cell_angle_gamma 90\nloop_\n_atom_site_label\n_atom_site_fract_x\n"
      "_atom_site_fract_y\n_atom_site_fract_z\nWat1 0.1 0.1 0.1\nW1 0.5 0.5 0.5\n",
      "a.cif");
  ASSERT_TRUE(got) << got.error().front().text();
  const Scene& scene = got->scene;
  EXPECT_EQ(scene.materials[scene.sphere_materials[0]].color, element_color(8));
  EXPECT_EQ(scene.materials[scene.sphere_materials[1]].color, element_color(74));
}

TEST(Cif, InconsistentMatricesAreReported) {
  const auto told = [](std::string_view matrix) {
    const auto got = read(
        "data_a\n_cell.length_a 10\n_cell.length_b 10\n_cell.length_c 10\n_cell.angle_alpha 90\n"
        "_cell.angle_beta 90\n_cell.angle_gamma 90\n" +
            std::string(matrix) +
            "loop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_atom_id\n"
            "_atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.label_seq_id\n"
            "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 C CA ALA A 1 1 2 3\n",
        "a.cif");
    return !got || std::ranges::any_of(got->notices, [](const Diagnostic& notice) {
      return notice.text().contains("fract_transf_matrix disagrees with _cell");
    });
  };
  const auto matrix = [](std::string_view first) {
    std::string out = "_atom_sites.fract_transf_matrix[1][1] " + std::string(first) + "\n";
    for (const std::string_view rest : {"[1][2] 0", "[1][3] 0", "[2][1] 0", "[2][2] 0.1",
                                        "[2][3] 0", "[3][1] 0", "[3][2] 0", "[3][3] 0.1"})
      out += "_atom_sites.fract_transf_matrix" + std::string(rest) + "\n";
    for (const char axis : {'1', '2', '3'})
      out += std::string("_atom_sites.fract_transf_vector[") + axis + "] 0\n";
    return out;
  };
  EXPECT_TRUE(told(matrix("0.09")));
  EXPECT_FALSE(told(matrix("0.1")));
  EXPECT_FALSE(told(""));
}

TEST(Cif, GroupsHaveSeveralNames) {
  const auto atoms = [](std::string_view group, std::string_view gamma = "90") {
    std::string text(kSalt);
    const std::string_view name = "_symmetry_space_group_name_H-M 'F m -3 m'\n";
    text.replace(text.find(name), name.size(), group);
    for (const std::string_view angle : {"alpha 90", "beta 90", "gamma 90"})
      text.replace(text.find(angle) + angle.size() - 2, 2, gamma);
    const auto got = read(text, "a.cif", {.style = AtomStyle::space_filling});
    return got ? std::to_string(got->scene.spheres.size()) : got.error().front().text();
  };
  EXPECT_EQ(atoms("_space_group_IT_number 225\n"), "8");
  EXPECT_EQ(atoms("_space_group_name_Hall '-F 4 2 3'\n"), "8");
  EXPECT_EQ(atoms(""), "2") << "none is told";
  EXPECT_THAT(atoms("_symmetry_space_group_name_H-M 'F x 7'\n"),
              HasSubstr("unknown space group 'F x 7'"));
  // In the cell given by the angles: one position each, not the three of the hexagonal cell.
  EXPECT_EQ(atoms("_symmetry_space_group_name_H-M 'R -3 m'\n", "57"), "2");
  std::string no_cell(kSalt);
  no_cell.erase(no_cell.find("_cell_length_a"), no_cell.find("_symmetry") - no_cell.find("_cell"));
  EXPECT_THAT(error(no_cell, "a.cif"), HasSubstr("fractional coordinates without cell lengths"));
}

// One atom as pairs, next to a loop of the same category, which is not.
TEST(Cif, PairsAndALoopOfOneCategory) {
  const std::string text =
      "data_x\nloop_\n_atom_site.id\n_atom_site.label_seq_id\n1 1\n2 1\n_atom_site.Cartn_x 1\n"
      "_atom_site.Cartn_y 2\n_atom_site.Cartn_z 3\n_atom_site.type_symbol C\n";
  const auto scene = read(text, "a.cif");
  ASSERT_TRUE(scene) << scene.error().front().text();
  ASSERT_EQ(scene->scene.spheres.size(), 1u);
  EXPECT_EQ(scene->scene.spheres[0].center, Vec3f(1, 2, 3));
}

// A side of 1 is valid, unless the file has no cell.
TEST(Cif, CellsMayBeOfSizeOne) {
  const auto with_sides = [](const char* b) {
    return std::string("data_x\n_cell_length_a 1\n_cell_length_b ") + b +
           "\n_cell_length_c 1\nloop_\n_atom_site_label\n_atom_site_fract_x\n"
           "_atom_site_fract_y\n_atom_site_fract_z\nC1 0.25 0.5 0.75\n";
  };
  const auto scene = read(with_sides("2"), "a.cif", {.cell = false});
  ASSERT_TRUE(scene) << scene.error().front().text();
  EXPECT_LT(length(scene->scene.spheres[0].center - Vec3f(0.25f, 1, 0.75f)), 1e-6f);
  EXPECT_THAT(error(with_sides("?"), "a.cif"),
              HasSubstr("fractional coordinates without cell lengths"));
}

TEST(Cif, SitesMustHaveCoordinates) {
  const std::string text =
      "data_x\n_cell_length_a 5\n_cell_length_b 5\n_cell_length_c 5\nloop_\n_atom_site_label\n"
      "_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\nC1 ? ? ?\nO1 . . .\n";
  EXPECT_THAT(error(text, "a.cif"), HasSubstr("none of its atom sites has coordinates"));
}

TEST(Cif, NumbersMayHaveUncertainties) {
  const std::pair<const char*, double> numbers[] = {
      {"1.5", 1.5},      {"+2", 2},           {"-.5", -0.5}, {"5.", 5},
      {"1.23(8)", 1.23}, {"1.5e3(12)", 1500}, {"1e-999", 0}, {"1e999", INFINITY}};
  for (const auto& [text, value] : numbers) EXPECT_EQ(cif::number_of(text), value) << text;
  for (const char* text :
       {"", "?", ".", "-", "inf", "nan", "-inf", "1.5(", "1.5(a)", "1.5 ", "1,5"})
    EXPECT_EQ(cif::number_of(text, 7), 7) << text;
}

}  // namespace
}  // namespace raio::core
