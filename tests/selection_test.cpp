// Picked primitives: their names, and the distances and angles between them.
#include "view/selection.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/atoms/labels.h"
#include "io/scene_file.h"
#include "render/render.h"
#include "temporary_folder.h"
#include "view/app_state.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Pick at(Vec3d place) {
  Pick pick;
  pick.hit.primitive = 0, pick.hit.t = 1;
  pick.place = pick.point = place, pick.what = "sphere 7";
  return pick;
}

TEST(Selection, AnglesOfKnownShapes) {
  const Vec3d o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_EQ(distance(x, y), std::sqrt(2.0));
  EXPECT_NEAR(angle_deg(x, o, y), 90, 1e-12);
  EXPECT_NEAR(angle_deg(x, o, x + y), 45, 1e-12);
  EXPECT_NEAR(angle_deg(x, o, x * -1.0), 180, 1e-12);
  // Along +z from the near end at +x: the far end at +y is clockwise of it, seen from the near end.
  EXPECT_NEAR(dihedral_deg(x, o, z, z + x), 0, 1e-12);
  EXPECT_NEAR(dihedral_deg(x, o, z, z - x), 180, 1e-12);
  EXPECT_NEAR(dihedral_deg(x, o, z, z + y), 90, 1e-12);
  EXPECT_NEAR(dihedral_deg(x, o, z, z - y), -90, 1e-12);
}

TEST(Selection, MeasuresUpToFourPicks) {
  set_language(Language::english);
  Selection s;
  EXPECT_EQ(s.measure(), "");
  s.pick(at({0, 0, 0}), false);
  EXPECT_EQ(s.measure(), "");
  s.pick(at({3, 4, 0}), true);
  EXPECT_EQ(s.measure("\xc3\x85"), "distance 5 \xc3\x85");
  s.pick(at({3, 0, 0}), true);
  EXPECT_EQ(s.measure(), "angle 36.87 degrees");
  s.pick(at({3, 0, 5}), true);
  EXPECT_THAT(s.measure(), HasSubstr("dihedral "));
  s.pick(at({1, 1, 1}), true);
  EXPECT_EQ(s.picks().size(), 1u) << "a fifth starts anew";
  s.pick(at({2, 1, 1}), true);
  s.pick(at({3, 1, 1}), false);
  EXPECT_EQ(s.picks().size(), 1u);
  Scene scene;
  scene.origin = {100, 0, 0};
  EXPECT_THAT(s.lines(scene, {{0, 0, 0}, {10, 10, 10}}),
              ElementsAre("sphere 7, material 0", "at 103, 1, 1"));
}

class SelectionFiles : public TemporaryFolder {
 protected:
  // The pick in the middle of a picture of the file, in the direction of the camera.
  Pick middle(const std::string& name, ReadOptions options) const {
    auto read = read_scene(file(name), options);
    EXPECT_TRUE(read.has_value());
    const RenderSettings settings = resolve_options({}, read->scene);
    const auto accel = build_accel(read->scene, settings.accel);
    return pick(**accel, settings.camera, 0.5, 0.5, 1, &*read);
  }
};

constexpr const char* kPdb =
    "ATOM      1  CA  ALA A  12      10.000   0.000   0.000  1.00  0.00           C  \n";

TEST_F(SelectionFiles, AtomsHaveElementResidueAndChain) {
  put(file("one.pdb"), kPdb);
  const Pick found = middle("one.pdb", kForWindow);
  ASSERT_TRUE(found.hit.found());
  EXPECT_EQ(found.what, "sphere 0");
  EXPECT_EQ(found.object, "C, ALA 12 CA, chain A");
  EXPECT_EQ(found.in_file, "atom 1 of the file, index 0");
  EXPECT_NEAR(found.place.x, 10, 1e-5) << "the centre, not the surface";
  EXPECT_GT(length(found.point - found.place), 1);
  EXPECT_EQ(middle("one.pdb", kForPictures).object, "") << "nobody asked for names";
}

TEST_F(SelectionFiles, CopiesOfAnAssemblyKeepTheirNames) {
  put(file("copies.pdb"),
      std::string("REMARK 350 BIOMOLECULE: 1\n"
                  "REMARK 350 APPLY THE FOLLOWING TO CHAINS: B\n"
                  "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000       30.00000\n"
                  "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
                  "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n") +
          kPdb +
          "ATOM      2  N   GLY B   3      -5.000   0.000   0.000  1.00  0.00           N  \n");
  ReadOptions options = kForWindow;
  options.assembly = 1;
  const Pick found = middle("copies.pdb", options);
  ASSERT_TRUE(found.hit.found());
  EXPECT_THAT(found.object, HasSubstr("N, GLY 3 N, chain B"));
  EXPECT_EQ(found.in_file, "atom 2 of the file, index 1");
  EXPECT_NEAR(found.place.x, 25, 1e-5);
}

TEST(Selection, PlacesHaveTheDigitsThatFloatsHave) {
  const auto text = [](Vec3d place, double largest) {
    const Vec3d r = rounded_place(place, largest);
    return fmt::format("{:.12g} {:.12g} {:.12g}", r.x, r.y, r.z);
  };
  EXPECT_EQ(text({1.7e-8, -3e-8, 1.0 / 3}, 1), "0 0 0.333333") << "no minus, either";
  EXPECT_EQ(text({1.7e-8, 2.5e-9, 1e-9}, 2e-8), "1.7e-08 2.5e-09 1e-09") << "a tiny scene";
  EXPECT_EQ(text({12.3456789, 0.001, -99.98767}, 100), "12.3457 0.001 -99.9877");
  EXPECT_EQ(text({500000.1234567, 4e6, 0}, 1000), "500000.123 4000000 0")
      << "of data far from its file's origin";
  EXPECT_EQ(text({0.1, 0, 0}, 0), "0.1 0 0") << "an empty scene";
  // However it is rounded, the float next to it is not the same.
  for (const float x : {0.7f, 3.0f, 55.5f, 1e5f}) {
    const double shown = rounded_place(Vec3d(double(x)), double(x)).x;
    EXPECT_LT(std::abs(shown - double(x)), 24 * (double(std::nextafter(x, 1e9f)) - double(x)));
  }
}

TEST(Selection, SelectionsAreJoinedAndReduced) {
  EXPECT_EQ(either("", "index 3"), "index 3");
  EXPECT_EQ(either("water", "index 3"), "water or index 3");
  EXPECT_EQ(either("water or index 3,7-9", "index 12"), "water or index 3,7-9,12");
  EXPECT_EQ(either("not index 3", "index 12"), "not index 3 or index 12");
  EXPECT_EQ(either("water or index 3", "residue 1 and chain A"),
            "water or index 3 or residue 1 and chain A");
  EXPECT_EQ(but_not("water", "index 3"), "water and not (index 3)");
  EXPECT_EQ(but_not("water, ion", "index 3"), "(water, ion) and not (index 3)");
  EXPECT_EQ(but_not("water or ion", "index 3"), "(water or ion) and not (index 3)");
  EXPECT_EQ(but_not("(water or ion) and not (index 3)", "index 4"),
            "(water or ion) and not (index 3) and not (index 4)");
}

// A window with two residues and a water that is shown although it is hidden.
class HidingAtoms : public testing::Test {
 protected:
  HidingAtoms() {
    set_language(Language::english);
    facts.now = 100;
  }

  static std::string text() {
    std::string out;
    for (int i = 0; i < 5; ++i)
      out += fmt::format(
          "ATOM  {:5}  CA  {} {}{:4}    {:8.3f}   0.000   0.000  1.00  0.00           C  \n",
          i + 11, i == 4 ? "HOH" : "ALA", i < 3 ? 'A' : 'B', i / 2 + 1, 5.0 * i);
    return out;
  }
  static std::shared_ptr<const ReadScene> file(const ReadOptions& options) {
    auto read = parse_scene(text(), "a.pdb", options);
    EXPECT_TRUE(read) << (read ? "" : read.error().front().text());
    return std::make_shared<const ReadScene>(*std::move(read));
  }
  static ViewState state(const ReadOptions& options) {
    const auto read = file(options);
    ViewState out("a.pdb", std::shared_ptr<const Scene>(read, &read->scene), {});
    out.file = read, out.read_options = options;
    return out;
  }
  static ReadOptions first_options() {
    ReadOptions o = kForWindow;
    o.show = "water, ion";
    return o;
  }

  // Picks these atoms, and uses them; the file is read as requested.
  void use(const std::vector<uint32_t>& atoms, SelectionUse how) {
    app.selection.clear();
    for (const uint32_t atom : atoms) {
      Pick pick = at({0, 0, 0});
      pick.atom = atom;
      app.selection.pick(pick, true);
    }
    event::ControlsUsed used{app.view, {}};
    used.did.selection = how;
    for (const Request& request : app.update(used, facts))
      if (const auto* reread = std::get_if<request::Reread>(&request)) wanted = reread->options;
    const auto read = file(wanted);
    (void)app.update(
        SceneFile::Read{
            "a.pdb", std::shared_ptr<const Scene>(read, &read->scene), {}, wanted, read, true},
        facts);
  }
  std::vector<uint32_t> left() const {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < app.view.file->atoms->atoms; ++i)
      indices.push_back(app.view.file->atoms->index(i));
    return indices;
  }

  Facts facts;
  ReadOptions wanted;
  AppState app{state(first_options()), {}, {}, {}};
};

TEST_F(HidingAtoms, AddsThemToTheOptionOfTheReader) {
  ASSERT_THAT(left(), ElementsAre(0, 1, 2, 3, 4));
  use({1, 3}, SelectionUse::hide);
  EXPECT_EQ(app.view.read_options.hide, "index 1,3");
  EXPECT_THAT(left(), ElementsAre(0, 2, 4));
  EXPECT_TRUE(app.selection.empty());
  EXPECT_THAT(app.view.command_line(64, 48, 1, "a.png"), HasSubstr("--hide 'index 1,3'"));
  use({1}, SelectionUse::hide);
  EXPECT_EQ(app.view.read_options.hide, "index 1,3,2") << "the second of those left";
  EXPECT_THAT(left(), ElementsAre(0, 4));
  use({1}, SelectionUse::hide);
  EXPECT_THAT(left(), ElementsAre(0)) << "a water that `show` draws";
  EXPECT_EQ(app.view.read_options.show,
            "(water, ion) and not (index 1,3) and not (index 2) and not (index 4)");
}

TEST_F(HidingAtoms, ColoursThemAndKeepsThemSelected) {
  app.view.form.own_color = {1, 0.5f, 0};
  use({1, 3}, SelectionUse::color);
  EXPECT_EQ(app.selection.picks().size(), 2u);
  const auto text = [&] { return read_option_of("color-atoms").text(app.view.read_options); };
  EXPECT_EQ(text(), "index 1,3: #ff8000");
  EXPECT_THAT(app.view.command_line(64, 48, 1, "a.png"),
              HasSubstr("--color-atoms 'index 1,3: #ff8000'"));
  app.view.form.own_color = {0, 0, 1};
  use({4}, SelectionUse::color_chain);
  use({0}, SelectionUse::color_residue);
  EXPECT_EQ(text(), "index 1,3: #ff8000; chain B: #0000ff; residue 1 and chain A: #0000ff");
  use({1, 3}, SelectionUse::color);
  EXPECT_EQ(text(), "chain B: #0000ff; residue 1 and chain A: #0000ff; index 1,3: #0000ff")
      << "the older one of the same atoms is gone";
  const Scene& s = *app.view.scene;
  const auto color = [&](size_t atom) { return s.materials[s.sphere_materials[atom]].color; };
  EXPECT_EQ(color(1), Rgb(0, 0, 1));
  EXPECT_NE(color(2), Rgb(0, 0, 1));
  use({1}, SelectionUse::hide);
  EXPECT_TRUE(app.selection.empty());
}

TEST_F(HidingAtoms, HidesResiduesAndChainsAndIsUndone) {
  EXPECT_FALSE(app.selection_facts().is_atom) << "nothing is selected";
  Pick pick = at({0, 0, 0});
  app.selection.pick(pick, false);
  EXPECT_FALSE(app.selection_facts().is_atom) << "a bond";
  pick.atom = 2;
  app.selection.pick(pick, false);
  EXPECT_TRUE(app.selection_facts().is_atom && app.selection_facts().has_residue &&
              app.selection_facts().has_chain);
  use({0}, SelectionUse::hide_residue);
  EXPECT_EQ(app.view.read_options.hide, "residue 1 and chain A");
  EXPECT_THAT(left(), ElementsAre(2, 3, 4));
  facts.now += 1, (void)app.update(event::Tick{}, facts);
  use({1, 2}, SelectionUse::hide_chain);
  EXPECT_EQ(app.view.read_options.hide, "residue 1 and chain A or chain B");
  EXPECT_THAT(left(), ElementsAre(2));
  facts.now += 1, (void)app.update(event::Tick{}, facts);
  app.selection.pick(pick, false);
  (void)app.update(event::KeyPressed{'Z', {.ctrl = true}}, facts);
  EXPECT_TRUE(app.selection.empty()) << "the file has other atoms";
  EXPECT_EQ(app.view.read_options.hide, "residue 1 and chain A") << "undone";
  EXPECT_THAT(left(), ElementsAre(2, 3, 4));
  EXPECT_EQ(app.view.read_options.show, "(water, ion) and not (residue 1 and chain A)");
}

}  // namespace
}  // namespace raio::core::view
