// What picked atoms measure, and what they are called, compared with gemmi, which reads the same
// text.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "gemmi_measures.h"
#include "io/atoms/labels.h"
#include "io/scene_file.h"
#include "nff_text.h"
#include "view/selection.h"

namespace raio::core::view {
namespace {

using tests::GemmiAtom, tests::GemmiPlace, tests::kSharedFolder;

// Of picks of random atoms: the largest differences from gemmi.
struct Differences {
  double distance = 0, angle_deg = 0, dihedral_deg = 0;
};

Differences differences(const std::string& text, int picks) {
  Differences out;
  const std::vector<GemmiAtom> expected = tests::atoms_by_gemmi(text);
  ReadOptions options = kForWindow;
  options.style = AtomStyle::space_filling, options.hide_solvent = false, options.assembly = 0;
  const auto file = parse_scene(text, "a.pdb", options);
  EXPECT_TRUE(file);
  if (!file) return out;
  const Scene& scene = file->scene;
  EXPECT_EQ(scene.spheres.size(), expected.size());
  if (scene.spheres.size() != expected.size()) return out;
  for (uint32_t i = 0; i < expected.size(); ++i) {
    const GemmiAtom& atom = expected[i];
    EXPECT_TRUE(file->atoms->label(i).ends_with(fmt::format(
        "{} {} {}, chain {}", atom.residue, atom.residue_number, atom.name, atom.chain)))
        << file->atoms->label(i) << ", not " << atom.name;
    EXPECT_EQ(file->atoms->number(i), uint32_t(atom.serial));
  }
  std::mt19937 random(7);
  for (int n = 0; n < picks; ++n) {
    std::vector<uint32_t> atoms;
    while (atoms.size() < 4) {
      const auto atom = uint32_t(random() % expected.size());
      if (std::ranges::count(atoms, atom) == 0) atoms.push_back(atom);
    }
    std::array<Vec3d, 4> p;
    std::array<GemmiPlace, 4> q;
    for (size_t k = 0; k < 4; ++k) {
      p[k] = scene.origin + Vec3d(scene.spheres[atoms[k]].center);
      q[k] = expected[atoms[k]].place;
    }
    const auto apart = [](double& largest, double ours, double theirs) {
      double difference = std::abs(ours - theirs);
      difference = std::min(difference, std::abs(360 - difference));  // -180 and 180 are the same
      largest = std::max(largest, difference);
    };
    out.distance = std::max(
        out.distance, std::abs(view::distance(p[0], p[1]) - tests::distance_by_gemmi(q[0], q[1])));
    apart(out.angle_deg, angle_deg(p[0], p[1], p[2]), tests::angle_by_gemmi(q[0], q[1], q[2]));
    apart(out.dihedral_deg, dihedral_deg(p[0], p[1], p[2], p[3]),
          tests::dihedral_by_gemmi(q[0], q[1], q[2], q[3]));
  }
  return out;
}

// Coordinates of files have three decimals, and floats near 30 steps of 2e-6.
void expect_as_gemmi(const Differences& found) {
  EXPECT_LT(found.distance, 1e-5);
  EXPECT_LT(found.angle_deg, 1e-3);
  EXPECT_LT(found.dihedral_deg, 1e-2);
  testing::Test::RecordProperty("distance", fmt::format("{:.2g}", found.distance));
  testing::Test::RecordProperty("angle", fmt::format("{:.2g}", found.angle_deg));
  testing::Test::RecordProperty("dihedral", fmt::format("{:.2g}", found.dihedral_deg));
}

TEST(Measures, OfRandomAtomsAreThoseOfGemmi) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-30, 30);
  constexpr std::array<const char*, 5> kNames = {" N  ", " CA ", " C  ", " O  ", "HD11"};
  std::string text;
  for (int i = 0; i < 200; ++i)
    text += fmt::format(
        "ATOM  {:5} {} ALA {}{:4}    {:8.3f}{:8.3f}{:8.3f}  1.00  0.00           {}  \n", 3 * i + 1,
        kNames[size_t(i) % 5], i < 100 ? 'A' : 'B', i / 5 + 1, place(random), place(random),
        place(random), kNames[size_t(i) % 5][0] == 'H' ? 'H' : kNames[size_t(i) % 5][1]);
  expect_as_gemmi(differences(text, 200));
}

TEST(Measures, OfCrambinAreThoseOfGemmi) {
  const auto path = kSharedFolder / "molecules/1crn.pdb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  std::ifstream in(path, std::ios::binary);
  expect_as_gemmi(differences({std::istreambuf_iterator<char>(in), {}}, 200));
}

}  // namespace
}  // namespace raio::core::view
