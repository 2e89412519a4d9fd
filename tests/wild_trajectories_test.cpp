// XYZ, GRO and LAMMPS files as written by other programs than those that defined the formats.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "data_files.h"
#include "io/atoms/colors.h"
#include "io/atoms/lammps_styles.h"
#include "io/scene_file.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

// Notices, a line each.
std::string notices_of(const std::expected<ReadScene, Diagnostics>& got) {
  if (!got) return got.error().front().text();
  std::string out;
  for (const Diagnostic& d : got->notices) out += d.text() + "\n";
  return out;
}

// Symbols and positions of the spheres: "C 0 0 0; ".
std::string atoms_of(const std::expected<ReadScene, Diagnostics>& got) {
  if (!got) return got.error().front().text();
  std::ostringstream out;
  const Scene& scene = got->scene;
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    const Rgb color = scene.materials[scene.sphere_materials[i]].color;
    std::string symbol = "?";
    for (int e = 1; e < kElements; ++e)
      if (symbol == "?" && color == element_color(e)) symbol = element_symbol(e);
    const Vec3f p = scene.spheres[i].center;
    out << symbol << ' ' << p.x << ' ' << p.y << ' ' << p.z << "; ";
  }
  return out.str();
}

std::string atoms_of(std::string_view text, std::string_view name,
                     const ReadOptions& options = {}) {
  return atoms_of(parse_scene(text, name, options));
}
std::string notices_of(std::string_view text, std::string_view name,
                       const ReadOptions& options = {}) {
  return notices_of(parse_scene(text, name, options));
}

class WildTrajectory : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << "there is no " << folder_;
  }
  std::expected<ReadScene, Diagnostics> get(std::string_view name,
                                            const ReadOptions& options = {}) const {
    return read_scene(folder_ / name, options);
  }
  std::string atoms(std::string_view name, const ReadOptions& options = {}) const {
    return atoms_of(get(name, options));
  }
  // The lengths of the edges of the cell, as the first three edges have them.
  std::string cell(std::string_view name) const {
    const auto got = get(name, {.style = AtomStyle::points, .cell = true});
    if (!got) return got.error().front().text();
    std::ostringstream out;
    for (size_t axis = 0; axis < 3; ++axis) {
      const Cone& edge = got->scene.cones[4 * axis];
      const Vec3f side = edge.apex - edge.base;
      out << side.x << ' ' << side.y << ' ' << side.z << "; ";
    }
    return out.str();
  }
  const std::filesystem::path folder_ = RAIO_SOURCE_DIR "/../shared/wild/molecules";
};

TEST_F(WildTrajectory, DataFiles) {
  const auto charge = get("data-charge-no-style.lmp");
  EXPECT_EQ(atoms_of(charge).substr(1), " 1 2 3; ? 4 5 6; ");
  EXPECT_THAT(notices_of(charge), HasSubstr("atom style from the columns: charge"));
  EXPECT_EQ(atoms("data-comments.lmp"), "C 1 2 3; C 4 5 6; ");
  const auto electron = get("data-electron-no-style.lmp");
  EXPECT_EQ(atoms_of(electron).substr(1), " 1 2 3.5; ? 4 5 6.5; ");
  EXPECT_THAT(notices_of(electron), HasSubstr("electron"));
  EXPECT_EQ(atoms("data-general-triclinic.lmp").substr(1), " 6 5.5 4; ");
  EXPECT_EQ(cell("data-general-triclinic.lmp"), "10 0 0; 3 9 0; -1 2 8; ");
  EXPECT_EQ(atoms("data-image-flags.lmp"), "Fe 1 2 3; Fe 4 5 6; ");
  EXPECT_EQ(atoms("data-one-header-line.lmp").substr(1), " 1 2 3; ");
  const auto sphere = get("data-sphere-no-style.lmp");
  EXPECT_EQ(atoms_of(sphere).substr(1), " 1 2 3; ? 4 5 6; ");
  EXPECT_FLOAT_EQ(sphere->scene.spheres[0].radius, 0.5f);
  EXPECT_THAT(notices_of(sphere), HasSubstr("sphere"));
}

TEST_F(WildTrajectory, Dumps) {
  EXPECT_THAT(atoms("dump-empty-frame.dump"), HasSubstr("frame 0 has no atoms"));
  EXPECT_EQ(atoms("dump-empty-frame.dump", {.frame = 1}).substr(1), " 1 2 3; ");
  EXPECT_EQ(atoms("dump-general-triclinic.dump").substr(1), " 7 7.5 7; ");
  EXPECT_EQ(cell("dump-general-triclinic.dump"), "10 0 0; 3 9 0; -1 2 8; ");
  EXPECT_THAT(atoms("dump-no-labels-old.dump"), HasSubstr("dump-no-labels-old.dump:9:12: error"));
  EXPECT_EQ(atoms("dump-scaled-offset.dump").substr(1), " 2.43 14.5 7; ");
  EXPECT_EQ(atoms("dump-triclinic-bounds.dump").substr(1), " 0 0 0; ? -0.5 1 5; ");
  EXPECT_EQ(cell("dump-triclinic-bounds.dump"), "10 0 0; 3 10 0; -1 2 10; ");
  EXPECT_EQ(atoms("dump-units-time.dump"), "Cu 1 2 3; Zr 4 5 6; ");
  EXPECT_EQ(atoms("dump-xu-image.dump").substr(1), " 1 2 3; ");
}

TEST_F(WildTrajectory, Xyz) {
  EXPECT_EQ(atoms("xyz-blank-between.xyz"), "C 0 0 0; ");
  EXPECT_EQ(atoms("xyz-blank-between.xyz", {.frame = 1}), "C 0 0 0; O 1.2 0 0; ");
  EXPECT_EQ(atoms("xyz-d-exponent.xyz"), "C 1.5 0 0; O -25 0 0; ");
  EXPECT_EQ(atoms("xyz-extra-columns.xyz"), "C 0 0 0; O 1.2 0 0; ");
  EXPECT_EQ(atoms("xyz-indent-trailing.xyz"), "C 0 0 0; O 1.2 0 0; ");
  const auto isotopes = get("xyz-isotopes-dummies.xyz");
  EXPECT_THAT(atoms_of(isotopes), HasSubstr("H 0 0 0; H 2 0 0; ? 4 0 0; "));
  EXPECT_THAT(notices_of(isotopes), HasSubstr("labels that are not elements (4: X, Xx, Du, Bq)"));
  EXPECT_THAT(atoms("xyz-lattice-only.xyz"), HasSubstr("O 0.07 0 0; H "));
  EXPECT_EQ(cell("xyz-lattice-only.xyz"), "10 0 0; 0 10 0; 0 0 10; ");
  EXPECT_EQ(atoms("xyz-numbers.xyz"), "O 0 0 0; H 0.96 0 0; H -0.24 0.93 0; ");
  EXPECT_EQ(atoms("xyz-tabs-crlf-noeol.xyz"), "C 0 -3e-06 0; O 1.2 0 0; ");
  const auto cut = get("xyz-truncated-last.xyz", {.frame = -1});
  EXPECT_EQ(atoms_of(cut), "C 0 0 0; O 1.2 0 0; ");
  EXPECT_THAT(
      notices_of(cut),
      HasSubstr(":5:1: cut: the last frame is left out: the file ends after 1 of its 2 atoms"));
  EXPECT_EQ(cell("extxyz-lattice-brackets.xyz"), "4 0 0; 0 4 0; 0 0 4; ");
  EXPECT_EQ(atoms("extxyz-lower.xyz"), "C 0 0 0; O 1.2 0 0; ");
  EXPECT_EQ(cell("extxyz-lower.xyz"), "4 0 0; 0 4 0; 0 0 4; ");
  EXPECT_EQ(atoms("extxyz-order.xyz"), "C 0 0 0; O 1.2 0 0; ");
}

TEST_F(WildTrajectory, Gro) {
  EXPECT_EQ(atoms("gro-box-triclinic.gro"), "O 1 2 3; ");
  const auto elements = get("gro-elements.gro", {.style = AtomStyle::space_filling});
  EXPECT_EQ(atoms_of(elements),
            "Na 0 0 0; Cl 4 0 0; Ca 8 0 0; C 12 0 0; Mg 16 0 0; Zn 20 0 0; H 24 0 0; H 28 0 0; O "
            "32 0 0; ? 36 0 0; ");
  EXPECT_THAT(notices_of(elements), HasSubstr("atom names that are not elements (1: MW)"));
  EXPECT_EQ(atoms("gro-precision.gro"), "O 1.23457 2 3; ");
  EXPECT_EQ(atoms("gro-six-digits.gro"), "O 102.21 106.29 101.22; H 101.28 106.27 101.59; ");
  EXPECT_EQ(atoms("gro-wrap.gro"), "W 1 2 3; W 4 5 6; W 7 8 9; ");
}

constexpr std::string_view kBox =
    "title\n\n2 atoms\n2 atom types\n0 10 xlo xhi\n0 10 ylo yhi\n0 10 zlo zhi\n";

std::string lammps_text(std::string_view rows, std::string_view style = "",
                        std::string_view header = "") {
  return std::string(kBox) + std::string(header) + "\nAtoms " + std::string(style) + "\n\n" +
         std::string(rows);
}

TEST(LammpsStyles, AllHaveTheirColumns) {
  struct Case {
    std::string_view style, row;
  };
  // The type is 2 and the position 1.5 2.5 3.5, in any columns.
  for (const auto& [style, row] :
       std::initializer_list<Case>{{"angle", "7 2 1.5 2.5 3.5"},
                                   {"atomic", "2 1.5 2.5 3.5"},
                                   {"body", "2 1 9.5 1.5 2.5 3.5"},
                                   {"bond", "7 2 1.5 2.5 3.5"},
                                   {"bpm/sphere", "7 2 0.5 9.5 1.5 2.5 3.5"},
                                   {"charge", "2 9.5 1.5 2.5 3.5"},
                                   {"dielectric", "2 9.5 1.5 2.5 3.5 0 0 1 9 9 9 9 9"},
                                   {"dipole", "2 9.5 1.5 2.5 3.5 9 9 9"},
                                   {"dpd", "2 9.5 1.5 2.5 3.5"},
                                   {"edpd", "2 9.5 9.5 1.5 2.5 3.5"},
                                   {"electron", "2 9.5 1 9.5 1.5 2.5 3.5"},
                                   {"ellipsoid", "2 1 9.5 1.5 2.5 3.5"},
                                   {"full", "7 2 9.5 1.5 2.5 3.5"},
                                   {"hybrid", "2 1.5 2.5 3.5 7 8 9 9.5"},
                                   {"line", "7 2 1 9.5 1.5 2.5 3.5"},
                                   {"mdpd", "2 9.5 1.5 2.5 3.5"},
                                   {"mesont", "7 2 1 -1 9.5 9.5 9.5 9.5 1.5 2.5 3.5"},
                                   {"molecular", "7 2 1.5 2.5 3.5"},
                                   {"peri", "2 9.5 9.5 1.5 2.5 3.5"},
                                   {"rheo", "2 1 9.5 1.5 2.5 3.5"},
                                   {"rheo/thermal", "2 1 9.5 9.5 1.5 2.5 3.5"},
                                   {"smd", "2 7 9.5 9.5 9.5 9.5 9 9 9 1.5 2.5 3.5"},
                                   {"sph", "2 9.5 9.5 9.5 1.5 2.5 3.5"},
                                   {"sphere", "2 0.5 9.5 1.5 2.5 3.5"},
                                   {"spin", "2 1.5 2.5 3.5 0 0 1 9.5"},
                                   {"tdpd", "2 1.5 2.5 3.5 9.5 9.5"},
                                   {"template", "7 1 1 2 1.5 2.5 3.5"},
                                   {"tri", "7 2 1 9.5 1.5 2.5 3.5"},
                                   {"wavepacket", "2 9.5 1 9.5 1 9.5 9.5 1.5 2.5 3.5"}}) {
    const std::string rows = "1 " + std::string(row) + "\n2 " + std::string(row) + "\n";
    const auto by_option =
        parse_scene(lammps_text(rows), "a.lmp", {.atom_style = std::string(style)});
    ASSERT_TRUE(by_option) << style << ": " << by_option.error().front().text();
    EXPECT_EQ(by_option->scene.spheres[0].center, Vec3f(1.5f, 2.5f, 3.5f)) << style;
    EXPECT_EQ(by_option->scene.materials[by_option->scene.sphere_materials[0]].color,
              distinct_color(1))
        << style;
    EXPECT_EQ(atoms_of(lammps_text(rows, "# " + std::string(style)), "a.lmp"), atoms_of(by_option));
    EXPECT_NE(find_lammps_style(style), nullptr);
    // With flags, which must be whole numbers.
    if (style == "hybrid" || style == "tdpd") continue;
    const auto flagged = [&](std::string_view flags) {
      return lammps_text("1 " + std::string(row) + std::string(flags) + "\n2 " + std::string(row) +
                             std::string(flags) + "\n",
                         "# " + std::string(style));
    };
    EXPECT_EQ(atoms_of(flagged(" 0 -1 2"), "a.lmp"), atoms_of(by_option));
    EXPECT_THAT(error(flagged(" 0 0.5 0"), "a.lmp"), HasSubstr("an image flag, a whole number"));
    EXPECT_THAT(error(flagged(" 0 0"), "a.lmp"), HasSubstr("rows of")) << style;
  }
}

TEST(LammpsStyles, AreGuessedByColumns) {
  const auto style = [](std::string_view rows, std::string_view header = "") {
    const std::string notices = notices_of(lammps_text(rows, "", header), "a.lmp");
    const size_t at = notices.find("columns: ");
    return at == notices.npos
               ? notices
               : notices.substr(at + 9, notices.find_first_of(" \n", at + 9) - at - 9);
  };
  EXPECT_EQ(style("1 1 1.0 2.0 3.0\n2 2 4.0 5.0 6.0\n"), "atomic");
  EXPECT_EQ(style("1 1 1.0 2.0 3.0 0 0 -1\n2 2 4.0 5.0 6.0 0 1 0\n"), "atomic");
  EXPECT_EQ(style("1 1 -0.5 2.0 3.0 1.0\n2 2 0.5 5.0 6.0 1.0\n"), "charge");
  EXPECT_EQ(style("1 1 1 2.0 3.0 1.0\n2 1 2 5.0 6.0 1.0\n"), "molecular");
  EXPECT_EQ(style("1 1 1 2.0 3.0 1.0 0 0 0\n2 1 2 5.0 6.0 1.0 0 0 0\n"), "molecular");
  EXPECT_EQ(style("1 1 1 -0.8 2.0 3.0 1.0\n2 1 2 0.4 5.0 6.0 1.0\n"), "full");
  EXPECT_EQ(style("1 1 1 0.8 2.0 3.0 1.0\n2 1 2 0.4 5.0 6.0 1.0\n", "1 bonds\n"), "full");
  EXPECT_EQ(style("1 1 1 0.8 2.0 3.0 1.0\n2 1 0 0.4 5.0 6.0 1.0\n", "2 ellipsoids\n"), "ellipsoid");
  EXPECT_EQ(style("1 1 0.5 2600.5 2.0 3.0 1.0\n2 1 0.5 2600.5 5.0 6.0 1.0\n"), "sphere");
  EXPECT_EQ(style("1 1 -0.5 1.0 2.0 3.0 0.1 0.2 0.3\n2 1 0.5 4.0 5.0 6.0 0.1 0.2 0.3\n"), "dipole");
  // A full one without charges, or one of the styles with flags and densities.
  const std::string several = lammps_text("1 1 1 0.8 2.0 3.0 1.0\n2 1 1 0.4 5.0 6.0 1.0\n");
  EXPECT_THAT(error(several, "a.lmp"),
              HasSubstr("a.lmp:9:1: error: the atom style is not given, and several match: "
                        "full, rheo; give atom-style"));
  EXPECT_EQ(atoms_of(several, "a.lmp", {.atom_style = "full"}).substr(1), " 2 3 1; ? 5 6 1; ");
  EXPECT_THAT(error(lammps_text("1 1 2.0\n2 1 3.0\n"), "a.lmp"),
              HasSubstr("rows of 3 such columns"));
}

TEST(LammpsStyles, WrongOnesAreRefused) {
  EXPECT_THAT(error(lammps_text("1 1 1.0 2.0 3.0\n2 1 1 2 3\n"), "a.lmp", {.atom_style = "full"}),
              HasSubstr("a.lmp:11:13: error: expected rows of 7 columns, or of 10"));
  EXPECT_THAT(error(lammps_text("1 1 1.0 2.0 3.0\n2 1 1 2 3\n"), "a.lmp", {.atom_style = "magic"}),
              HasSubstr("unknown atom-style 'magic'; expected one of angle, atomic"));
  EXPECT_THAT(error(lammps_text("1 3 1.0 2.0 3.0\n2 1 1 2 3\n", "# atomic"), "a.lmp"),
              HasSubstr("a.lmp:11:3: error: expected a type"));
  EXPECT_THAT(error(kWater, "a.xyz", {.atom_style = "full"}),
              HasSubstr("atom-style has no effect on this file"));
}

TEST(LammpsMasses, OfModelsAreNoElements) {
  const auto masses = [](std::string_view m) {
    return lammps_text("1 1 1.0 2.0 3.0\n2 2 4.0 5.0 6.0\n", "# atomic",
                       "\nMasses\n\n" + std::string(m));
  };
  for (const auto* model : {"1 1\n2 1\n", "1 1.0\n2 10.0\n", "1 1\n2 4\n", "1 72\n2 45\n"}) {
    const auto got = parse_scene(masses(model), "a.lmp");
    ASSERT_TRUE(got) << got.error().front().text();
    EXPECT_EQ(got->scene.materials[got->scene.sphere_materials[0]].color, distinct_color(0))
        << model;
    EXPECT_EQ(got->scene.materials[got->scene.sphere_materials[1]].color, distinct_color(1))
        << model;
    EXPECT_THAT(notices_of(got), HasSubstr("guessed: masses do not match elements"));
  }
  const auto real = parse_scene(masses("1 12.011\n2 1.008\n"), "a.lmp");
  EXPECT_EQ(atoms_of(real), "C 1 2 3; H 4 5 6; ");
  EXPECT_THAT(notices_of(real),
              HasSubstr("guessed: elements from the masses of types (2: 1 = C, 2 = H)"));
  EXPECT_EQ(atoms_of(masses("1 15.035\n2 14.027\n"), "a.lmp"), "C 1 2 3; C 4 5 6; ")
      << "united atoms";
  EXPECT_EQ(notices_of(masses("1 12.011 # C\n2 1.008 # H\n"), "a.lmp"), "");
}

TEST(WildXyz, LabelsBeginWithTheirElements) {
  const std::string text =
      "6\n\nC1 0 0 0\nH12 9 0 0\nC_3 18 0 0\nFe3+ 27 0 0\ncl 36 0 0\nBB 45 0 0\n";
  const auto got = parse_scene(text, "a.xyz");
  EXPECT_EQ(atoms_of(got), "C 0 0 0; H 9 0 0; C 18 0 0; Fe 27 0 0; Cl 36 0 0; ? 45 0 0; ");
  EXPECT_THAT(notices_of(got),
              HasSubstr("a.xyz:3:1: guessed: elements from the leading letters of labels "
                        "(4: C1, H12, C_3, Fe3+)"));
  EXPECT_THAT(notices_of(got),
              HasSubstr("a.xyz:8:1: warning: labels that are not elements (1: BB)"));
  EXPECT_EQ(notices_of(kWater, "a.xyz"), "");
}

TEST(WildXyz, ByteOrderMarksAreNoLetters) {
  EXPECT_EQ(atoms_of("\xef\xbb\xbf" + std::string(kWater), "a.xyz"), atoms_of(kWater, "a.xyz"));
  EXPECT_EQ(atoms_of("\xef\xbb\xbf" + std::string(kDump), "a"), atoms_of(kDump, "a"));
  EXPECT_THAT(error("\xef\xbb\xbfx\n", "a.xyz"), HasSubstr("a.xyz:1:1: error"));
}

TEST(WildXyz, OtherFormatsWithItsSuffixAreNamed) {
  EXPECT_THAT(error("0 1.5 2\n1 2 3\n", "a.xyz"), HasSubstr("these lines are points"));
  EXPECT_THAT(error("2 water\n1 O 0 0 0 1 2\n2 H 1 0 0 2 1\n", "a.xyz"), HasSubstr("Tinker"));
  EXPECT_THAT(error("1\n10 10 10 90 90 90\n1 O 0 0 0 1\n", "a.xyz"), HasSubstr("Tinker"));
}

TEST(WildDumps, LastFramesMayBeCut) {
  const std::string whole(kDump);
  const size_t second = whole.find("ITEM: TIMESTEP", 1);
  const std::string more = whole.substr(0, second);
  // Wherever the second of two equal frames is truncated, the first is read; a truncated energy in
  // its last row cannot be distinguished from a whole one.
  for (size_t size = 15; size + 3 < more.size(); ++size) {
    const auto got = parse_scene(more + more.substr(0, size), "a.dump");
    ASSERT_TRUE(got) << size << ": " << got.error().front().text();
    EXPECT_EQ(got->frames, 1u) << size;
    EXPECT_THAT(notices_of(got), HasSubstr("cut: the last frame is left out")) << size;
  }
  EXPECT_THAT(notices_of(more + more.substr(0, more.rfind("2 2 1")), "a.dump"),
              HasSubstr("a.dump:12:1: cut: the last frame is left out: the file ends after 1 of "
                        "its 2 atoms"));
  EXPECT_THAT(error(more.substr(0, more.rfind("2 2 1")), "a.dump"),
              HasSubstr("expected 2 atoms, found 1"));
}

TEST(WildGro, BlanksInsideNumbersAreFaults) {
  std::string text(kGro);
  text.replace(text.find("1.661"), 5, "1 661");
  EXPECT_THAT(error(text, "a.gro"), HasSubstr("a.gro:4:"));
  EXPECT_THAT(error(text, "a.gro"), HasSubstr("a blank inside"));
}

}  // namespace
}  // namespace raio::core
