// Rows of _atom_site in mmCIF, read from text lines and through gemmi.
#include "io/atoms/atom_site.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "data_files.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Everything that is read.
std::string seen(std::string_view text, bool cuts_rows, int frame,
                 const std::array<double, 3>& origin) {
  Atoms atoms;
  atoms.origin = origin;
  if (const auto fault = read_structure(text.data(), text.size(), frame, atoms, cuts_rows))
    return fmt::format("{}:{}: {}", fault->line, fault->column, fault->message);
  std::string out = fmt::format("{} frames\n", atoms.frames);
  for (const Atom& a : atoms.atoms)
    out += fmt::format("{} {} {} element {} chain {} part {} residue {} {} {}\n", a.place[0],
                       a.place[1], a.place[2], a.element, a.chain, a.part, a.residue, a.occupancy,
                       a.b_factor);
  for (const std::string& chain : atoms.chains) out += "chain " + chain + '\n';
  for (const Residue& r : atoms.residues) out += fmt::format("residue {} {}\n", r.view(), r.number);
  for (const auto& [a, b] : atoms.bonds) out += fmt::format("bond {} {}\n", a, b);
  if (atoms.cell)
    for (const auto& side : atoms.cell->sides)
      out += fmt::format("side {} {} {}\n", side[0], side[1], side[2]);
  for (const Assembly& assembly : atoms.assemblies)
    for (const auto& copies : assembly.copies)
      out += fmt::format("{} copies of {} parts\n", copies.matrices.size(), copies.parts.size());
  out += fmt::format("{} {} {}\n", atoms.finds_bonds, atoms.has_residues, atoms.has_b_factors);
  for (const Notice& n : atoms.notices.list()) {
    out += fmt::format("notice {} {} {} {}", int(n.severity), n.message, n.count, n.line);
    for (const std::string& name : n.names) out += ' ' + name;
    out += '\n';
  }
  return out;
}
std::string seen(std::string_view text) { return seen(text, true, 0, {}); }

void expect_same(std::string_view text) {
  for (const int frame : {0, 1, -1})
    EXPECT_EQ(seen(text, true, frame, {}), seen(text, false, frame, {})) << text.substr(0, 3000);
  EXPECT_EQ(seen(text, true, 0, {10, 20, -30}), seen(text, false, 0, {10, 20, -30}));
}

constexpr std::string_view kTags =
    "loop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
    "_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n"
    "_atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.pdbx_PDB_ins_code\n"
    "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n_atom_site.occupancy\n"
    "_atom_site.B_iso_or_equiv\n_atom_site.pdbx_formal_charge\n_atom_site.auth_seq_id\n"
    "_atom_site.auth_asym_id\n_atom_site.pdbx_PDB_model_num\n";

// Two models and two chains with interleaved residues, alternates, an insertion and two residues
// with one number.
std::vector<std::string> rows() {
  struct Row {
    const char *symbol, *name, *conformer, *residue, *chain, *number, *code, *model;
  };
  std::vector<std::string> out;
  for (const Row& r : {Row{"N", "N", ".", "ALA", "A", "1", "?", "1"},
                       Row{"C", "CA", ".", "ALA", "A", "1", "?", "1"},
                       Row{"C", "CB", "A", "ALA", "A", "1", "?", "1"},
                       Row{"C", "CB", "B", "ALA", "A", "1", "?", "1"},
                       Row{"S", "SG", "A", "CYS", "A", "2", "?", "1"},
                       Row{"O", "OG", "B", "SER", "A", "2", "?", "1"},
                       Row{"S", "SG", "A", "CYS", "A", "2", "?", "1"},
                       Row{"C", "CA", ".", "GLY", "A", "2", "A", "1"},
                       Row{"S", "SG", ".", "CYS", "B", "1", "?", "1"},
                       Row{"O", "\"O5'\"", ".", "' A'", "B", ".", "?", "1"},
                       Row{"O", "O", ".", "HOH", "A", ".", "?", "1"},
                       Row{"N", "N", ".", "ALA", "A", "1", "?", "2"},
                       Row{"?", "CA", ".", "CA", "A", "1", "?", "2"},
                       Row{"C", "CA", ".", "ALA", "B", "1", "?", "2"}}) {
    const size_t i = out.size() + 1;
    const std::string_view author_number = r.number[0] == '.' ? "7" : r.number;
    out.push_back(fmt::format(
        "ATOM   {:<4} {} {:<4} {} {} {} {} {} {:<8.3f} {:<8.3f} -1.5 1.00 20.50 ? {:<4} {} {} ", i,
        r.symbol, r.name, r.conformer, r.residue, r.chain, r.number, r.code, double(i),
        double(i % 3), author_number, r.chain, r.model));
  }
  return out;
}

std::string file_of(const std::vector<std::string>& rows, std::string_view behind = "#\n") {
  std::string out =
      "data_test\n_struct.title\n;\nloop_\n_atom_site.id\n1\n;\n_cell.length_a 30\n"
      "_cell.length_b 31\n_cell.length_c 32\n_cell.angle_alpha 90\n_cell.angle_beta 90\n"
      "_cell.angle_gamma 90\n#\n";
  out += kTags;
  for (const std::string& row : rows) out += row + '\n';
  return out.append(behind);
}

std::string with_line_ends(std::string_view text, std::string_view end) {
  std::string out;
  for (const char c : text) c == '\n' ? out.append(end) : out += c;
  return out;
}

constexpr std::string_view kLinks =
    "loop_\n_struct_conn.id\n_struct_conn.conn_type_id\n_struct_conn.ptnr1_label_asym_id\n"
    "_struct_conn.ptnr2_label_asym_id\n_struct_conn.ptnr1_label_comp_id\n"
    "_struct_conn.ptnr2_label_comp_id\n_struct_conn.ptnr1_label_atom_id\n"
    "_struct_conn.ptnr2_label_atom_id\n_struct_conn.ptnr1_label_seq_id\n"
    "_struct_conn.ptnr2_label_seq_id\n_struct_conn.pdbx_ptnr1_label_alt_id\n1 disulf A B CYS CYS "
    "SG SG 2 1 A\n";
constexpr std::string_view kAuthLinks =
    "loop_\n_struct_conn.id\n_struct_conn.conn_type_id\n_struct_conn.ptnr1_auth_asym_id\n"
    "_struct_conn.ptnr2_auth_asym_id\n_struct_conn.ptnr1_label_comp_id\n"
    "_struct_conn.ptnr2_label_comp_id\n_struct_conn.ptnr1_label_atom_id\n"
    "_struct_conn.ptnr2_label_atom_id\n_struct_conn.ptnr1_auth_seq_id\n"
    "_struct_conn.ptnr2_auth_seq_id\n_struct_conn.pdbx_ptnr1_label_alt_id\n"
    "1 disulf A B CYS CYS SG SG 2 1 A\n2 covale A A ALA SER CB OG 1 2 A\n";

TEST(AtomSite, ResiduesAreGatheredAndTheFirstAlternatesTaken) {
  const std::string all = seen(file_of(rows(), kLinks));
  EXPECT_THAT(all, StartsWith("2 frames\n1 1 -1.5 element 7 chain 0 part 0 residue 0 1 20.5\n"
                              "2 2 -1.5 element 6 chain 0 part 0 residue 0 1 20.5\n"
                              "3 0 -1.5 element 6 chain 0 part 0 residue 0 1 20.5\n"
                              "5 2 -1.5 element 16 chain 0 part 0 residue 1 1 20.5\n"
                              "7 1 -1.5 element 16 chain 0 part 0 residue 1 1 20.5\n"
                              "8 2 -1.5 element 6 chain 0 part 0 residue 2 1 20.5\n"
                              "9 0 -1.5 element 16 chain 1 part 1 residue 3 1 20.5\n"
                              "10 1 -1.5 element 8 chain 1 part 1 residue 4 1 20.5\n"
                              "11 2 -1.5 element 8 chain 0 part 0 residue 5 1 20.5\n"
                              "chain A\nchain B\nresidue ALA 1\nresidue CYS 2\nresidue GLY 2\n"
                              "residue CYS 1\nresidue A 7\nresidue HOH 7\nbond 3 6\n"));
  EXPECT_THAT(all, HasSubstr("atoms of alternate conformers 1 0 ALA A1\n"));
  EXPECT_THAT(all, HasSubstr("residues with the number and position of another 1 0 SER A2\n"));
  EXPECT_THAT(seen(file_of(rows(), kAuthLinks)), HasSubstr("residue HOH 7\nbond 3 6\nside"));
}

TEST(AtomSite, LinesGiveTheSameAsGemmisRows) {
  for (const char* folder : {RAIO_SOURCE_DIR "/tests/files", RAIO_SOURCE_DIR "/scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() != ".cif") continue;
      std::ifstream in(entry.path(), std::ios::binary);
      expect_same(std::string(std::istreambuf_iterator<char>(in), {}));
    }
  for (const std::string_view behind :
       {"", "#\n", "\n", "stop_\n", "_x.y 1\n", "_x.y\n", "loop_\n_x.y\n1\n",
        "save_x\n_x.y 1\nsave_\n", "data_second\n_atom_site.Cartn_x 1\n", "data_test\n_x.y 1\n",
        "_cell.length_a 1\n", "'a\n", ";\n", "1 2 3\n", "_x.y \xc3\xa9\n",
        "loop_\n_atom_site.Cartn_x\n1\n2\n"}) {
    expect_same(file_of(rows(), behind));
    std::string text = file_of(rows(), behind);
    while (text.ends_with('\n')) text.pop_back();
    expect_same(text);
    expect_same(with_line_ends(text, "\r\n"));
    expect_same(with_line_ends(text, "\r"));
  }
  for (const std::string_view links : {kLinks, kAuthLinks}) {
    expect_same(file_of(rows(), links));
    expect_same(std::string("data_a\n").append(links) + file_of(rows()).substr(10));
  }
  for (const std::string_view text :
       {"", "\n", "data_", "loop_", "data_a\nloop_\n", "data_a\nloop_\n_atom_site."})
    expect_same(text);
  expect_same("data_a\nsave_b\n" + file_of(rows()).substr(10) + "save_\n");
  expect_same(
      "data_a\nloop_\n_chem_comp_atom.atom_id\n_chem_comp_atom.x\n_chem_comp_atom.y\n"
      "_chem_comp_atom.z\nC 1 2 3\n" +
      file_of(rows()));
  for (const std::string_view tag :
       {"id", "type_symbol", "Cartn_x", "Cartn_z", "label_comp_id", "auth_seq_id"})
    for (const std::string_view instead :
         {"_atom_site.other", "_atom_site.LABEL_ATOM_ID", "_other.tag", "other",
          "_atom_site.id # of the row", "_atom_site.label_seq_id"}) {
      std::string text = file_of(rows());
      const std::string full = "_atom_site." + std::string(tag) + "\n";
      expect_same(text.replace(text.rfind(full), full.size() - 1, instead));
    }
}

TEST(AtomSite, OddRowsGiveTheSameAsGemmisRows) {
  const std::vector<std::string> plain = rows();
  const auto with = [](std::string row, std::string_view word, std::string_view instead) {
    return row.replace(row.find(word), word.size(), instead);
  };
  const std::string row =
      "ATOM   77   C CX   . GLY A 9 ? 1.25     2.5      -3.5 0.50 10.00 ? 9    A 1 ";
  std::vector<std::string> odd = {"",
                                  " ",
                                  "#",
                                  "# a",
                                  ";",
                                  ";\n;",
                                  row + "# a",
                                  row + " 1",
                                  row.substr(0, row.size() - 2),
                                  " " + row,
                                  row + "\n" + row,
                                  row + row,
                                  with(row, " C ", "\n"),
                                  with(row, " C ", "\t"),
                                  with(row, " C ", "\f")};
  for (const std::string_view name :
       {"'C X'",     "\"C'X\"",     "'CX'#",   "'C'X'", "'CX",   "C'X",          ";CX",
        "data_",     "Loop_x",      "GLOBAL_", "_CX",   "$CX",   "#CX",          "[CX",
        "C\xc3\xa9", "'C\xc3\xa9'", "''",      "?",     "'?'",   "\n;C\nX\n;\n", "'C\rX'",
        "'C'\rX",    "C\x01X",      "stop_",   "save_", "dataX", "\x7f"})
    odd.push_back(with(row, "CX", name));
  odd.push_back(with(row, "CX", std::string_view("C\0X", 3)));
  odd.push_back(with(row, "CX", std::string_view("'C\0X'", 5)));
  for (const std::string_view number :
       {"?", ".", "+1.25", "++1", "1.25(3)", "1.25(", "1e999", "-1e-999", "nan", "-inf", "1,25",
        ".5", "5.", "0x10", "'1.25'", "1.25.", "123456789012345678901234567890"})
    odd.push_back(with(row, "1.25", number));
  for (const std::string_view number :
       {"9A", "9Ab", "-9", "+9", "?", "x", "''", "'9'", "99999999999", "-999"}) {
    odd.push_back(with(row, "9    A", std::string(number) + " A"));
    odd.push_back(with(row, "A 9 ?", "A " + std::string(number) + " ?"));
    odd.push_back(with(row, "77", number));
    odd.push_back(with(row, "10.00 ?", "10.00 " + std::string(number)));
  }
  for (const std::string_view code : {"A", "AB", "'A'", "''", "' '", "."}) {
    odd.push_back(with(row, "9 ?", "9 " + std::string(code)));
    odd.push_back(with(row, "CX   .", "CX " + std::string(code)));
    odd.push_back(with(with(row, "9 ?", "9 " + std::string(code)), "9    A", "9A A"));
  }
  for (const std::string_view symbol :
       {"?", "D", "d", "FE", "Fe3+", "Xx", "C1", "'C'", "' C'", "''"})
    odd.push_back(with(row, " C ", " " + std::string(symbol) + " "));
  for (const std::string& line : odd)
    for (const size_t at : {0uz, 1uz, plain.size() / 2, plain.size() - 1, plain.size()}) {
      std::vector<std::string> some = plain;
      some.insert(some.begin() + long(at), line);
      expect_same(file_of(some));
    }
}

TEST(AtomSite, UnreadableRowsAreReported) {
  const auto error_of = [](std::string_view word, std::string_view instead) {
    std::vector<std::string> some = rows();
    std::string& row = some[7];
    row.replace(row.find(word), word.size(), instead);
    return seen(file_of(some));
  };
  EXPECT_EQ(error_of("A 2 A", "A x A"), "0:0: not an integer: x");
  EXPECT_EQ(error_of("? 2    A", "? 2B   A"), "0:0: Inconsistent insertion code in 2B");
  EXPECT_EQ(error_of("CA   .", "CA   AB"), "0:0: Not a single character: AB");
  EXPECT_EQ(error_of("20.50 ?", "20.50 1+"), "0:0: not an integer: 1+");
  EXPECT_EQ(error_of("CA   .", "'CA ."), "41:76: unterminated 'string'");
}

TEST(AtomSite, LinesAreReadUpToAnOddOne) {
  const auto read_to = [](std::string_view text) {
    const auto loop = find_atom_site(text);
    if (!loop) return std::string("no loop");
    AtomSite site(loop->tags, {});
    const char* const last = site.add_lines(text.substr(size_t(loop->rows - text.data())));
    return std::string(last).substr(7, 2);
  };
  EXPECT_EQ(read_to(file_of(rows())), "14");
  EXPECT_EQ(read_to(with_line_ends(file_of(rows()), "\r\n")), "14");
  std::vector<std::string> some = rows();
  some.insert(some.begin() + 5, "# a comment");
  EXPECT_EQ(read_to(file_of(some)), "5 ");
  EXPECT_EQ(read_to("data_a\n_x.y\n;\n" + std::string(kTags) + rows()[0] + "\n;\n"), "no loop");
}

TEST(AtomSite, ManyRowsAreReadInParts) {
  constexpr size_t kRows = 30000;
  constexpr const char* kNames[] = {"O", "H1", "H2"};
  std::vector<std::string> many;
  for (size_t i = 0; i < kRows; ++i)
    many.push_back(fmt::format("HETATM {} O {} . HOH W . ? {} {} 0.125 1.00 30.00 ? {} W 1", i + 1,
                               kNames[i % 3], i % 100, i / 100, 1 + i / 3));
  expect_same(file_of(many));
  const std::string all = seen(file_of(many));
  EXPECT_THAT(all, HasSubstr("residue HOH 1\nresidue HOH 2\n"));
  EXPECT_THAT(all,
              HasSubstr("\n99 299 0.125 element 8 chain 0 part 0 residue 9999 1 30\nchain W\n"));
  many[kRows / 2] += " # an odd row";
  expect_same(file_of(many));
  EXPECT_EQ(seen(file_of(many)), all);
  many[kRows / 2] = "'";
  EXPECT_THAT(seen(file_of(many)), StartsWith(fmt::format("{}:2: unterminated", 34 + kRows / 2)));
}

}  // namespace
}  // namespace raio::core
