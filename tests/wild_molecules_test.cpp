// Molecules from programs that violate the formats, and the notices about them. Some files are not
// in the repository; their contents are in their comments.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string wild_text(const std::string& name) {
  const auto path = std::filesystem::path(RAIO_SOURCE_DIR) / "../shared/wild/molecules" / name;
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

// The result of reading a file.
struct Seen {
  std::string elements;  // in their order, as symbols
  std::vector<Vec3f> places;
  std::vector<float> radii;  // of spheres
  size_t bonds = 0;          // cylinders, two where colours differ
  size_t frames = 0;
  std::string notices;  // as lines, or the error
};

Seen see(std::string_view text, const std::string& name, ReadOptions options = {}) {
  Seen out;
  const auto got = parse_scene(text, name, options);
  if (!got) {
    out.notices = got.error().front().text();
    return out;
  }
  const Scene& scene = got->scene;
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    out.places.push_back(scene.spheres[i].center);
    out.radii.push_back(scene.spheres[i].radius);
    const Rgb color = scene.materials[scene.sphere_materials[i]].color;
    for (int element = 0; element < kElements; ++element)
      if (element_color(element) == color) {
        out.elements += fmt::format("{}{}", i ? " " : "", element_symbol(element));
        break;
      }
  }
  out.bonds = scene.cones.size();
  out.frames = got->frames;
  for (const Diagnostic& d : got->notices) out.notices += d.text() + "\n";
  return out;
}

class WildMolecule : public testing::Test {
 protected:
  void SetUp() override {
    if (wild_text("pdb-calcium.pdb").empty()) GTEST_SKIP() << "the files are not there";
  }
  static Seen see_file(const std::string& name, const ReadOptions& options = {}) {
    return see(wild_text(name), name, options);
  }
};

TEST_F(WildMolecule, ElementsComeFromNames) {
  EXPECT_EQ(see_file("pdb-left-aligned.pdb").elements, "N C C C C H H H H O");
  EXPECT_THAT(see_file("pdb-left-aligned.pdb").notices,
              HasSubstr("guessed: elements from names of atoms (10: N, CA, CB, CG, CD, ...)"));
  EXPECT_EQ(see_file("pdb-calcium.pdb").elements, "C Ca");
  EXPECT_EQ(see_file("pdb-deuterium.pdb").elements, "O H H");
  EXPECT_EQ(see_file("pdb-deuterium.pdb").bonds, 4u);
  EXPECT_EQ(see_file("pdb-deuterium-noelem.pdb").elements, "O H H");
  EXPECT_EQ(see_file("pdb-old-hydrogen-names.pdb").elements, "H H H");
  EXPECT_EQ(see_file("pdb-old-columns.pdb").elements, "C C");
  EXPECT_EQ(see_file("pdb-short-lines.pdb").elements, "N C");
  EXPECT_EQ(see_file("pdb-short-lines.pdb").bonds, 2u);
  EXPECT_EQ(see_file("pdb-crlf-bom.pdb").elements, "N C");
  EXPECT_EQ(see_file("pdb-stars.pdb").elements, "O O O");
  EXPECT_EQ(see_file("pdb-anisou-order.pdb").elements, "N O");
  EXPECT_EQ(see_file("pdb-dummy-Q.pdb").elements, "C C N O");
}

TEST_F(WildMolecule, FramesOfPdb) {
  EXPECT_EQ(see_file("pdb-end-frames.pdb").frames, 3u);
  const Seen last = see_file("pdb-end-frames.pdb", {.frame = 2});
  ASSERT_EQ(last.places.size(), 2u);
  EXPECT_EQ(last.places[0], Vec3f(2, 0, 0));
  EXPECT_EQ(see_file("pdb-model-repeats.pdb").frames, 2u);
  EXPECT_THAT(see_file("pdb-model-repeats.pdb", {.frame = 1}).places, ElementsAre(Vec3f(1, 0, 0)));
  for (const auto& [frame, side] : {std::pair(0, 80.f), std::pair(1, 60.f)}) {
    const auto got = parse_scene(wild_text("pdb-cell-per-model.pdb"), "a.pdb",
                                 {.frame = frame, .images = {2, 1, 1}});
    ASSERT_TRUE(got);
    EXPECT_FLOAT_EQ(got->scene.spheres[1].center.x - got->scene.spheres[0].center.x, side);
  }
}

TEST_F(WildMolecule, BondsAndAssembliesOfPdb) {
  EXPECT_EQ(see_file("pdb-conect-hybrid36.pdb").bonds, 2u);
  EXPECT_EQ(see_file("pdb-conect-six-digits.pdb").bonds, 2u);
  EXPECT_EQ(see_file("pdb-conect-many.pdb").bonds, 12u);
  EXPECT_EQ(see_file("pdb-biomt-and-chains.pdb", {.assembly = 1}).places.size(), 6u);
  EXPECT_EQ(see_file("pdb-biomt-and-chains.pdb", {.assembly = 2}).places.size(), 1u);
  EXPECT_EQ(see_file("pdb-negative-insert.pdb").places.size(), 4u);
  // The first conformer, as documented, whatever its occupancy; with a notice.
  const Seen two = see_file("pdb-altloc-second-bigger.pdb");
  EXPECT_THAT(two.places, ElementsAre(Vec3f(0, 0, 0)));
  EXPECT_THAT(two.notices, HasSubstr("left out: atoms of alternate conformers (1: GLY A1)"));
}

TEST_F(WildMolecule, Pqr) {
  const ReadOptions spheres{.style = AtomStyle::space_filling};
  const Seen shifted = see_file("pqr-shifted.pqr", spheres);
  EXPECT_EQ(shifted.elements, "N C H H") << shifted.notices;
  EXPECT_THAT(shifted.places,
              ElementsAre(Vec3f(-0.169f, 7.698f, 13.415f), Vec3f(0.745f, 6.948f, 12.566f),
                          Vec3f(-10.169f, 17.698f, 13.415f), Vec3f(0.169f, 7.698f, 13.415f)));
  EXPECT_THAT(shifted.radii, ElementsAre(1.824f, 1.908f, 0.6f, 1.487f));
  const Seen touching = see_file("pqr-columns.pqr", spheres);
  EXPECT_EQ(touching.elements, "N C H") << touching.notices;
  EXPECT_EQ(touching.places[0], Vec3f(-26.417f, 62.269f, -123.283f));
  EXPECT_THAT(touching.radii, ElementsAre(1.824f, 1.908f, 0.6f));
  // By its first atom, too.
  EXPECT_EQ(see(wild_text("pqr-shifted.pqr"), "a.pdb", spheres).radii, shifted.radii);
  EXPECT_THAT(see(wild_text("pqr-shifted.pqr"), "a.pdb", spheres).notices,
              HasSubstr("guessed: the format PQR"));
}

TEST_F(WildMolecule, Cif) {
  const Seen ligand = see_file("mmcif-components.cif");
  EXPECT_EQ(ligand.elements, "C O");
  EXPECT_THAT(ligand.places, ElementsAre(Vec3f(0, 0, 0), Vec3f(1.2f, 0, 0)));
  EXPECT_EQ(ligand.bonds, 2u);
  EXPECT_EQ(see_file("mmcif-no-type-symbol.cif").elements, "C Ca");
  EXPECT_EQ(see_file("mmcif-quotes.cif").elements, "C O");
  EXPECT_EQ(see_file("mmcif-two-blocks.cif").elements, "C");
  EXPECT_THAT(see_file("mmcif-two-blocks.cif").notices, HasSubstr("(1: two)"));
  EXPECT_EQ(see_file("cif-two-blocks.cif").elements, "C");
  EXPECT_EQ(see_file("cif-dummy.cif").elements, "O");
  EXPECT_THAT(see_file("cif-dummy.cif").notices, HasSubstr("dummy atoms (1: H1)"));
  EXPECT_EQ(see_file("cif-label-only.cif").elements, "C Cu O H");
  EXPECT_EQ(see_file("cif-shared-site.cif").elements, "Al Si");
  EXPECT_THAT(see_file("cif-shared-site.cif").notices, HasSubstr("(1: Fe1)"));
  EXPECT_EQ(see_file("cif-tiny-uncertain.cif").elements, "Mg Mg");
  EXPECT_EQ(see_file("cif-no-symmetry.cif").elements, "C");
  EXPECT_THAT(see_file("cif-no-symmetry.cif").notices, HasSubstr("guessed: no symmetry"));
  EXPECT_EQ(see_file("cif-duplicate-tag.cif").elements, "C");
  EXPECT_THAT(see_file("cif-duplicate-tag.cif").notices,
              HasSubstr("duplicate-tag.cif:3:1: warning: duplicate tags or block names"));
  EXPECT_EQ(see_file("cif-nonascii-comment.cif").elements, "C");
  EXPECT_THAT(see_file("cif-nonascii-comment.cif").notices,
              HasSubstr("unquoted non-ASCII letters"));
}

std::string pdb_atom(std::string_view serial, std::string_view name, std::string_view residue,
                     std::string_view number, double x, std::string_view element = "") {
  return fmt::format("ATOM  {:>5} {:4}{:4} A{:>4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00{:>12}\n",
                     serial, name, residue, number, x, 0.0, 0.0, element);
}

TEST(PdbText, WaterAtTheLeftEdge) {
  const std::string text = pdb_atom("1", "OH2", " TIP", "1", 0) +
                           pdb_atom("2", "H1", " TIP", "1", 1) +
                           pdb_atom("3", "CA", " LIG", "2", 5) + pdb_atom("4", "ZN", " ZN", "3", 9);
  EXPECT_EQ(see(text, "a.pdb").elements, "O H C Zn");
  EXPECT_EQ(see(pdb_atom("1", "QX", " LIG", "2", 5), "a.pdb").notices,
            "a.pdb:1:1: warning: atoms with names that do not determine an element (1: QX)\n");
  EXPECT_EQ(see(pdb_atom("1", "X", " SYS", "1", 0, "X") + pdb_atom("2", "UNK", " UNX", "2", 9, "X"),
                "a.pdb")
                .notices,
            "a.pdb:1:1: warning: atoms with names that do not determine an element (2: X, UNK)\n");
}

TEST(PdbText, ElementsByTheRulesOfPdb) {
  EXPECT_EQ(element_symbol(element_of_names("LIG", "CA", NameField::one_letter)), "C");
  EXPECT_EQ(element_symbol(element_of_names("LIG", "CD", NameField::two_letters)), "Cd");
  EXPECT_EQ(element_symbol(element_of_names("HEM", "FE")), "Fe");
  EXPECT_EQ(element_symbol(element_of_names("SOD", "SOD")), "Na");
  EXPECT_EQ(element_symbol(element_of_names("MSE", "SE")), "Se");
  EXPECT_EQ(element_symbol(element_of_names("HSD", "HE1")), "H");
  EXPECT_EQ(element_symbol(element_of_names("C", "C1'")), "C");
  EXPECT_EQ(element_of_names("ALA", "BB"), 0) << "a bead";
  EXPECT_EQ(element_of_names("ALA", "SC1"), 0) << "a bead";
}

TEST(PdbText, ModelsWithoutEnds) {
  const std::string atom = pdb_atom("1", " O", " HOH", "1", 0, "O"),
                    other = pdb_atom("1", " O", " HOH", "1", 2, "O");
  const Seen got = see("MODEL        1\n" + atom + "MODEL        2\n" + other + "ENDMDL\nEND\n",
                       "a.pdb", {.frame = 1});
  EXPECT_EQ(got.frames, 2u);
  EXPECT_THAT(got.places, ElementsAre(Vec3f(2, 0, 0)));
  EXPECT_EQ(see("MODEL        1\nENDMDL\nMODEL        2\n" + atom + "ENDMDL\n", "a.pdb").notices,
            "a.pdb: error: frame 0 has no atoms; the file has 2 frames");
  EXPECT_THAT(see("HEADER    nothing\nEND\n", "a.pdb").notices, HasSubstr("the file has no atoms"));
}

TEST(PdbText, NumbersInHexadecimal) {
  const std::string text =
      pdb_atom("1869f", " C", " UNL", "1", 0, "C") + pdb_atom("186a0", " C", " UNL", "1", 5, "C");
  EXPECT_EQ(see(text + "CONECT1869f186a0\n", "a.pdb").bonds, 1u);
  EXPECT_THAT(see(text + "CONECT1869f    7\n", "a.pdb").notices,
              HasSubstr("CONECT bonds to atoms that do not exist (1)"));
}

TEST(PdbText, SecondResiduesAtOneNumber) {
  const std::string microhet =
      pdb_atom("1", " CA", " SER", "22", 0, "C") + pdb_atom("2", " OG", " SER", "22", 2, "O") +
      pdb_atom("3", " CA", " PRO", "22", 0.2, "C") + pdb_atom("4", " CD", " PRO", "22", 2.5, "C");
  const Seen got = see(microhet, "a.pdb");
  EXPECT_EQ(got.elements, "C O");
  EXPECT_THAT(got.notices,
              HasSubstr("residues with the number and position of another (1: PRO A22)"));
  // Equal numbers carry no information.
  std::string alike = microhet;
  alike.replace(alike.rfind("   0.200"), 8, "   9.000");
  EXPECT_EQ(see(alike, "a.pdb").elements, "C O C C");
  EXPECT_THAT(
      see(pdb_atom("1", " C", " UNL", "1", 0, "C") + pdb_atom("2", " C", " UNL", "2", 0, "C"),
          "a.pdb")
          .notices,
      HasSubstr("warning: atoms at the same position as another (1: C UNL A2)"));
}

TEST(PdbText, ShiftedColumnsAreRefused) {
  std::string text = pdb_atom("1", " C", " UNL", "1", -0.169, "C");
  text.insert(26, "   ");
  EXPECT_THAT(see(text, "a.pdb").notices,
              HasSubstr("a.pdb:1:36: error: expected a coordinate within columns 31 to 38"));
  std::string blank = pdb_atom("1", " C", " UNL", "1", 12.345, "C");
  blank.replace(32, 6, "12 345");
  EXPECT_THAT(see(blank, "a.pdb").notices, HasSubstr("a.pdb:1:33: error: expected a coordinate"));
  std::string stars = pdb_atom("1", " C", " UNL", "1", 1, "C");
  stars.replace(30, 8, "********");
  const Seen got = see(pdb_atom("1", " C", " UNL", "1", 1, "C") + stars, "a.pdb");
  EXPECT_EQ(got.elements, "C");
  EXPECT_THAT(got.notices, HasSubstr("atoms with coordinates that are not numbers (1: C)"));
  EXPECT_THAT(see(stars.substr(0, 50), "a.pdb").notices,
              HasSubstr("expected three coordinates in columns 31 to 54, found the end"));
}

TEST(PdbText, ScaleMayDisagree) {
  const std::string cell =
      "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n";
  const std::string scale =
      "SCALE1      0.050000  0.000000  0.000000        0.00000\n"
      "SCALE2      0.000000  0.050000  0.000000        0.00000\n"
      "SCALE3      0.000000  0.000000  0.033333        0.00000\n";
  const std::string atom = pdb_atom("1", " C", " UNL", "1", 1, "C");
  EXPECT_THAT(see(cell + atom, "a.pdb").notices, IsEmpty());
  const Seen got = see(cell + scale + atom, "a.pdb", {.images = {2, 1, 1}});
  EXPECT_THAT(got.notices, HasSubstr("SCALE records disagree with CRYST1"));
  EXPECT_FLOAT_EQ(got.places[1].x, 21);
}

TEST(PqrText, ChainsAndColumns) {
  const std::string text =
      "ATOM 1 N ALA A 1 1.0 2.0 3.0 -0.3 1.5\nATOM 2 HN ALA A 1 1.0 3.0 3.0 0.3 0.0\n";
  const Seen got = see(text, "a.pqr", {.style = AtomStyle::space_filling});
  EXPECT_EQ(got.elements, "N H");
  EXPECT_THAT(got.radii, ElementsAre(1.5f, van_der_waals_radius(1)));
  EXPECT_THAT(got.notices, HasSubstr("van der Waals radii of atoms with a radius of 0 (1: HN)"));
  EXPECT_TRUE(parse_scene(text, "a.pqr", {.color_by = "charge"}));
  EXPECT_TRUE(parse_scene(text, "a.pqr", {.color_by = "chain"}));
  EXPECT_THAT(see("ATOM 1 N ALA A 1 1.0 2.0\n", "a.pqr").notices,
              HasSubstr("a.pqr:1:1: error: expected a PQR line"));
}

constexpr std::string_view kSmallCell =
    "data_x\n_cell_length_a 5\n_cell_length_b 5\n_cell_length_c 5\n_cell_angle_alpha 90\n"
    "_cell_angle_beta 90\n_cell_angle_gamma 90\n_space_group_name_H-M_alt 'P 1'\nloop_\n"
    "_atom_site_label\n_atom_site_type_symbol\n_atom_site_fract_x\n_atom_site_fract_y\n"
    "_atom_site_fract_z\n_atom_site_disorder_group\n";

TEST(CifText, LabelsStandForSymbols) {
  const Seen got = see(std::string(kSmallCell) +
                           "S1 ? 0 0 0 .\nP1 . 0.5 0 0 .\nOa1 ? 0 0.5 0 .\nOw . 0 0 0.5 .\n"
                           "Hw ? 0.5 0.5 0 .\nOc ? 0.5 0 0.5 .\nC9 C 0.1 0.1 0.1 2\n",
                       "a.cif");
  EXPECT_EQ(got.elements, "S P O O H O") << got.notices;
  EXPECT_THAT(got.notices, HasSubstr("disorder groups (1: C9)"));
}

TEST(CifText, TypesOfFiles) {
  EXPECT_THAT(see("data_r\nloop_\n_refln_index_h\n_refln_index_k\n1 2\n", "a.cif").notices,
              HasSubstr("has reflections but no atoms"));
  EXPECT_THAT(see("data_r\n_struct.title x\n", "a.cif").notices, HasSubstr("has no atoms"));
  EXPECT_THAT(see("data_r\nloop_\n_a\n'x\n", "a.cif").notices, HasSubstr("a.cif:4:"));
}

}  // namespace
}  // namespace raio::core
