// What is behind the window, without one: the camera in the hand, the state, the views.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "integrate/views.h"
#include "io/nff/nff.h"
#include "render/render.h"
#include "scenes.h"
#include "view/camera_control.h"
#include "view/comparison.h"
#include "view/costs_panel.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::view {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Camera camera() {
  Camera c;
  c.from = {1, -6, 2}, c.at = {0, 0, 0.5f}, c.up = {0, 0, 1}, c.fov_deg = 40;
  return c;
}

double distance(Vec3d a, Vec3f b) { return length(a - Vec3d(b)); }

// Where a point is in the picture: right and up of its centre in half heights, and its depth.
Vec3d seen(const Camera& c, Vec3d point) {
  const CameraAxes axes(c);
  const Vec3d to = point - Vec3d(c.from);
  const double depth = dot(to, axes.forward);
  const double half = depth * std::tan(double(c.fov_deg) * std::numbers::pi / 360);
  return {dot(to, axes.right) / half, dot(to, axes.up) / half, depth};
}

void expect_near(Vec3d a, Vec3d b, double error = 1e-4) {
  EXPECT_LE(length(a - b), error) << a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y
                                  << ' ' << b.z;
}

TEST(CameraControl, OrbitsAboutAPointThatStaysWhereItIs) {
  const Vec3d pivot(0.3, -0.5, 0.8);
  const Camera before = camera();
  for (const auto& [right, up] : {std::pair(0.4, 0.0), {0.0, 0.3}, {-1.0, -0.2}, {3.0, 0.1}}) {
    const Camera after = orbited(before, pivot, right, up);
    EXPECT_NEAR(distance(pivot, after.from), distance(pivot, before.from), 1e-4);
    expect_near(seen(after, pivot), seen(before, pivot));
    EXPECT_EQ(after.up, before.up);
  }
  // To the right and upwards, as told.
  const CameraAxes axes(before);
  EXPECT_GT(dot(Vec3d(orbited(before, pivot, 0.2, 0).from) - Vec3d(before.from), axes.right), 0.1);
  EXPECT_GT(dot(Vec3d(orbited(before, pivot, 0, 0.2).from) - Vec3d(before.from), axes.up), 0.1);
}

TEST(CameraControl, StopsShortOfThePoles) {
  Camera c = camera();
  for (int i = 0; i < 100; ++i) c = orbited(c, Vec3d(c.at), 0.1, 0.3);
  EXPECT_EQ(camera_problem(c), "");
  EXPECT_LT(CameraAxes(c).forward.z, -0.99);
  for (int i = 0; i < 100; ++i) c = looked(c, 0.1, 0.3);
  EXPECT_EQ(camera_problem(c), "");
  EXPECT_GT(CameraAxes(c).forward.z, 0.99);
}

TEST(CameraControl, PansWhatIsAtTheDepthWithTheHand) {
  const Camera before = camera();
  const Vec3d point(0.5, 0, 1);
  const Vec3d at = seen(before, point);
  const Camera after = panned(before, at.z, 0.25, 0.1);
  expect_near(seen(after, point), at + Vec3d(0.5, 0.2, 0));
}

TEST(CameraControl, DolliesAboutWhatIsUnderTheCursor) {
  const Camera before = camera();
  const Vec3d target(0.8, -1, 1.2);
  const Vec3d at = seen(before, target);
  for (const double factor : {0.5, 0.9, 1.3}) {
    const Vec3d now = seen(dollied(before, target, factor), target);
    expect_near(now, {at.x, at.y, at.z * factor});
  }
  EXPECT_EQ(camera_problem(dollied(before, target, 1e-3)), "");
}

TEST(CameraControl, WalksAlongItsOwnAxes) {
  const Camera before = camera();
  const CameraAxes axes(before);
  const Camera after = walked(before, 1, 2, 3);
  const Vec3d move = axes.right + axes.up * 2 + axes.forward * 3;
  expect_near(Vec3d(after.from) - Vec3d(before.from), move);
  expect_near(Vec3d(after.at) - Vec3d(before.at), move);
}

TEST(CameraControl, FitsTheWholeBox) {
  Box3f box;
  box.extend(Vec3f(-3, 1, 0)), box.extend(Vec3f(5, 2, 9));
  for (const double aspect : {0.5, 1.0, 2.0}) {
    const Camera after = fitted(camera(), box, aspect);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d at =
          seen(after, {corner & 1 ? -3.0 : 5.0, corner & 2 ? 1.0 : 2.0, corner & 4 ? 0.0 : 9.0});
      EXPECT_GT(at.z, 0);
      EXPECT_LE(std::abs(at.x), aspect);
      EXPECT_LE(std::abs(at.y), 1);
    }
  }
  EXPECT_EQ(fitted(camera(), {}, 1).from, camera().from);
}

std::shared_ptr<const Scene> scene() {
  Scene s = raio::testing::random_scene(20, 3);
  s.camera = camera();
  s.name = "some";
  return std::make_shared<const Scene>(std::move(s));
}

// The options that a command line of the state would give; they must fit together.
RenderOptions read_back(const ViewState& state, int samples) {
  const std::string arguments = option_arguments(state.request(64, 48, samples));
  RenderOptions o;
  for (size_t at = 0; (at = arguments.find("--", at)) != std::string::npos;) {
    const size_t end = std::min(arguments.find(" --", at), arguments.size());
    const std::string one = arguments.substr(at + 2, end - at - 2);
    const size_t space = std::min(one.find(' '), one.size());
    bool known = false;
    for (const OptionSpec& spec : render_option_table()) {
      const bool no = one == "no-" + std::string(spec.name) && spec.name != "no-reflection";
      if (one.substr(0, space) != spec.name && !no) continue;
      std::string text = space < one.size() ? one.substr(space + 1) : no ? "false" : "true";
      std::erase(text, '\'');
      EXPECT_TRUE(set_option(o, spec, text)) << one;
      known = true;
    }
    EXPECT_TRUE(known) << one;
    at = end;
  }
  const auto conflict = option_conflict(o, state.scene.get());
  EXPECT_FALSE(conflict) << arguments << conflict->text();
  return o;
}

TEST(ViewState, EveryStateIsACommandLine) {
  ViewState state("some.nff", scene(), {});
  state.focus_at(3.7f);
  state.scale_aperture(1.21f);
  state.options.light_size = 0.3f, state.options.accel.grid_factor = 1.5f;
  state.options.background = parse_color("#ff8000").value();
  state.options.exposure = -1.5f, state.options.tone = Tone::agx;
  for (unsigned i = 0; i < 512; ++i) {
    ViewState s = state;
    for (unsigned effect = 0; effect < 6; ++effect)
      if (i >> effect & 1) (void)s.toggle(Command(effect));
    if (i & 64) s.camera = orbited(s.camera, {}, 0.1 * i, 0.05);
    if (i & 128) s.show(View(i % kViews));
    if (i & 256) s.options.aa = 3, s.options.lens_samples = 2;
    if (s.options.accel.kind == AccelKind::embree && s.options.view != View::picture) continue;
    const RenderOptions o = read_back(s, 5), wanted = s.request(64, 48, 5);
    EXPECT_EQ(option_arguments(o), option_arguments(wanted));
    const Camera a = camera_of(*s.scene, o);
    EXPECT_EQ(a.from, s.camera.from);
    EXPECT_EQ(a.at, s.camera.at);
  }
}

TEST(ViewState, CamerasFarAwayReadBackToTheSameBits) {
  Scene far = *scene();
  far.origin = {123456.5, -98765.25, 4096};
  const auto shared = std::make_shared<const Scene>(far);
  ViewState state("far.nff", shared, {});
  for (int i = 0; i < 100; ++i) {
    state.camera = orbited(state.camera, {0.1, 0.2, 0.3}, 0.7, i % 2 ? 0.1 : -0.13);
    const Camera back = camera_of(far, read_back(state, 1));
    EXPECT_EQ(back.from, state.camera.from);
    EXPECT_EQ(back.at, state.camera.at);
  }
}

TEST(ViewState, SaysWhatKeysDid) {
  ViewState state("some.nff", scene(), {});
  EXPECT_EQ(state.toggle(Command::antialiasing), "antialiasing on");
  EXPECT_EQ(state.toggle(Command::antialiasing), "antialiasing off");
  EXPECT_EQ(state.toggle(Command::structure), "structure grid");
  EXPECT_EQ(state.toggle(Command::reflection), "reflection off");
  EXPECT_EQ(state.command_line(64, 48, 1, "a b.png"),
            "raio render some.nff --size 64x48 --accel grid --aa 1 --no-reflection -o 'a b.png'");
}

TEST(ViewState, TheOtherPictureDiffersInTheLastEffect) {
  ViewState state("some.nff", scene(), {});
  (void)state.toggle(Command::soft_shadows);
  EXPECT_TRUE(state.request(8, 8).soft_shadows);
  EXPECT_FALSE(state.other_request(8, 8).soft_shadows);
  (void)state.toggle(Command::refraction);
  EXPECT_FALSE(state.other_request(8, 8).no_refraction);
}

TEST(ViewState, ANewVersionOfTheFileKeepsTheHandsCamera) {
  ViewState state("some.nff", scene(), {});
  Scene next = *scene();
  next.camera.from = {0, -9, 1};
  state.open("some.nff", std::make_shared<const Scene>(next));
  EXPECT_EQ(state.camera.from, next.camera.from) << "it was the scene's";
  state.camera = walked(state.camera, 1, 0, 0);
  const Vec3f walked_to = state.camera.from;
  state.open("some.nff", scene());
  EXPECT_EQ(state.camera.from, walked_to);
  state.open("other.nff", scene());
  EXPECT_EQ(state.camera.from, camera().from);
}

TEST(ViewState, RefiningEnds) {
  ViewState state("some.nff", scene(), {});
  (void)state.toggle(Command::soft_shadows);
  EXPECT_EQ(state.request(8, 8).samples, kRefineSamples);
  state.options.samples = 5000;
  EXPECT_EQ(state.request(8, 8).samples, 5000);
}

SessionPicture timed_picture(uint64_t request, double seconds, int width = 64) {
  SessionPicture p;
  p.request = request, p.samples = 1, p.settings.width = width, p.settings.height = 48;
  p.sample_s = {seconds, seconds, seconds};
  return p;
}

TEST(Comparison, ComparesWholeSamplesOfOneSize) {
  Comparison c;
  const SessionPicture before = timed_picture(1, 0.028), after = timed_picture(2, 0.05);
  EXPECT_EQ(c.begin("structure bvh", &before, 1), "structure bvh: waits for a whole sample");
  EXPECT_FALSE(c.take(before, 2));
  SessionPicture preview = after;
  preview.samples = 0;
  EXPECT_FALSE(c.take(preview, 2));
  SessionPicture untimed = after;
  untimed.sample_s = {};
  EXPECT_FALSE(c.take(untimed, 2));
  EXPECT_EQ(c.take(after, 2), "structure bvh: 50 ms a sample, before 28 ms");
  EXPECT_FALSE(c.take(after, 2)) << "said once";

  (void)c.begin("structure bvh", &before, 1);
  EXPECT_EQ(c.take(timed_picture(2, 0.05, 65), 2),
            "structure bvh: 50 ms a sample, before another size");
}

TEST(Comparison, PreviewsAndOlderPicturesDoNotCount) {
  Comparison c;
  SessionPicture preview = timed_picture(1, 0.028);
  preview.samples = 0;
  const SessionPicture older = timed_picture(1, 0.028), after = timed_picture(3, 0.05);
  for (const auto& [before, request] :
       {std::pair<const SessionPicture*, uint64_t>(nullptr, 1), {&preview, 1}, {&older, 2}}) {
    (void)c.begin("structure bvh", before, request);
    EXPECT_EQ(c.take(after, 3), "structure bvh: 50 ms a sample, no whole sample before");
  }
  (void)c.begin("structure bvh", &older, 1);
  c.end();
  EXPECT_FALSE(c.take(after, 3));
}

TEST(Costs, LinesSayWhatIsMeasuredAndWhatIsCounted) {
  EffectCost c{.effect = Effect::soft_shadows, .rounds = 5};
  c.factor = {1.75, 1.83, 1.9};
  c.with.seconds = 0.0511, c.without.seconds = 0.028;
  c.with.rays = {.eye = 100, .shadow = 250, .tests = 900, .steps = 40};
  c.without.rays = {.eye = 100, .shadow = 100, .tests = 300, .steps = 20};
  EXPECT_EQ(cost_line(c), "soft shadows: 1.83 x ±4%; 51.1 ms, without 28 ms; rays 1.75 x");
  c.with.has_steps = c.without.has_steps = true;
  EXPECT_THAT(cost_line(c), HasSubstr("rays 1.75 x, tests 3.00 x, steps 2.00 x"));
  c.presence = EffectCost::not_in_scene;
  EXPECT_EQ(cost_line(c), "soft shadows: not in this scene");
  c.presence = EffectCost::not_in_picture;
  EXPECT_EQ(cost_line(c), "soft shadows: not in this picture");
}

TEST(Costs, EachEffectHasItsKey) {
  for (const Effect effect : kEffects) EXPECT_EQ(effect_of(command_of(effect)), effect);
}

TEST(Keys, EachIsThereOnce) {
  std::set<std::pair<int, bool>> seen_keys;
  for (const KeySpec& key : key_table()) {
    EXPECT_TRUE(seen_keys.emplace(key.key, key.shift).second) << key.name;
    EXPECT_EQ(find_key(key.key, key.shift), &key);
  }
  EXPECT_EQ(find_key('Z', false), nullptr);
}

TEST(Stage, FillsTheAreaOrShowsAGivenSizeWhole) {
  const Stage free({800, 500}, 300, 2, 0, 0);
  EXPECT_EQ(free.picture_width, 1000);
  EXPECT_EQ(free.picture_height, 1000);
  EXPECT_TRUE(free.contains(499, 499));
  EXPECT_FALSE(free.contains(500, 10));
  const Stage given({800, 500}, 300, 1, 1000, 500);
  EXPECT_EQ(given.picture_width, 1000);
  EXPECT_EQ(given.hi.x - given.lo.x, 500);
  EXPECT_EQ(given.lo.y, 125);
  EXPECT_FALSE(given.sharp);
  EXPECT_TRUE(Stage({700, 500}, 300, 1, 400, 300).sharp);
  const Stage none({10, 0}, 300, 1, 0, 0);
  EXPECT_GE(none.picture_width * none.picture_height, 1);
}

TEST(HeatColor, GrowsByFactorsOfFour) {
  EXPECT_EQ(heat_color(0), Rgb(0, 0, 0));
  EXPECT_EQ(heat_color(1), Rgb(0, 0, 1));
  EXPECT_EQ(heat_color(16), Rgb(0, 1, 0));
  EXPECT_EQ(heat_color(256), Rgb(1, 0, 0));
  EXPECT_EQ(heat_color(1e9), Rgb(1, 1, 1));
  EXPECT_GT(heat_color(8).y, heat_color(5).y - 1e-6f);
}

TEST(Views, ShowsWhatTheRayMeets) {
  const auto read = parse_nff(
      "b 0 0 0\nv\nfrom 0 -4 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 9 9\n"
      "f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n",
      "ball");
  ASSERT_TRUE(read);
  const Scene& s = read->scene;
  RenderControl control;
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
  // What a ray costs by itself, however many are traced at a time.
  EXPECT_EQ(middle(View::tests), heat_color(1));
  EXPECT_EQ(middle(View::steps), heat_color(1));
}

TEST(Quoted, IsWhatAShellReadsBack) {
  EXPECT_EQ(quoted("plain-1.nff"), "plain-1.nff");
  EXPECT_EQ(quoted("two words"), "'two words'");
  EXPECT_EQ(quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(quoted(""), "''");
}

}  // namespace
}  // namespace raio::view
