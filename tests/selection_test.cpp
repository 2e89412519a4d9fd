// Picked primitives: their names, and the distances and angles between them.
#include "view/selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/scene_file.h"
#include "render/render.h"
#include "temporary_folder.h"
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
  EXPECT_THAT(s.lines(scene), ElementsAre("sphere 7", "material 0", "at 103, 1, 1"));
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
  EXPECT_EQ(found.object, "C, ALA 12, chain A");
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
  EXPECT_THAT(found.object, HasSubstr("N, GLY 3, chain B"));
  EXPECT_NEAR(found.place.x, 25, 1e-5);
}

}  // namespace
}  // namespace raio::core::view
