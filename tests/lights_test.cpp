// The scene's lights, its environment and omnidirectional pictures against closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "integrate/camera.h"
#include "integrate/integrators.h"
#include "io/raio/raio.h"
#include "io/scene_file.h"
#include "one_picture.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::expect_one_picture;
using tests::if_sanitized;
using tests::picture_of;
using tests::random_scene;

using std::numbers::pi;
const Vec3f kEye(0.3f, 0.2f, 0.5f);

// A white floor that faces +z, seen at the origin.
Scene lit_floor(const PhysicalLight& light) {
  Scene scene;
  scene.dialect = Dialect::data;
  scene.camera.from = kEye, scene.camera.at = {};
  scene.camera.up = {0, 0, 1}, scene.camera.fov_deg = 0.001f;
  scene.materials = {{.color = Rgb(1), .kd = 1}};
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {0};
  scene.physical_lights = {light};
  return scene;
}

RenderOptions by_lights_only() {
  RenderOptions options;
  options.integrator = IntegratorKind::ambient;
  options.width = options.height = 2;
  options.samples = if_sanitized(256, 4096);
  options.key_light = KeyLight::scene, options.sky_light = Rgb(0);
  return options;
}

Rgb radiance(const Scene& scene, const RenderOptions& options = by_lights_only()) {
  Rgb sum;
  for (const Rgb& pixel : picture_of(scene, options).pixels) sum = sum + pixel / 4;
  return sum;
}

PhysicalLight light_of(LightKind kind, Vec3f position) {
  PhysicalLight light;
  light.kind = kind, light.position = position;
  return light;
}

TEST(Lights, AnIntensityDecreasesWithTheSquareOfTheDistance) {
  PhysicalLight light = light_of(LightKind::point, {1, 0, 2});
  light.color = {10, 5, 1};
  Scene scene = lit_floor(light);
  const double expected = 1 / pi * (2 / std::sqrt(5.0)) / 5;
  const Rgb seen = radiance(scene);
  EXPECT_NEAR(double(seen.x), 10 * expected, 1e-5);
  EXPECT_NEAR(double(seen.y), 5 * expected, 1e-5);
  scene.materials[0] = {.color = {0.5f, 0.2f, 1}, .kd = 0.5f};
  EXPECT_NEAR(double(radiance(scene).y), 5 * expected * 0.1, 1e-5);
  // From below the floor, or behind a sphere, it does not come.
  scene.physical_lights = {light_of(LightKind::point, {0, 0, -1})};
  EXPECT_EQ(radiance(scene), Rgb());
  scene.physical_lights = {light};
  scene.spheres = {{{0.5f, 0, 1}, 0.1f}}, scene.sphere_materials = {0};
  EXPECT_EQ(radiance(scene), Rgb());
  scene.sphere_opacity = std::vector<float>{0.25f};
  EXPECT_NEAR(double(radiance(scene).x), 0.75 * 10 * expected * 0.25, 2e-3);
}

// The border is a cubic in the cosine.
TEST(Lights, ASpotHasACone) {
  const double outer = std::cos(pi / 6), inner = std::cos(pi / 9);  // 30 and 20 degrees
  for (const double degrees : {0.0, 19.0, 22.0, 25.0, 29.0, 31.0, 90.0}) {
    const double angle = degrees * pi / 180;
    PhysicalLight light = light_of(LightKind::spot, {0, 0, 2});
    light.direction = Vec3f(Vec3d(std::sin(angle), 0, -std::cos(angle)) * 3.0);
    light.opening = 60, light.falloff = 10;
    const double t = std::clamp((std::cos(angle) - outer) / (inner - outer), 0.0, 1.0);
    EXPECT_NEAR(double(radiance(lit_floor(light)).x), t * t * (3 - 2 * t) / (4 * pi), 1e-5)
        << degrees;
    light.falloff = 0;
    EXPECT_NEAR(double(radiance(lit_floor(light)).x), degrees < 30 ? 1 / (4 * pi) : 0, 1e-5);
  }
}

TEST(Lights, ADirectionalLightIsItsIrradiance) {
  for (const float diameter : {0.0f, 0.5f, 40.0f}) {
    PhysicalLight light;
    light.kind = LightKind::directional, light.angular_diameter = diameter;
    EXPECT_NEAR(double(radiance(lit_floor(light)).x), 1 / pi, 1e-5) << diameter;
    light.direction = {-1, 0, -1};
    EXPECT_NEAR(double(radiance(lit_floor(light)).x), std::sqrt(0.5) / pi, 2e-4) << diameter;
  }
}

// A sphere of radius r at height h hides a disc of the hemisphere, of radius r / h below it; the
// light is one of radius sin 20 degrees.
TEST(Lights, ADirectionalLightHasPenumbras) {
  PhysicalLight light;
  light.kind = LightKind::directional, light.angular_diameter = 40;
  Scene scene = lit_floor(light);
  scene.camera.from = {3, 2, 0.02f};
  scene.spheres = {{{0, 0, 4}, 0.5f}}, scene.sphere_materials = {0};
  const double sine = std::sin(pi / 9);
  EXPECT_NEAR(double(radiance(scene).x), (1 - 1 / (64 * sine * sine)) / pi, 1e-3);
}

// The form factor of a rectangle parallel to the floor with a corner above the point.
double corner_factor(double a, double b) {
  const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
  return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * pi);
}

TEST(Lights, AQuadHasTheRadianceOfItsFormFactor) {
  PhysicalLight light = light_of(LightKind::quad, {0, 0, 2});
  light.edge1 = {0, 3, 0}, light.edge2 = {2, 0, 0};  // its front is below
  const double expected = corner_factor(1, 1.5);
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), expected, 1e-3);
  light.front = 0, light.back = 1;
  EXPECT_EQ(radiance(lit_floor(light)), Rgb());
  std::swap(light.edge1, light.edge2);
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), expected, 1e-3);
  light.front = 1;
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), expected, 1e-3);
  light.back = 0;
  EXPECT_EQ(radiance(lit_floor(light)), Rgb());
}

TEST(Lights, ARingHasTheRadianceOfItsFormFactor) {
  const auto disc = [](double r) { return r * r / (r * r + 4); };
  PhysicalLight light = light_of(LightKind::ring, {0, 0, 2});
  light.radius = 1.5f;
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), disc(1.5), 1e-3);
  light.inner_radius = 1;
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), disc(1.5) - disc(1), 1e-3);
  light.direction = {0, 0, 1};
  EXPECT_EQ(radiance(lit_floor(light)), Rgb());
  light.direction = {0, 0, -1};
  light.radius = light.inner_radius = 0;  // its colour is an intensity
  EXPECT_NEAR(double(radiance(lit_floor(light)).x), 1 / (4 * pi), 1e-5);
}

// They have no distance and no unit: facing one of intensity I, a surface has the radiance I.
TEST(Lights, NffLightsKeepTheirMeaning) {
  Scene scene = lit_floor({});
  scene.physical_lights = {};
  scene.lights = {{{30, 0, 40}, Rgb(0.5f)}};
  EXPECT_NEAR(double(radiance(scene).x), 0.5 * 0.8, 1e-5);
}

TEST(Lights, AHighlightIsNormalized) {
  Scene scene = lit_floor(light_of(LightKind::point, {1, 0, 2}));
  scene.materials[0].kd = 0, scene.materials[0].ks = 0.5f, scene.materials[0].shine = 10;
  scene.material_specular = {Rgb(1, 0.5f, 0)};
  const Vec3d to_light = normalize(Vec3d(1, 0, 2)), to_eye = normalize(Vec3d(kEye));
  const double cosine = normalize(to_light + to_eye).z;
  const double expected = 18 / (8 * pi) * 0.5 * std::pow(cosine, 10) * (2 / std::sqrt(5.0)) / 5;
  const Rgb seen = radiance(scene);
  EXPECT_NEAR(double(seen.x), expected, 1e-5);
  EXPECT_NEAR(double(seen.y), expected / 2, 1e-5);
  EXPECT_EQ(seen.z, 0);
}

// Next to a light the radiance is large but bounded.
TEST(Lights, SamplesHaveABound) {
  const Scene scene = lit_floor(light_of(LightKind::point, {0, 0, 1e-6f}));
  const double bound = sample_bound(scene, resolve_options(by_lights_only(), scene));
  const auto seen = double(radiance(scene).x);
  EXPECT_TRUE(std::isfinite(bound));
  EXPECT_GT(seen, 1e4);
  EXPECT_LE(seen, bound);
}

// `texel` gives the radiance of a column and row.
template <class F>
Scene surrounded(uint32_t width, uint32_t height, const F& texel) {
  Scene scene = lit_floor({});
  scene.physical_lights = {};
  scene.environment = {{.width = width, .height = height}};
  for (uint32_t row = 0; row < height; ++row)
    for (uint32_t column = 0; column < width; ++column)
      scene.environment_texels.push_back(texel(column, row));
  return scene;
}

TEST(EnvironmentLight, OneColourIsASky) {
  const Scene scene = surrounded(4, 2, [](auto...) { return Rgb(1, 2, 0.5f); });
  RenderOptions options = by_lights_only();
  options.sky_light.reset();  // 1
  const Rgb seen = radiance(scene, options);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], Rgb(1, 2, 0.5f)[c], 1e-5f);
  options.sky_light = Rgb(0.5f);
  EXPECT_NEAR(double(radiance(scene, options).y), 1, 1e-5);
  Scene open = scene;
  open.environment = {}, open.environment_texels = {};
  options.sky_light = Rgb(0.25f, 0.5f, 0.75f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(radiance(open, options)[c], 0.25f * float(c + 1), 1e-5f);
}

// Radiance proportional to the angle from the zenith, 1 at the horizon: its mean with the cosine is
// one half.
TEST(EnvironmentLight, AGradient) {
  const Scene scene =
      surrounded(2, 64, [](auto, uint32_t row) { return Rgb((float(row) + 0.5f) / 32); });
  RenderOptions options = by_lights_only();
  options.sky_light.reset();
  EXPECT_NEAR(double(radiance(scene, options).x), 0.5, 1e-3);
}

RenderOptions all_around(int width, int height) {
  RenderOptions options;
  options.width = width, options.height = height, options.aa = 1;
  options.projection = Projection::omnidirectional, options.integrator = IntegratorKind::ambient;
  return options;
}

// A camera in the middle of an environment sees its picture.
TEST(EnvironmentLight, IsSeenAsItIs) {
  constexpr int kWidth = 12, kHeight = 6;
  Scene scene = surrounded(kWidth, kHeight, [](uint32_t column, uint32_t row) {
    return Rgb(float(column), float(row), float((7 * column + 3 * row) % 5));
  });
  scene.planes = {}, scene.plane_materials = {};
  scene.environment = {
      {.width = kWidth, .height = kHeight, .up = {1, 1, 0}, .direction = {1, -1, 2}}};
  scene.camera.up = {1, 1, 0}, scene.camera.at = scene.camera.from + Vec3f(1, -1, 2);
  const Image image = picture_of(scene, all_around(kWidth, kHeight));
  for (size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(image.pixels[i][c], scene.environment_texels[i][c], 1e-4f) << i;
  // Others see it, or not, on request.
  const auto corner = [&](const RenderOptions& options) {
    return picture_of(scene, options).at(0, 0);
  };
  RenderOptions options = all_around(kWidth, kHeight);
  options.background = WrittenColor{.color = Rgb(3)};
  EXPECT_EQ(corner(options), Rgb(3));
  options.background.reset();
  scene.environment = {{.width = kWidth, .height = kHeight, .visible = 0}};
  EXPECT_EQ(corner(options), params_of(FigureStyle::paper_2).background);
}

TEST(Omnidirectional, DirectionsOfPixels) {
  Camera camera;
  camera.from = {1, 2, 3}, camera.at = {1, 7, 3}, camera.up = {0, 1, 4};  // made perpendicular
  camera.projection = Projection::omnidirectional;
  const EyeRays eye(camera, 360, 180);
  const auto expect = [&](float x, float y, Vec3f dir) {
    const Ray ray = eye.pinhole(x, y);
    EXPECT_EQ(ray.origin, camera.from);
    EXPECT_LT(length(ray.dir - dir), 1e-6f) << x << ' ' << y;
  };
  expect(180, 90, {0, 1, 0});
  expect(270, 90, {1, 0, 0});
  expect(90, 90, {-1, 0, 0});
  expect(0, 90, {0, -1, 0});
  expect(360, 90, {0, -1, 0});
  expect(77, 0, {0, 0, 1});
  expect(77, 180, {0, 0, -1});
  const float diagonal = std::sqrt(0.5f);
  expect(180, 45, {0, diagonal, diagonal});
  expect(225, 90, {diagonal, diagonal, 0});
}

// From its centre a sphere is equally far in all directions.
TEST(Omnidirectional, DepthIsTheDistanceFromTheEye) {
  Scene scene = lit_floor({});
  scene.planes = {}, scene.plane_materials = {};
  scene.spheres = {{scene.camera.from, 3}}, scene.sphere_materials = {0};
  RenderOptions options = all_around(16, 8);
  options.channels.add(Channel::depth);
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  const auto film = make_film(scene, settings);
  WorkControl control;
  ASSERT_TRUE(render(scene, **accel, settings, **film, control).finished);
  const auto depths = (*film)->resolve(Channel::depth);
  for (const float depth : std::get<Column<float>>(depths)) EXPECT_NEAR(depth, 3, 1e-5f);
}

// random_scene() in the light of all kinds, and surrounded.
Scene brightly_lit() {
  Scene scene = random_scene(100, 5);
  for (uint32_t kind = 0; kind < kLightKindNames.size(); ++kind) {
    PhysicalLight light = light_of(LightKind(kind), {float(kind) - 2, -3, 2});
    light.direction = {0.1f, 1, -0.7f}, light.color = {1, 0.5f + float(kind) / 5, 1};
    light.angular_diameter = 5, light.opening = 120, light.falloff = 20, light.radius = 0.5f;
    light.back = 1;
    scene.physical_lights.push_back(light);
  }
  scene.environment = {{.width = 3, .height = 2}};
  scene.environment_texels = {Rgb(1), Rgb(0), Rgb(0.5f), {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return scene;
}

TEST(Lights, AllStructuresGiveOnePicture) {
  RenderOptions options;
  options.width = if_sanitized(16, 40), options.height = if_sanitized(8, 20);
  options.samples = 3, options.integrator = IntegratorKind::ambient;
  for (const Projection projection : {Projection::perspective, Projection::omnidirectional}) {
    options.projection = projection;
    (void)expect_one_picture(brightly_lit(), options);
  }
  options.outline = 2, options.depth_cue = 0.5f, options.background = WrittenColor{.color = Rgb(1)};
  (void)expect_one_picture(brightly_lit(), options);
  options = all_around(40, 20);
  options.integrator = IntegratorKind::classic;
  (void)expect_one_picture(random_scene(100, 5), options);
}

TEST(Lights, AreUsedByDefault) {
  const Scene scene = brightly_lit();
  RenderOptions options;
  options.integrator = IntegratorKind::ambient;
  RenderSettings s = resolve_options(options, scene);
  EXPECT_EQ(s.figure.key_light, KeyLight::scene);
  EXPECT_EQ(s.figure.sky_light, Rgb(1));
  EXPECT_TRUE(s.sees_environment);
  EXPECT_EQ(resolve_options(options_of(s, scene), scene), s);
  options.key_light = KeyLight::off, options.sky_light = Rgb(0.25f);
  options.background = WrittenColor{.color = scene.background};
  s = resolve_options(options, scene);
  EXPECT_FALSE(s.sees_environment);
  EXPECT_EQ(resolve_options(options_of(s, scene), scene), s);
}

std::string conflict(const RenderOptions& options, const Scene& scene) {
  const auto why = option_conflict(options, &scene);
  return why ? why->text() : "";
}

TEST(Lights, OtherIntegratorsRefuseThem) {
  const Scene scene = brightly_lit();
  EXPECT_EQ(conflict({}, scene), "");
  RenderOptions options;
  options.integrator = IntegratorKind::classic;
  EXPECT_EQ(conflict(options, scene),
            "integrator: classic would leave out 5 physical lights, the environment; choose "
            "ambient or path");
  options.integrator = IntegratorKind::ambient;
  EXPECT_EQ(conflict(options, scene), "");
  options.shadow_catcher = true;
  EXPECT_THAT(conflict(options, scene), HasSubstr("shadow-catcher: catches no shadows"));
  options.key_light = KeyLight::on;
  EXPECT_EQ(conflict(options, scene), "");
  options = {};
  options.view = View::normals;
  EXPECT_EQ(conflict(options, scene), "");
}

TEST(Omnidirectional, RefusesLensAndAngle) {
  RenderOptions options = all_around(4, 2);
  options.dof = true;
  const Scene scene = random_scene(4, 1);
  EXPECT_THAT(conflict(options, scene), HasSubstr("dof: a lens needs"));
  EXPECT_TRUE(option_conflict(options));
  options.dof.reset(), options.fov_deg = 50;
  EXPECT_EQ(conflict(options, scene),
            "fov: has no effect with projection omnidirectional; leave one of them out");
  options.fov_deg = 0;
  EXPECT_EQ(conflict(options, scene), "");
  const RenderSettings s = resolve_options(options, scene);
  EXPECT_FALSE(s.dof);
  EXPECT_EQ(resolve_options(options_of(s, scene), scene), s);
}

TEST(Lights, SkyLightIsANumberOrAColour) {
  RenderOptions options;
  const OptionSpec& sky = option_of("sky-light");
  ASSERT_TRUE(set_option(options, sky, "0.5"));
  EXPECT_EQ(options.sky_light, Rgb(0.5f));
  EXPECT_EQ(sky.text(options), "0.5");
  ASSERT_TRUE(set_option(options, sky, "1,2.5,0"));
  EXPECT_EQ(options.sky_light, Rgb(1, 2.5f, 0));
  EXPECT_EQ(sky.text(options), "1,2.5,0");
  ASSERT_TRUE(set_option(options, sky, "white"));
  EXPECT_EQ(options.sky_light, Rgb(1));
  for (const char* wrong : {"", "bright", "1,2", "-1", "1,1,nan", "1e7", "transparent"})
    EXPECT_THAT(set_option(options, sky, wrong).error().text(),
                HasSubstr("sky-light: expected a number, or a colour"))
        << wrong;
}

TEST(Lights, AreStoredByRaioAlone) {
  Scene scene = brightly_lit();
  scene.camera.projection = Projection::omnidirectional;
  ASSERT_THAT(validate(scene), testing::IsEmpty());
  const auto again = decode_raio_scene(encode_raio_scene(scene), nullptr);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(content_hash(*again), content_hash(scene));
  EXPECT_EQ(again->physical_lights[3].edge2, scene.physical_lights[3].edge2);
  EXPECT_TRUE(again->camera.is_omnidirectional());
  for (const SceneFormat format :
       {SceneFormat::nff, SceneFormat::pov, SceneFormat::ply, SceneFormat::gltf}) {
    // glTF has points, spots and directional lights without a size.
    EXPECT_THAT(lost_features(scene, format),
                HasSubstr(format == SceneFormat::gltf ? "3 physical lights" : "5 physical lights"));
    EXPECT_THAT(lost_features(scene, format), HasSubstr("the environment"));
    EXPECT_EQ(lost_features(scene, format).contains("in all directions"),
              format != SceneFormat::ply);
  }
}

TEST(Lights, InvalidOnesAreNamed) {
  const auto problem = [](auto&& spoil) {
    Scene scene = brightly_lit();
    spoil(scene);
    const auto problems = validate(scene);
    return problems.empty() ? "" : problems.front();
  };
  EXPECT_EQ(problem([](Scene& s) { s.physical_lights[1].direction = {}; }),
            "physical light 1: the direction must be finite and not zero");
  EXPECT_THAT(problem([](Scene& s) { s.physical_lights[1].angular_diameter = 171; }),
              HasSubstr("angular diameter"));
  EXPECT_THAT(problem([](Scene& s) { s.physical_lights[2].falloff = 61; }), HasSubstr("falloff"));
  EXPECT_THAT(problem([](Scene& s) { s.physical_lights[3].edge2 = {2, 0, 0}; }),
              HasSubstr("the edges must be finite and span an area"));
  EXPECT_THAT(problem([](Scene& s) { s.physical_lights[3].front = s.physical_lights[3].back = 0; }),
              HasSubstr("a side"));
  EXPECT_THAT(problem([](Scene& s) { s.physical_lights[4].inner_radius = 0.5f; }),
              HasSubstr("inner radius"));
  EXPECT_THAT(problem([](Scene& s) { s.environment[0].height = 3; }),
              HasSubstr("there are 6 texels, expected 9"));
  EXPECT_THAT(problem([](Scene& s) { s.environment_texels[2].y = -1; }), HasSubstr("texel 2"));
  EXPECT_THAT(problem([](Scene& s) { s.environment[0].up = {2, 0, 0}; }), HasSubstr("parallel"));
}

}  // namespace
}  // namespace raio::core
