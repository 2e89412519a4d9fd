// Legends of views, and values read from their colours.
#include "view/legend.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "integrate/views.h"
#include "io/nff/nff.h"
#include "render/render.h"
#include "view/state.h"
#include "view_scenes.h"

namespace raio::core::view {
namespace {

using testing::HasSubstr;

TEST(Legend, HasAScaleForEveryViewButThePicture) {
  ViewState state("some.nff", scene(), {});
  for (int view = 0; view < kViews; ++view) {
    state.show(View(view));
    EXPECT_EQ(legend_of(state).title.empty(), View(view) == View::picture) << view;
  }
  state.show(View::steps);
  const Legend steps = legend_of(state);
  ASSERT_EQ(steps.stops.size(), 7u);
  for (const Legend::Stop& stop : steps.stops)
    EXPECT_EQ(stop.color, heat_color(std::atof(stop.label.c_str()))) << stop.label;
  state.show(View::depth);
  const double distance = length(Vec3d(camera().at) - Vec3d(camera().from));
  const Legend depth = legend_of(state);
  ASSERT_EQ(depth.stops.size(), 5u);
  for (size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(depth.stops[i].color.x,
                distance / (distance + std::atof(depth.stops[i].label.c_str())), 2e-3);
}

TEST(Legend, ReadsCountsBackFromColours) {
  for (const double count : {0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 7.0, 16.0, 100.0, 256.0, 900.0, 1024.0})
    EXPECT_NEAR(heat_count(heat_color(count)), count, 1e-3 * count + 1e-6);
  EXPECT_EQ(heat_count(heat_color(5000)), 1024);
}

TEST(ReadOut, ShowsTheValueWithUnitAndTheHit) {
  const auto read = parse_nff(
      "b 0 0 0\nv\nfrom 0 -4 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 9 9\n"
      "f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n",
      "ball");
  const auto ball = std::make_shared<const Scene>(read->scene);
  ViewState state("ball.nff", ball, {});
  const auto accel = build_accel(*ball, {});
  const Pick middle = pick(**accel, state.camera, 0.5, 0.5, 1), none;
  const auto at = [&](View view, const Pick& what, Rgb color) {
    state.show(view);
    return read_out(state, what, accel->get(), color, 100);
  };
  EXPECT_EQ(at(View::picture, middle, Rgb(1, 0, 0)).text,
            "#ff0000 \xc2\xb7 sphere 0 \xc2\xb7 distance 3");
  EXPECT_EQ(at(View::picture, none, Rgb()).text, "#000000 \xc2\xb7 background");
  EXPECT_THAT(at(View::depth, middle, Rgb(0.5f)).text, HasSubstr("depth 3 "));
  EXPECT_NEAR(at(View::depth, middle, Rgb(0.5f)).at.value(), 3.0 / 7, 1e-6);
  EXPECT_THAT(at(View::materials, middle, Rgb()).text, HasSubstr("material 0"));
  EXPECT_THAT(at(View::tests, middle, heat_color(1)).text, HasSubstr("1 primitive tested"));
  EXPECT_THAT(at(View::tests, middle, heat_color(12)).text, HasSubstr("12 primitives tested"));
  EXPECT_THAT(at(View::tests, middle, heat_color(6248)).text,
              HasSubstr(">= 1024 primitives tested"));
  EXPECT_THAT(at(View::normals, middle, Rgb(0.5f, 0, 0.5f)).text,
              HasSubstr("normal 0.00 -1.00 0.00"));
  state.options.focus = 3, state.options.aperture = 0.5f, state.options.dof = true;
  EXPECT_THAT(at(View::focus, middle, Rgb()).text, HasSubstr("blur 0 pixels"));
  EXPECT_EQ(at(View::focus, middle, Rgb()).at, 0.5);
  state.options.focus = 6;
  // 2 R |z - F| / z on a plane in focus that is 2 F tan(20 degrees) high.
  const double blur = 2 * 0.5 * 3 / 3 / (12 * std::tan(20 * std::numbers::pi / 180)) * 100;
  EXPECT_THAT(at(View::focus, middle, Rgb()).text,
              HasSubstr(fmt::format("blur {:.3g} pixels", blur)));
  EXPECT_EQ(at(View::focus, middle, Rgb()).at, 0.0);
}

TEST(HeatColor, GrowsByFactorsOfFour) {
  EXPECT_EQ(heat_color(0), Rgb(0, 0, 0));
  EXPECT_EQ(heat_color(1), Rgb(0, 0, 1));
  EXPECT_EQ(heat_color(16), Rgb(0, 1, 0));
  EXPECT_EQ(heat_color(256), Rgb(1, 0, 0));
  EXPECT_EQ(heat_color(1e9), Rgb(1, 1, 1));
  EXPECT_GT(heat_color(8).y, heat_color(5).y - 1e-6f);
}

TEST(Views, ShowsTheHitsOfTheRay) {
  const auto read = parse_nff(
      "b 0 0 0\nv\nfrom 0 -4 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 9 9\n"
      "f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n",
      "ball");
  ASSERT_TRUE(read);
  const Scene& s = read->scene;
  WorkControl control;
  const auto middle = [&](View view, auto... change) {
    RenderOptions o;
    o.view = view;
    (change(o), ...);
    const RenderSettings settings = resolve_options(o, s);
    const auto accel = build_accel(s, settings.accel);
    const auto film = make_film(s, settings);
    EXPECT_TRUE(render(s, **accel, settings, **film, control).finished);
    const Image image = picture_of(**film, view);
    if (view != View::tests && view != View::steps) {
      EXPECT_EQ(image.at(0, 0), Rgb());
    }
    return image.at(4, 4);
  };
  EXPECT_LE(length(middle(View::normals) - Rgb(0.5f, 0, 0.5f)), 1e-5f);
  EXPECT_NEAR(middle(View::depth).x, 4.0 / 7, 1e-5);
  const auto focus_at = [](float d) {
    return [d](RenderOptions& o) { o.focus = d, o.aperture = 0.5f; };
  };
  const Rgb sharp = middle(View::focus, focus_at(3)), front = middle(View::focus, focus_at(30)),
            behind = middle(View::focus, focus_at(1));
  EXPECT_GT(sharp.y, std::max(sharp.x, sharp.z));
  EXPECT_GT(front.x, front.z);
  EXPECT_GT(behind.z, behind.x);
  const auto none = [](RenderOptions& o) { o.accel.kind = AccelKind::none; };
  EXPECT_EQ(middle(View::tests, none), heat_color(1));
  // The cost of a ray by itself, however many are traced together.
  EXPECT_EQ(middle(View::tests), heat_color(1));
  EXPECT_EQ(middle(View::steps), heat_color(1));
}

}  // namespace
}  // namespace raio::core::view
