// What files say about their atoms: names, numbers, residues and chains, and selections that name
// picked atoms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "data_files.h"
#include "io/atoms/labels.h"

namespace raio::core {
namespace {

using testing::ElementsAre;

const ReadOptions kWithLabels{.labels = true};

std::shared_ptr<const AtomLabels> labels_of(std::string_view text, std::string_view name,
                                            const ReadOptions& options = kWithLabels) {
  const auto read_file = read(text, name, options);
  EXPECT_TRUE(read_file) << (read_file ? "" : read_file.error().front().text());
  return read_file ? read_file->atoms : std::make_shared<AtomLabels>();
}

// "label; number; index" of every atom.
std::vector<std::string> told(std::string_view text, std::string_view name,
                              const ReadOptions& options = kWithLabels) {
  const auto labels = labels_of(text, name, options);
  std::vector<std::string> out;
  for (uint32_t i = 0; i < labels->atoms; ++i) {
    const auto number = labels->number(i);
    out.push_back(fmt::format("{}; {}; {}", labels->label(i),
                              number ? fmt::format("{}", *number) : "none", labels->index(i)));
  }
  return out;
}

struct PdbAtom {
  int serial;
  std::string name, residue, chain;
  int number;
  char insertion = ' ';
};

std::string pdb_of(const std::vector<PdbAtom>& atoms) {
  std::string out;
  for (size_t i = 0; i < atoms.size(); ++i) {
    const PdbAtom& a = atoms[i];
    out += fmt::format(
        "ATOM  {:<6}{:<4} {:>3} {:>1}{:>4}{}   {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           C  \n",
        fmt::format("{:5}", a.serial), a.name, a.residue, a.chain, a.number, a.insertion,
        3.0 * double(i), 0.0, 0.0);
  }
  return out;
}

TEST(AtomLabels, AreThoseOfTheFormat) {
  EXPECT_THAT(told(pdb_of({{7, " CA", "ALA", "A", 12}, {9, "HD11", "LEU", "B", -3}}), "a.pdb"),
              ElementsAre("C, ALA 12 CA, chain A; 7; 0", "C, LEU -3 HD11, chain B; 9; 1"));
  EXPECT_THAT(told(pdb_of({{7, " CA", "ALA", "A", 12, 'B'}}), "a.pdb"),
              ElementsAre("C, ALA 12B CA, chain A; 7; 0"));
  EXPECT_THAT(told(pdb_of({{100000, " N", "GLY", "", 1}}), "a.pdb"),
              ElementsAre("C, GLY 1 N; 100000; 0"))
      << "a serial of six digits, and no chain";
  EXPECT_THAT(told("ATOM 5 OXT ALA 7 1.0 2.0 3.0 -0.5 1.7\n", "a.pqr"),
              ElementsAre("O, ALA 7 OXT; 5; 0"));
  EXPECT_THAT(told("water\n2\n"
                   "    1SOL     OW99999   0.126   1.624   1.679\n"
                   "100000SOL    HW1    0   0.190   1.661   1.747\n"
                   "   1.86   1.86   1.86\n",
                   "a.gro"),
              ElementsAre("O, SOL 1 OW; 99999; 0", "H, SOL 100000 HW1; 0; 1"))
      << "a wide residue number, and an atom's number that began anew";
  EXPECT_THAT(told(kDump, "a.dump"), ElementsAre("; 1; 0", "; 2; 1"));
  EXPECT_THAT(told("LAMMPS\n\n2 atoms\n1 atom types\n\nMasses\n\n1 55.845 # Fe\n\n"
                   "Atoms # atomic\n\n20 1 0 0 0\n10 1 3 0 0\n",
                   "a.lmp"),
              ElementsAre("Fe; 20; 0", "Fe; 10; 1"));
  EXPECT_THAT(told(kWater, "a.xyz"), ElementsAre("O; none; 0", "H; none; 1", "H; none; 2"));
}

TEST(AtomLabels, OfCifAreItsOwnNames) {
  constexpr std::string_view kLoop =
      "data_a\nloop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.auth_atom_id\n"
      "_atom_site.auth_comp_id\n_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n"
      "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";
  const std::string rows =
      "3 C \"C1'\" DA AAA 5 0 0 0\n"
      "5 H \"HO5''\" DA AAA 5 3 0 0\n"
      "x H LONGNAME DA AAA 5 6 0 0\n"
      "8 H LONGNAME DA B 5 9 0 0\n";
  const auto lines =
      ElementsAre("C, DA 5 C1', chain AAA; 3; 0", "H, DA 5 HO5'', chain AAA; 5; 1",
                  "H, DA 5 LONGNAME, chain AAA; none; 2", "H, DA 5 LONGNAME, chain B; 8; 3");
  EXPECT_THAT(told(std::string(kLoop) + rows, "a.cif"), lines);
  const std::string broken =
      std::string(kLoop) + "3 C \"C1'\" DA AAA 5 0 0\n0\n" + rows.substr(rows.find('\n') + 1);
  EXPECT_THAT(told(broken, "a.cif"), lines) << "values from gemmi";
  EXPECT_EQ(told(kSalt, "salt.cif").front(), "Na, Na1; none; 0");
  EXPECT_THAT(told("data_WAT\nloop_\n_chem_comp_atom.comp_id\n_chem_comp_atom.atom_id\n"
                   "_chem_comp_atom.type_symbol\n_chem_comp_atom.x\n_chem_comp_atom.y\n"
                   "_chem_comp_atom.z\nWAT OW O 0 0 0\nWAT HW1 H 1 0 0\n",
                   "a.cif"),
              ElementsAre("O, OW; none; 0", "H, HW1; none; 1"));
}

TEST(AtomLabels, IndicesAreThoseOfTheFileWhateverIsHidden) {
  ReadOptions options = kWithLabels;
  options.hide = "index 1";
  EXPECT_THAT(told(kWater, "a.xyz", options), ElementsAre("O; none; 0", "H; none; 2"));
  const std::string cell =
      "2\nProperties=species:S:1:pos:R:3 Lattice=\"5 0 0 0 5 0 0 0 5\"\nFe 1 1 1\nO 3 3 3\n";
  options.hide = "element Fe", options.images = {2, 1, 1}, options.style = AtomStyle::sticks;
  EXPECT_THAT(told(cell, "a.xyz", options), ElementsAre("O; none; 1", "O; none; 1"));
  options = kWithLabels, options.cell = true;
  const std::string corner =
      "2\nProperties=species:S:1:pos:R:3 Lattice=\"4 0 0 0 4 0 0 0 4\"\nO 2 2 2\nFe 0 2 2\n";
  EXPECT_THAT(told(corner, "a.xyz", options),
              ElementsAre("O; none; 0", "Fe; none; 1", "Fe; none; 1"))
      << "an atom on a face is repeated on the opposite one";
}

TEST(AtomLabels, ACornerOfTheCellIsNoAtom) {
  ReadOptions options = kWithLabels;
  options.cell = true, options.images = {2, 2, 2}, options.instances = true;
  options.style = AtomStyle::space_filling;
  const auto file =
      read("1\nProperties=pos:R:3 Lattice=\"9 0 0 0 9 0 0 0 9\"\n4 4 4\n", "a.xyz", options);
  ASSERT_TRUE(file);
  ASSERT_FALSE(file->scene.instances.empty());
  ASSERT_FALSE(file->scene.spheres.empty()) << "the ends of the edges";
  EXPECT_EQ(file->atoms->atom(std::nullopt, 0), std::nullopt);
  EXPECT_EQ(file->atoms->atom(0, 0), 0u);
}

// Hiding what a selection names leaves exactly the other atoms.
TEST(AtomLabels, SelectionsNameTheAtomTheResidueAndTheChain) {
  const std::vector<PdbAtom> atoms = {
      {1, " N", "GLY", "A", 1},      {2, " CA", "GLY", "A", 1},      {3, " N", "ALA", "A", 2},
      {4, " N", "SER", "A", 2, 'A'}, {5, " CA", "SER", "A", 2, 'A'}, {6, " N", "GLY", "B", 1},
      {7, " N", "GLY", "", 1},       {8, " CA", "GLY", "", 1},       {9, " N", "GLY", "(", 4},
      {10, " N", "GLY", "B", -7},
  };
  const std::string text = pdb_of(atoms);
  const auto labels = labels_of(text, "a.pdb");
  ASSERT_EQ(labels->atoms, atoms.size());
  const auto expect_hides = [&](const std::string& selection, const auto& is_named) {
    ReadOptions options = kWithLabels;
    options.hide = selection;
    const auto left = labels_of(text, "a.pdb", options);
    std::set<uint32_t> seen, expected;
    for (uint32_t i = 0; i < left->atoms; ++i) seen.insert(left->index(i));
    for (uint32_t i = 0; i < atoms.size(); ++i)
      if (!is_named(atoms[i])) expected.insert(i);
    EXPECT_EQ(seen, expected) << selection;
  };
  for (uint32_t i = 0; i < atoms.size(); ++i) {
    const PdbAtom& own = atoms[i];
    expect_hides(labels->select({i}), [&](const PdbAtom& a) { return a.serial == own.serial; });
    expect_hides(labels->select_chain(i), [&](const PdbAtom& a) { return a.chain == own.chain; });
    expect_hides(labels->select_residue(i), [&](const PdbAtom& a) {
      return a.chain == own.chain && a.number == own.number && a.insertion == own.insertion;
    });
  }
  EXPECT_EQ(labels->select({8, 0, 1, 2, 0}), "index 0-2,8");
  EXPECT_EQ(labels->select_residue(0), "residue 1 and chain A");
  EXPECT_EQ(labels->select_residue(2), "index 2") << "2A has this number, too";
  EXPECT_EQ(labels->select_residue(9), "residue -7 and chain B");
  EXPECT_EQ(labels->select_chain(5), "chain B");
  EXPECT_EQ(labels->select_chain(6), "index 6-7") << "no name";
  const auto salt = labels_of(kSalt, "salt.cif");
  EXPECT_EQ(salt->select_residue(0) + salt->select_chain(0), "") << "a crystal has neither";
}

// A residue that is left out may have the same number, so the number is not enough.
TEST(AtomLabels, SelectionsDoNotNameHiddenAtoms) {
  const std::string text =
      pdb_of({{1, " N", "GLY", "A", 1}, {2, " N", "GLY", "B", 1}, {3, " O", "HOH", "B", 1}});
  ReadOptions options = kWithLabels;
  options.hide = "water";
  const auto labels = labels_of(text, "a.pdb", options);
  EXPECT_EQ(labels->select_residue(1), "index 1");
}

TEST(AtomMarks, KeepAnyNamesAndNumbers) {
  std::mt19937 random(1);
  AtomMarks marks;
  std::vector<std::string> names;
  std::vector<std::optional<uint64_t>> numbers;
  const std::vector<std::string> kNames = {
      "", "C", "CA", "HD11", "HO5''", "\xce\xb1", "\x80\x81\x82\x83", "LONGNAME"};
  uint64_t number = 1;
  for (int i = 0; i < 20'000; ++i) {
    names.push_back(i < 100 ? "" : kNames[random() % kNames.size()]);
    number = random() % 50 == 0 ? random() : number + 1;
    numbers.push_back(random() % 40 == 0 ? std::nullopt : std::optional(number));
    if (i == 7) numbers.back() = UINT32_MAX;
    marks.add(names.back(), numbers.back());
  }
  for (uint32_t i = 0; i < names.size(); ++i) {
    ASSERT_EQ(marks.name(i), names[i]) << i;
    const auto expected = numbers[i] && *numbers[i] < UINT32_MAX ? numbers[i] : std::nullopt;
    ASSERT_EQ(marks.number(i), expected) << i;
  }
  EXPECT_EQ(marks.name(20'000), "");
  EXPECT_EQ(marks.number(20'000), std::nullopt);
  EXPECT_EQ(whole_number(" 12 "), 12u);
  for (const char* other : {"", " ", "12a", "-1", "99999999999999999999"})
    EXPECT_EQ(whole_number(other), std::nullopt) << other;
}

}  // namespace
}  // namespace raio::core
