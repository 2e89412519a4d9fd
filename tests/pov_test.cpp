// Scenes written for POV-Ray. bench/pov.py checks whether it renders the same picture.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/commands.h"
#include "io/pov_write.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Scene lit_scene() {
  Scene s;
  s.camera.from = {0, -4, 0}, s.camera.at = {0, 0, 0}, s.camera.up = {0, 0, 1};
  s.camera.fov_deg = 90;
  s.background = {0.1f, 0.2f, 0.3f};
  s.lights = {{{1, -2, 3}, std::nullopt}, {{-1, -2, 3}, std::nullopt}};
  s.materials = {{{1, 0.5f, 0.25f}, 0.75f, 0.25f, 3.0827f, 0, 1},
                 {{1, 1, 1}, 0.1f, 0.2f, 50, 0.5f, 1.5f}};
  return s;
}

std::string written(const Scene& scene) { return write_pov(scene, {}); }

TEST(PovWriter, ShapesAreExact) {
  Scene s = lit_scene();
  s.planes = {{{0, 0, -1.5f}, {0, 0, 1}}}, s.plane_materials = {0};
  s.spheres = {{{0.1f, 1e-7f, -3}, -0.7f}}, s.sphere_materials = {0};
  s.cones = {{{0, 0, 0}, 1, {0, 0, 2}, 0.5f}, {{0, 0, 0}, 1, {0, 0, 2}, 1}};
  s.cone_materials = {0, 0};
  s.ellipsoids = {{{1, 2, 3}, {{0, 2, 0}, {-1, 0, 0}, {0, 0, 0.5f}}}};
  s.ellipsoid_materials = {0};
  s.discs = {{{1, 2, 3}, {0, 0, 1}, 2, 0.5f}}, s.disc_materials = {0};
  s.moving_spheres = {{{4, 5, 6}, {7, 8, 9}, 0.25f, 1, 2}}, s.moving_sphere_materials = {0};
  s.moving_triangles = {{{{0, 0, 7}, {1, 0, 7}, {0, 1, 7}}, {{0, 0, 8}, {1, 0, 8}, {0, 1, 8}}}};
  s.moving_triangle_materials = {0};
  s.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 5, 5}};
  s.polygons = {{0, 4}}, s.polygon_materials = {0};
  s.triangles = {{4, 1, 2}, {2, 1, 3}}, s.triangle_materials = {0, 0};
  s.normals = {{0, 0, 1}, {0, 1, 0}};
  s.triangle_normals = {{kNoNormal, kNoNormal, kNoNormal}, {1, 1, 0}};
  ASSERT_THAT(validate(s), testing::IsEmpty());
  const std::string pov = written(s);
  for (const char* part :
       {"plane { <0, 0, 1>, -1.5 texture { M0 } }", "sphere { <0.1, 1e-07, -3>, 0.7 texture",
        "cone { <0, 0, 0>, 1, <0, 0, 2>, 0.5 open texture",
        "cylinder { <0, 0, 0>, <0, 0, 2>, 1 open texture",
        "sphere { 0, 1 matrix <0, 2, 0, -1, 0, 0, 0, 0, 0.5, 1, 2, 3> texture",
        "disc { <1, 2, 3>, <0, 0, 1>, 2, 0.5 texture", "sphere { <4, 5, 6>, 0.25 texture",
        "triangle { <0, 0, 7>, <1, 0, 7>, <0, 1, 7> texture",
        "polygon { 5, <0, 0, 0>, <1, 0, 0>, <1, 1, 0>, <0, 1, 0>, <0, 0, 0> texture",
        " vertex_vectors { 3,\n <5, 5, 5>,\n <1, 0, 0>,\n <1, 1, 0> }\n face_indices { 1,\n <0, 1, "
        "2> }",
        " normal_vectors { 2,\n <0, 1, 0>,\n <0, 0, 1> }", " normal_indices { 1,\n <0, 0, 1> }"})
    EXPECT_THAT(pov, HasSubstr(part));
}

TEST(PovWriter, CameraLightsAndShading) {
  const std::string pov =
      write_pov(lit_scene(), {.name = "x", .width = 600, .height = 300, .depth = 7}, "a comment");
  EXPECT_THAT(pov,
              StartsWith("// a comment\n// povray +Ix.pov +Ox.png +W600 +H300 File_Gamma=1.0"));
  for (const char* part :
       {"assumed_gamma 1 ", "max_trace_level 7 ", "background { rgb <0.1, 0.2, 0.3> }",
        "location <0, -4, 0>", "direction <0, 1, 0>", "<1, -2, 3> rgb <0.70710677,",
        "pigment { rgb <1, 0.5, 0.25> transmit 0 }",
        "ambient 0.1 diffuse 0.75 phong 0.25 phong_size 3.0827 reflection { 0.25 }",
        "ambient 0.2 diffuse 0.2"})  // of half transparent glass, of which POV-Ray takes half
    EXPECT_THAT(pov, HasSubstr(part));
}

// Data, which has no lights, is not left in the dark.
TEST(PovWriter, FiguresHaveASkyAndAKeyLight) {
  Scene s = lit_scene();
  s.dialect = Dialect::data, s.lights = {};
  const std::string pov = written(s);
  for (const char* part : {"+A0.1 -D\n", "background { rgb <1, 1, 1> }",
                           " rgb 0.6 parallel point_at <", "ambient 0.6 "})
    EXPECT_THAT(pov, HasSubstr(part));
  EXPECT_THAT(pov, Not(HasSubstr("File_Gamma")));
}

TEST(PovWriter, GlassIsOneObjectWithTheShadowOfAnOpaqueOne) {
  Scene s = lit_scene();
  s.spheres = {{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{4, 0, 0}, 1}};
  s.sphere_materials = {1, 0, 1};
  const std::string pov = written(s);
  EXPECT_THAT(pov, HasSubstr("#declare Glass1 = union {\nsphere { <0, 0, 0>, 1 }\n"
                             "sphere { <4, 0, 0>, 1 }\n}\n"));
  EXPECT_THAT(pov, AllOf(HasSubstr("interior { ior 1.5 } no_shadow"),
                         HasSubstr("no_image no_reflection"), Not(HasSubstr("Glass0"))));
}

class Export : public TemporaryFolder {};

TEST_F(Export, WritesTheRequestedFile) {
  const std::string source = RAIO_SOURCE_DIR "/scenes/shapes.nff";
  app::ExportCommand command{.scene = source, .output = file("out.pov"), .options = {}};
  command.options.width = 40, command.options.height = 30;
  EXPECT_EQ(run(command), app::kDone);
  EXPECT_THAT(get(file("out.pov")), HasSubstr("povray +Iout.pov +Oout.png +W40 +H30 "));
  command.output = file("out.nff");
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(command), app::kBadInput);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("ends with .pov"));
}

}  // namespace
}  // namespace raio::core
