// Cameras fitted by options: their directions, and that nothing else of them changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/warnings.h"
#include "io/fit_camera.h"
#include "render/options.h"

namespace raio::core {
namespace {

using testing::HasSubstr, testing::IsEmpty;

Scene corners() {
  Scene s;
  s.camera.from = {9, -5, 3}, s.camera.at = {}, s.camera.up = {0.1f, 0.2f, 0.9f};
  s.camera.fov_deg = 30, s.camera.width = 160, s.camera.height = 120;
  s.materials.resize(1);
  for (const Vec3f center : {Vec3f(-4, -3, -2), Vec3f(4, 3, 2), Vec3f(-4, 3, 1)})
    s.spheres.push_back({center, 0.5f});
  s.sphere_materials.assign(s.spheres.size(), 0);
  return s;
}

Camera camera_with(const Scene& scene, std::initializer_list<std::array<const char*, 2>> options) {
  RenderOptions o;
  for (const auto& [name, value] : options)
    for (const OptionSpec& spec : render_option_table())
      if (spec.name == name) {
        const auto set = set_option(o, spec, value);
        EXPECT_TRUE(set) << name;
      }
  EXPECT_EQ(option_conflict(o, &scene), std::nullopt);
  return camera_of(scene, o);
}

void expect_axis(Vec3f got, Vec3f wanted) {
  EXPECT_LT(length(normalize(got) - wanted), 1e-6f) << got.x << " " << got.y << " " << got.z;
}

TEST(Fit, SidesFaceTheirAxes) {
  const Scene scene = corners();
  struct Case {
    const char *side, *up;
    Vec3f view, picture_up;
  };
  for (const auto& [side, up, view, picture_up] :
       {Case{"front", "z", {0, 1, 0}, {0, 0, 1}}, Case{"back", "z", {0, -1, 0}, {0, 0, 1}},
        Case{"left", "z", {1, 0, 0}, {0, 0, 1}}, Case{"right", "z", {-1, 0, 0}, {0, 0, 1}},
        Case{"top", "z", {0, 0, -1}, {0, 1, 0}}, Case{"bottom", "z", {0, 0, 1}, {0, -1, 0}},
        Case{"front", "y", {0, 0, -1}, {0, 1, 0}}, Case{"top", "y", {0, -1, 0}, {0, 0, -1}},
        Case{"right", "+y", {-1, 0, 0}, {0, 1, 0}}, Case{"front", "-z", {0, -1, 0}, {0, 0, -1}},
        Case{"front", "x", {0, 0, 1}, {1, 0, 0}}}) {
    SCOPED_TRACE(std::string(side) + " " + up);
    const Camera camera = camera_with(scene, {{"from", side}, {"up", up}});
    expect_axis(camera.at - camera.from, view);
    expect_axis(camera.up, picture_up);
  }
  expect_axis(camera_with(scene, {{"from", "front"}}).up, {0, 0, 1});  // nearest to its own
}

TEST(Fit, PicturesHoldAllAsLargeAsItFits) {
  const Scene scene = corners();
  for (const char* projection : {"perspective", "orthographic"})
    for (const char* side : {"front", "right", "top", "iso"}) {
      SCOPED_TRACE(std::string(projection) + " " + side);
      const Camera c = camera_with(scene, {{"from", side}, {"projection", projection}});
      const Vec3d view = Vec3d(c.at) - Vec3d(c.from), forward = normalize(view),
                  right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
      double largest = 0;
      for (const Sphere& sphere : scene.spheres) {
        const Vec3d p = Vec3d(sphere.center) - Vec3d(c.from);
        const double depth = c.is_parallel() ? length(view) : dot(p, forward);
        const auto part = [&](double along, float degrees) {
          const double tangent = std::tan(double(degrees) * std::numbers::pi / 360);
          return (std::abs(along) + double(sphere.radius)) / (depth * tangent);
        };
        largest = std::max(
            {largest, part(dot(p, right), c.horizontal_fov_deg), part(dot(p, up), c.fov_deg)});
      }
      EXPECT_LT(largest, 1);
      EXPECT_GT(largest, 0.9);
    }
}

TEST(Fit, TheSmallestScenesHaveACamera) {
  for (const float size : {1e-45f, 1e-40f, 1e-33f, 1e-28f, 1e-10f}) {
    Scene scene = corners();
    scene.spheres = {}, scene.sphere_materials = {};
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = std::vector<Vec3f>{{0, 0, 0}, {0, 0, 0}, {0, size, 0}};
    mesh.triangles = std::vector<TriangleIndices>{{0, 1, 2}};
    mesh.materials = std::vector<MaterialId>{0};
    for (const FitView view : {FitView::principal, FitView::three_quarter}) {
      fit_camera(scene, view);
      EXPECT_THAT(validate(scene), IsEmpty()) << size;
    }
  }
}

TEST(Fit, UpAffectsOnlyFittedCameras) {
  Scene scene = corners();
  EXPECT_EQ(camera_with(scene, {{"up", "y"}}).from, scene.camera.from);
  fit_camera(scene, FitView::three_quarter);
  const Camera turned = camera_with(scene, {{"up", "y"}});
  EXPECT_NE(turned.from, scene.camera.from);
  EXPECT_GT(turned.up.y, 0.7f);
  EXPECT_EQ(camera_with(scene, {{"up", "y"}, {"at", "0,0,1"}}).from, scene.camera.from);
}

TEST(Fit, CamerasSurviveAsOptions) {
  Scene scene = corners();
  fit_camera(scene, FitView::three_quarter);
  Camera rolled = scene.camera;
  rolled.up = {1, 0, 0};
  for (const Camera& camera :
       {rolled, camera_with(scene, {{"from", "top"}}), camera_with(scene, {{"up", "-x"}})}) {
    RenderOptions o;
    o.side = Side::left;
    set_camera(o, camera, scene);
    const Camera again = camera_of(scene, o);
    EXPECT_EQ(again.from, camera.from);
    EXPECT_EQ(again.at, camera.at);
    EXPECT_EQ(again.up, camera.up);
  }
}

// The longer side is horizontal, the third vertical; a flat cell is seen along that.
TEST(Fit, CellsStandUpright) {
  Scene scene = corners();
  const std::array<Vec3d, 3> sides = {Vec3d(2, 0, 0), Vec3d(0, 9, 0), Vec3d(0, 1, 5)};
  fit_camera_to_cell(scene, sides, false);
  const Vec3d up = normalize(sides[2]), view = Vec3d(scene.camera.at - scene.camera.from);
  EXPECT_NEAR(dot(Vec3d(scene.camera.up), cross(up, view)), 0, 1e-5);
  EXPECT_GT(dot(Vec3d(scene.camera.up), up), 0.9);
  EXPECT_GT(cross(view, Vec3d(scene.camera.up)).y, 0.8 * length(view));
  EXPECT_LT(view.z, 0);  // from above
  fit_camera_to_cell(scene, sides, true);
  EXPECT_NEAR(dot(normalize(Vec3d(scene.camera.at - scene.camera.from)), up), -1, 1e-6);
}

TEST(Fit, ReportsTheGuessedUpAxis) {
  using testing::ElementsAre, testing::IsEmpty;
  Scene scene = corners();
  RenderOptions o;
  EXPECT_THAT(app::camera_warnings(o, scene), IsEmpty());
  o.side = Side::front;
  EXPECT_THAT(app::camera_warnings(o, scene), ElementsAre(HasSubstr("guessed as z,")));
  o.up = Vec3d(0, 0, 1);
  EXPECT_THAT(app::camera_warnings(o, scene), IsEmpty());
  o.up.reset();
  fit_camera(scene, FitView::three_quarter, {0, -1, 0});
  EXPECT_THAT(app::camera_warnings(o, scene), IsEmpty());  // it is upright
}

// A cube of 5 x 5 x 5 spheres.
Scene cube() {
  Scene s = corners();
  s.spheres.clear();
  for (int i = 0; i < 125; ++i)
    s.spheres.push_back({Vec3f(float(i % 5), float(i / 5 % 5), float(i / 25)), 0.5f});
  s.sphere_materials.assign(s.spheres.size(), 0);
  return s;
}

// The fraction of the picture, with edges at -1 and 1, covered by the first 125 spheres.
struct Span {
  double lowest = 1e9, highest = -1e9;

  void add(double at, double radius) {
    lowest = std::min(lowest, at - radius), highest = std::max(highest, at + radius);
  }
  double size() const { return (highest - lowest) / 2; }
  bool is_inside() const { return lowest > -1 && highest < 1; }
};

std::array<Span, 2> part_of_picture(const Scene& scene, const Camera& c) {
  const Vec3d view = Vec3d(c.at) - Vec3d(c.from), forward = normalize(view),
              right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
  std::array<Span, 2> out;
  for (size_t i = 0; i < 125; ++i) {
    const Vec3d p = Vec3d(scene.spheres[i].center) - Vec3d(c.from);
    const double depth = c.is_parallel() ? length(view) : dot(p, forward);
    const auto edge = [&](float degrees) {
      return depth * std::tan(double(degrees) * std::numbers::pi / 360);
    };
    out[0].add(dot(p, right) / edge(c.horizontal_fov_deg), 0.5 / edge(c.horizontal_fov_deg));
    out[1].add(dot(p, up) / edge(c.fov_deg), 0.5 / edge(c.fov_deg));
  }
  return out;
}

// Do they fill the picture?
void expect_full(const Scene& scene, const Camera& camera) {
  const auto [across, up] = part_of_picture(scene, camera);
  EXPECT_TRUE(across.is_inside() && up.is_inside());
  EXPECT_GT(std::max(across.size(), up.size()), 0.85);
}
void expect_tiny(const Scene& scene, const Camera& camera) {
  for (const Span& part : part_of_picture(scene, camera)) EXPECT_LT(part.size(), 0.1);
}

TEST(Fit, MostIgnoresDistantParts) {
  using testing::ElementsAre, testing::IsEmpty;
  const Scene near = cube();
  EXPECT_EQ(part_outside(near, most_of(near)), 0);
  Scene stray = near;
  stray.spheres.push_back({{900, 0, 0}, 0.5f}), stray.sphere_materials.push_back(0);
  Scene ground = near;
  ground.positions = {{-700, -700, -1}, {700, -700, -1}, {700, 700, -1}, {-700, 700, -1}};
  ground.triangles = {{0, 1, 2}, {0, 2, 3}}, ground.triangle_materials = {0, 0};
  Scene globe = near;  // a ground with a near surface and a far centre
  globe.spheres.push_back({{2, 2, -1001}, 1000}), globe.sphere_materials.push_back(0);
  for (Scene* scene : {&stray, &ground, &globe}) {
    const Scene turned = *scene;
    fit_camera(*scene, FitView::three_quarter);
    expect_tiny(*scene, scene->camera);
    for (const char* projection : {"perspective", "orthographic"}) {
      const Camera most = camera_with(*scene, {{"fit", "most"}, {"projection", projection}});
      expect_full(*scene, most);
      EXPECT_LT(
          length(normalize(most.at - most.from) - normalize(scene->camera.at - scene->camera.from)),
          1e-5f);
    }
    for (const auto& [option, value] :
         {std::pair("from", "top"), std::pair("up", "y"), std::pair("up", "1,2,3")})
      expect_full(turned, camera_with(turned, {{"fit", "most"}, {option, value}}));
    RenderOptions o;
    EXPECT_THAT(app::camera_warnings(o, *scene), ElementsAre(HasSubstr("--fit most shows")));
    o.fit = Fit::most;
    EXPECT_THAT(app::camera_warnings(o, *scene), ElementsAre(HasSubstr("camera fit ignores")));
    o.fit = Fit::all;
    EXPECT_THAT(app::camera_warnings(o, *scene), IsEmpty());
    expect_tiny(*scene, camera_of(*scene, o));
  }
  EXPECT_NEAR(most_of(stray).radius, kFarAway * 3.5, kFarAway);
  EXPECT_EQ(part_outside(stray, most_of(stray)), 1.0 / 126);
}

// The camera of a file keeps its direction, whether or not it has an angle.
TEST(Fit, AlongTheCameraOfAFile) {
  for (const float across : {0.0f, 60.0f}) {
    Scene scene = cube();
    scene.camera.horizontal_fov_deg = across;
    EXPECT_EQ(app::camera_warnings({}, scene).size(), 0u);
    const Camera fitted = camera_with(scene, {{"fit", "all"}});
    EXPECT_LT(
        length(normalize(fitted.at - fitted.from) - normalize(scene.camera.at - scene.camera.from)),
        1e-5f);
    expect_full(scene, fitted);
  }
}

// An angle that is given chooses the distance.
TEST(Fit, AllIsInThePictureAtAnyAngle) {
  const Scene scene = cube();
  for (const char* angle : {"5", "60", "120"})
    for (const char* projection : {"perspective", "orthographic"})
      for (const auto& [option, value] : {std::pair("from", "front"), {"fit", "all"}}) {
        const Camera camera =
            camera_with(scene, {{option, value}, {"fov", angle}, {"projection", projection}});
        const auto [across, up] = part_of_picture(scene, camera);
        EXPECT_TRUE(across.is_inside() && up.is_inside()) << angle << option << projection;
        EXPECT_GT(std::max(across.size(), up.size()), 0.6) << angle << option << projection;
        if (!camera.is_parallel()) {
          EXPECT_FLOAT_EQ(camera.fov_deg, std::stof(angle));
        }
      }
}

// A camera that was fitted to data is upright wherever it is put.
TEST(Fit, CamerasKeepTheUpDirection) {
  Scene scene = cube();
  fit_camera(scene, FitView::three_quarter);
  EXPECT_EQ(camera_with(scene, {{"from", "9,0,4"}}).up, Vec3f(0, 0, 1));
}

TEST(Fit, SidesHaveConflicts) {
  Scene scene = corners();
  RenderOptions o;
  o.side = Side::front, o.at = Vec3d(1, 2, 3);
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("cannot be combined with a side"));
  o.at.reset(), o.up = Vec3d();
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("must not be 0"));
  o.up.reset(), o.fit = Fit::most;
  EXPECT_EQ(option_conflict(o, &scene), std::nullopt);
  o.side.reset(), o.from = Vec3d(1, 2, 3);
  EXPECT_THAT(option_conflict(o, &scene)->message,
              HasSubstr("cannot be combined with a camera position"));
  o.from.reset(), o.up = Vec3d();
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("must not be 0"));
  o.up.reset();
  scene.spheres = {}, scene.sphere_materials = {};
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("infinite planes"));
}

}  // namespace
}  // namespace raio::core
