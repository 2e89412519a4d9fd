// The selections `only`, `hide` and `show`.
#include "io/atoms/select.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Row {
  std::string_view name, residue, chain;
  int number = 0;
  std::string_view element;
};

// Ten angstroms apart, so that an atom's number is a tenth of its x.
constexpr std::array kRows = {
    Row{"CA", "ALA", "A", 1, "C"},  Row{"HA", "ALA", "A", 1, "H"},   // 0 1
    Row{"SG", "CSD", "A", 2, "S"},  Row{"CA", "GLY", "A", 3, "C"},   // 2 3
    Row{"P", "DA", "B", 1, "P"},    Row{"FE", "HEM", "B", 5, "FE"},  // 4 5
    Row{"NA", "HEM", "B", 5, "N"},  Row{"NA", "NA", "A", 7, "NA"},   // 6 7
    Row{"CL", "CL", "A", 8, "CL"},  Row{"O", "HOH", "A", 101, "O"},  // 8 9
    Row{"O", "HOH", "B", 102, "O"},                                  // 10
};

std::string pdb() {
  std::string out;
  for (size_t i = 0; i < kRows.size(); ++i) {
    const Row& row = kRows[i];
    out += fmt::format(
        "HETATM{:>5} {:<4} {:>3} {}{:>4}    {:>8.3f}{:>8.3f}{:>8.3f}  1.00  0.00          {:>2}\n",
        i + 1,
        row.name.size() < 4 && row.element.size() == 1 ? fmt::format(" {}", row.name) : row.name,
        row.residue, row.chain, row.number, 10.0 * double(i), 0.0, 0.0, row.element);
  }
  return out;
}

std::string cif() {
  std::string out = "data_x\nloop_\n";
  for (const char* tag : {"id", "type_symbol", "auth_atom_id", "label_alt_id", "auth_comp_id",
                          "auth_asym_id", "auth_seq_id", "Cartn_x", "Cartn_y", "Cartn_z"})
    out += fmt::format("_atom_site.{}\n", tag);
  for (size_t i = 0; i < kRows.size(); ++i)
    out += fmt::format("{} {} {} . {} {} {} {} 0 0\n", i + 1, kRows[i].element, kRows[i].name,
                       kRows[i].residue, kRows[i].chain, kRows[i].number, 10 * i);
  return out;
}

std::string gro() {
  std::string out = fmt::format("rows\n{}\n", kRows.size());
  for (size_t i = 0; i < kRows.size(); ++i)
    out += fmt::format("{:>5}{:<5}{:>5}{:>5}{:>8.3f}{:>8.3f}{:>8.3f}\n", kRows[i].number,
                       kRows[i].residue, kRows[i].name, i + 1, double(i), 0.0, 0.0);
  return out + "20 20 20\n";
}

std::vector<int> numbers(const std::expected<ReadScene, Diagnostics>& read) {
  if (!read) ADD_FAILURE() << read.error().front().text();
  std::vector<int> out;
  for (size_t i = 0; read && i < read->scene.spheres.size(); ++i)
    out.push_back(int(std::lround(read->scene.spheres[i].center.x / 10)));
  return out;
}

std::vector<int> only(const std::string& selection, const std::string& text, const char* name) {
  return numbers(read(text, name, {.style = AtomStyle::space_filling, .only = selection}));
}
std::vector<int> only(const std::string& selection) { return only(selection, pdb(), "a.pdb"); }

std::string notices(const std::expected<ReadScene, Diagnostics>& read) {
  std::string out;
  for (const Diagnostic& d : read ? read->notices : read.error()) out += d.text() + '\n';
  return out;
}

TEST(Select, EveryWordHasItsAtoms) {
  EXPECT_THAT(only("water"), ElementsAre(9, 10));
  EXPECT_THAT(only("hydrogen"), ElementsAre(1));
  EXPECT_THAT(only("ion"), ElementsAre(7, 8));
  EXPECT_THAT(only("ligand"), ElementsAre(5, 6));
  EXPECT_THAT(only("protein"), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(only("nucleic"), ElementsAre(4));
  EXPECT_EQ(only("all").size(), kRows.size());
  EXPECT_THAT(only("element fe,S"), ElementsAre(2, 5));
  EXPECT_THAT(only("chain B"), ElementsAre(4, 5, 6, 10));
  EXPECT_THAT(only("residue ala, 3"), ElementsAre(0, 1, 3));
  EXPECT_THAT(only("residue 100-101,5-8"), ElementsAre(5, 6, 7, 8, 9));
  EXPECT_THAT(only("index 2-3,8"), ElementsAre(2, 3, 8));
}

TEST(Select, WordsJoin) {
  EXPECT_THAT(only("protein and not hydrogen"), ElementsAre(0, 2, 3));
  EXPECT_THAT(only("water and chain B or ion and chain A"), ElementsAre(7, 8, 10));
  EXPECT_THAT(only("(water or ion) and chain A"), ElementsAre(7, 8, 9));
  EXPECT_THAT(only("not (protein, water)"), ElementsAre(4, 5, 6, 7, 8));
  EXPECT_THAT(only("not not element P"), ElementsAre(4));
  // After a list of values a comma continues it, so words are joined by `or`.
  EXPECT_THAT(only("chain A,B and water"), ElementsAre(9, 10));
  EXPECT_THAT(only("index 1 or water"), ElementsAre(1, 9, 10));
}

TEST(Select, FormatsAgree) {
  for (const char* selection :
       {"water", "ion", "ligand", "protein", "nucleic", "residue 1", "residue hem", "hydrogen"}) {
    const std::vector<int> expected = only(selection);
    EXPECT_EQ(only(selection, cif(), "a.cif"), expected) << selection;
    EXPECT_EQ(only(selection, gro(), "a.gro"), expected) << selection;
  }
}

TEST(Select, HideAndShow) {
  const auto with = [](ReadOptions options) {
    options.style = AtomStyle::space_filling;
    return numbers(read(pdb(), "a.pdb", options));
  };
  EXPECT_THAT(with({.hide = "water or nucleic or ligand"}), ElementsAre(0, 1, 2, 3, 7, 8));
  EXPECT_THAT(with({.only = "protein or water", .hide = "hydrogen or water", .show = "index 9"}),
              ElementsAre(0, 2, 3, 9));
}

TEST(Select, WaterAndIonsHideNoProtein) {
  ReadOptions options = kForPictures;
  options.style = AtomStyle::space_filling;
  auto got = read(pdb(), "a.pdb", options);
  EXPECT_THAT(numbers(got), ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_THAT(notices(got),
              HasSubstr("left out: atoms of water and ions; show \"water, ion\" draws them (4)"));
  options.show = "water";
  got = read(pdb(), "a.pdb", options);
  EXPECT_THAT(numbers(got), ElementsAre(0, 1, 2, 3, 4, 5, 6, 9, 10));
  EXPECT_THAT(notices(got), HasSubstr("draws them (2)"));
  options.show = "", options.hide = "water";
  EXPECT_THAT(notices(read(pdb(), "a.pdb", options)), HasSubstr("draws them (2)"));
  // In ball-and-stick they are visible, and a water-only file has nothing else to show.
  options.hide = "", options.style = AtomStyle::ball_and_stick;
  EXPECT_EQ(numbers(read(pdb(), "a.pdb", options)).size(), kRows.size());
  options.style = AtomStyle::space_filling;
  const std::string text = pdb();
  EXPECT_THAT(numbers(read(text.substr(text.find("HETATM   10")), "a.pdb", options)),
              ElementsAre(9, 10));
}

TEST(Select, BondsGoWithTheirAtoms) {
  const auto bonds = [](const std::string& selection) {
    return read(kData, "a.data", {.style = AtomStyle::ball_and_stick, .only = selection})
        ->scene.cones.size();
  };
  EXPECT_EQ(bonds("index 0-1"), 2u);  // halves of different colours
  EXPECT_EQ(bonds("type 2"), 0u);
}

size_t spheres(std::string_view text, const char* name, const std::string& selection) {
  return read(text, name, {.style = AtomStyle::space_filling, .only = selection})
      ->scene.spheres.size();
}

TEST(Select, TypesAndMolecules) {
  EXPECT_EQ(spheres(kData, "a.data", "type 2"), 2u);
  EXPECT_EQ(spheres(kData, "a.data", "residue 1"), 3u);
  EXPECT_EQ(spheres(kDump, "a.dump", "type 1"), 1u);
  EXPECT_EQ(spheres(kWater, "a.xyz", "hydrogen"), 2u);
}

TEST(Select, TypesByTheNamesThatLammpsGivesThem) {
  std::string text = "names\n\n2 atoms\n2 atom types\n0 9 xlo xhi\n0 9 ylo yhi\n0 9 zlo zhi\n\n";
  const std::string rows = "Atoms # atomic\n\n1 1 1 1 1\n2 2 4 4 4\n";
  const std::string named = text + "Atom Type Labels\n\n1 head\n2 tail\n\n" + rows;
  EXPECT_EQ(spheres(named, "a.lmp", "type tail"), 1u);
  EXPECT_EQ(spheres(named, "a.lmp", "type head,2"), 2u);
  EXPECT_THAT(error(named, "a.lmp", {.only = "type feet"}),
              HasSubstr("only names type feet; the file has head, tail"));
  EXPECT_THAT(error(text + rows, "a.lmp", {.only = "type head"}),
              HasSubstr("only needs names of types, but the file has none"));
  const auto got = read(named, "a.lmp", {.only = "type tail"});
  ASSERT_TRUE(got && got->legend.size() == 1);
  EXPECT_EQ(got->legend[0].name, "tail");
}

TEST(Select, IndexColorsAreThoseOfTheFile) {
  const auto got = read(pdb(), "a.pdb", {.color_by = "index", .only = "index 3-5"});
  ASSERT_TRUE(got && got->colors);
  EXPECT_EQ(got->colors->least, 3.0);
  EXPECT_EQ(got->colors->most, 5.0);
}

TEST(Select, ColoursOfSelectionsReplaceOthers) {
  const Rgb red(1, 0, 0), blue(0, 0, 1);
  const ReadOptions options{
      .color_by = "chain",
      .color_atoms = {{"index 0-4", red, "red"}, {"index 2", blue, "blue"}, {"index 0", blue, ""}},
      .only = "not index 0"};
  const auto got = read(pdb(), "a.pdb", options);
  ASSERT_TRUE(got);
  const Scene& s = got->scene;
  const auto color = [&](size_t sphere) { return s.materials[s.sphere_materials[sphere]].color; };
  EXPECT_EQ(color(0), red);
  EXPECT_EQ(color(1), blue) << "the last one counts; atom 2 is the second that is drawn";
  EXPECT_EQ(color(2), red);
  EXPECT_EQ(color(4), distinct_color(1)) << "chain B";
  std::vector<std::string> names;
  for (const LegendEntry& entry : got->legend) names.push_back(entry.name);
  EXPECT_THAT(names, testing::ElementsAre("chain A", "chain B", "index 0-4", "index 2"))
      << "an atom that is not drawn has no entry";
  const auto mapped =
      read(pdb(), "a.pdb", {.color_by = "index", .color_atoms = {{"index 1", red, "red"}}});
  ASSERT_TRUE(mapped && mapped->colors);
  EXPECT_EQ(mapped->scene.materials[mapped->scene.sphere_materials[1]].color, red);
  EXPECT_EQ(mapped->legend.size(), 1u);
  // Those without atoms, those of hidden ones, and those that later ones replace.
  EXPECT_THAT(notices(read(pdb(), "a.pdb",
                           {.color_atoms = {{"index 50", red, "red"},
                                            {"index 0", red, "red"},
                                            {"index 1", red, "red"},
                                            {"index 1-2", blue, "blue"}},
                            .hide = "index 0"})),
              HasSubstr("selections of color-atoms that colour no atom (3: index 50, index 0, "));
  const auto all = read(pdb(), "a.pdb",
                        {.color_by = "index", .color_atoms = {{"all", red, std::string(99, 'x')}}});
  EXPECT_FALSE(all->colors) << "no atom has a colour of the scale";
  EXPECT_EQ(all->scene.materials.size(), 1u);
  EXPECT_THAT(error(kWater, "a.xyz", {.color_atoms = {{"chain A", red, "red"}}}),
              HasSubstr("color-atoms needs chains"));
  EXPECT_THAT(error(kMesh, "a.ply", {.color_atoms = {{"all", red, "red"}}}),
              HasSubstr("color-atoms has no effect"));
}

TEST(Select, TheCameraDoesNotDependOnColours) {
  const auto camera = [](const ReadOptions& options) {
    const auto got = read("5\n\nC 0 0 0\nC 1.4 0.3 0\nC 2.5 -0.5 0.6\nC 3.6 0.5 0.2\nC 4.9 0 1\n",
                          "a.xyz", options);
    EXPECT_GE(got->scene.cones.size(), 4u);
    return got->scene.camera;
  };
  const Camera usual = camera({.style = AtomStyle::sticks});
  for (const char* atoms : {"index 0-1", "index 2-3", "all"}) {
    const Camera other =
        camera({.style = AtomStyle::sticks, .color_atoms = {{atoms, Rgb(1, 0, 0), "red"}}});
    EXPECT_EQ(other.from, usual.from) << atoms;
    EXPECT_EQ(other.up, usual.up) << atoms;
  }
  EXPECT_EQ(camera({.style = AtomStyle::sticks, .color_by = "index"}).from, usual.from);
}

TEST(Select, MissingProperties) {
  const auto wrong = [](std::string_view text, const char* name, const std::string& selection) {
    return error(text, name, {.only = selection});
  };
  EXPECT_THAT(wrong(kWater, "a.xyz", "water"),
              HasSubstr("only needs names of residues, but the file has none"));
  EXPECT_THAT(wrong(kWater, "a.xyz", "chain A"), HasSubstr("only needs chains"));
  EXPECT_THAT(wrong(kWater, "a.xyz", "residue 1"), HasSubstr("only needs residues"));
  EXPECT_THAT(wrong(pdb(), "a.pdb", "type 1"), HasSubstr("only needs types"));
  EXPECT_THAT(wrong(kData, "a.data", "residue ALA"), HasSubstr("only needs names of residues"));
  EXPECT_THAT(wrong(pdb(), "a.pdb", "chain C"), HasSubstr("only names chain C; the file has A, B"));
  EXPECT_THAT(wrong(pdb(), "a.pdb", "index 50"), HasSubstr("only and hide leave no atom"));
  EXPECT_THAT(notices(read(pdb(), "a.pdb", {.hide = "index 50"})),
              HasSubstr("hide chooses no atom"));
}

TEST(Select, InvalidSelections) {
  EXPECT_EQ(selection_problem("not (water, chain A-B,C and residue ALA,1-5)"), "");
  EXPECT_THAT(selection_problem(""), HasSubstr("column 1: expected water"));
  EXPECT_THAT(selection_problem("watr"), HasSubstr("column 1: expected water"));
  EXPECT_THAT(selection_problem("watr"), HasSubstr("found 'watr'"));
  EXPECT_EQ(selection_problem("water ion"),
            "column 7: expected 'and', 'or' or the end, found 'ion'");
  EXPECT_EQ(selection_problem("(water"), "column 7: expected ')', found the end");
  EXPECT_EQ(selection_problem("chain"), "column 6: expected a value, found the end");
  EXPECT_EQ(selection_problem("element Xx"),
            "column 9: expected the symbol of an element, found 'Xx'");
  EXPECT_EQ(selection_problem("index A"),
            "column 7: expected a number or a range such as 1-5, found 'A'");
  EXPECT_THAT(selection_problem("index 5-1"), HasSubstr("that begins with its lower number"));
  EXPECT_THAT(selection_problem(std::string(5000, '(')), HasSubstr("fewer parentheses"));
  EXPECT_THAT(selection_problem("index 99999999999"), HasSubstr("expected a number"));
}

TEST(Select, KindsOfResidues) {
  for (const char* name : {"ALA", "HSD", "NALA", "MSE", "HYP", "TPO"})
    EXPECT_EQ(residue_kind(name), ResidueKind::protein) << name;
  for (const char* name : {"A", "DG", "PSU"})
    EXPECT_EQ(residue_kind(name), ResidueKind::nucleic) << name;
  for (const char* name : {"HOH", "SOL", "TIP3", "WAT"})
    EXPECT_EQ(residue_kind(name), ResidueKind::water) << name;
  for (const char* name : {"", "HEM", "ATP", "NA", "POPC", "\xff\xff\xff"})
    EXPECT_EQ(residue_kind(name), ResidueKind::other) << name;
}

}  // namespace
}  // namespace raio::core
