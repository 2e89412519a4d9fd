// What is behind the window, without one: the camera in the hand, the state, the views.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <regex>
#include <set>

#include "integrate/views.h"
#include "io/file.h"
#include "io/nff/nff.h"
#include "render/render.h"
#include "scenes.h"
#include "view/bars.h"
#include "view/camera_control.h"
#include "view/comparison.h"
#include "view/costs_panel.h"
#include "view/edit.h"
#include "view/file_dialog.h"
#include "view/gestures.h"
#include "view/help.h"
#include "view/history.h"
#include "view/layout.h"
#include "view/legend.h"
#include "view/memory.h"
#include "view/stage.h"
#include "view/state.h"
#include "view/texts.h"

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
  std::set<std::pair<int, Modifiers>> seen_keys;
  for (const KeySpec& key : key_table()) {
    EXPECT_TRUE(seen_keys.emplace(key.key, key.held).second) << key.name;
    EXPECT_EQ(find_key(key.key, key.held), &key);
  }
  EXPECT_EQ(find_key('Z'), nullptr);
}

TEST(Keys, LettersAreNotThoseWithCtrlOrAlt) {
  EXPECT_EQ(find_key('S')->command, Command::soft_shadows);
  EXPECT_EQ(find_key('S', {.ctrl = true})->command, Command::save_scene);
  EXPECT_EQ(find_key('O', {.ctrl = true})->command, Command::open);
  EXPECT_EQ(find_key('Z', {.ctrl = true})->command, Command::undo);
  EXPECT_EQ(find_key('Y', {.ctrl = true})->command, Command::redo);
  EXPECT_EQ(find_key('Z', {.shift = true, .ctrl = true})->command, Command::redo);
  EXPECT_EQ(find_key('A', {.ctrl = true}), nullptr);
  EXPECT_EQ(find_key('A', {.alt = true}), nullptr);
  EXPECT_EQ(find_key('A', {.shift = true}), nullptr);
}

TEST(Layout, PartsCoverTheWindowAndDoNotOverlap) {
  for (const auto& [width, height] : {std::pair(1280.0f, 720.0f), {1920.0f, 1080.0f}, {460, 300}})
    for (const float em : {15.0f, 23.0f, 30.0f})
      for (const bool panel : {true, false}) {
        const Layout l(width, height, em, panel);
        EXPECT_EQ(l.tool_bar, Rect(0, 0, width, l.picture.top));
        EXPECT_EQ(l.status, Rect(0, l.picture.bottom, width, height));
        EXPECT_EQ(l.picture.left, 0);
        EXPECT_EQ(l.panel, Rect(l.picture.right, l.picture.top, width, l.picture.bottom));
        EXPECT_GE(l.picture.width(), 1);
        EXPECT_GE(l.picture.height(), 1);
        if (!panel) {
          EXPECT_EQ(l.picture.right, width);
        } else if (width > 1000) {
          EXPECT_GT(l.picture.width(), width / 3);
        }
        // Whole units, so that pixels of the picture stay those of the screen.
        EXPECT_EQ(l.picture.top, std::floor(l.picture.top));
        EXPECT_EQ(l.picture.right, std::floor(l.picture.right));
      }
  const Layout tiny(10, 10, 15, true);
  EXPECT_GE(tiny.picture.width(), 1);
  EXPECT_GE(tiny.picture.height(), 1);
}

TEST(Layout, ToolsThatDoNotFitAreLeftToOneMore) {
  const std::vector<float> widths = {30, 40, 30};
  EXPECT_EQ(tools_that_fit(widths, 100, 30), 3u);
  EXPECT_EQ(tools_that_fit(widths, 99, 30), 1u);  // the second would leave no room for one more
  EXPECT_EQ(tools_that_fit(widths, 60, 30), 1u);
  EXPECT_EQ(tools_that_fit(widths, 20, 30), 0u);
  EXPECT_EQ(tools_that_fit({}, 20, 30), 0u);
}

TEST(History, GoesBackAndForthAndForgetsWhatWasUndoneBeforeAChange) {
  History<int> history(0);
  EXPECT_FALSE(history.can_undo());
  EXPECT_EQ(history.undo(), 0);
  for (const int state : {1, 1, 2, 3}) history.settle(state);
  EXPECT_EQ(history.undo(), 2);
  EXPECT_EQ(history.undo(), 1);
  EXPECT_EQ(history.redo(), 2);
  history.settle(7);
  EXPECT_FALSE(history.can_redo());
  EXPECT_EQ(history.redo(), 7);
  EXPECT_EQ(history.undo(), 2);
  EXPECT_EQ(history.undo(), 1);
  EXPECT_EQ(history.undo(), 0);
  for (int i = 0; i < 5000; ++i) history.settle(i + 10);
  int steps = 0;
  for (; history.can_undo(); ++steps) (void)history.undo();
  EXPECT_EQ(steps, 999) << "all are kept, or none forgotten";
}

TEST(History, EveryChangeOfTheStateIsAStep) {
  ViewState state("some.nff", scene(), {});
  History<ViewState> history(state);
  for (const Command effect :
       {Command::antialiasing, Command::soft_shadows, Command::depth_of_field, Command::structure,
        Command::reflection, Command::refraction}) {
    const ViewState before = state;
    (void)state.toggle(effect);
    history.settle(state);
    EXPECT_EQ(history.undo(), before);
    EXPECT_EQ(history.redo(), state);
  }
  const ViewState before = state;
  state.camera = walked(state.camera, 1, 0, 0);
  EXPECT_FALSE(state == before);
  state = before;
  state.show(View::depth);
  EXPECT_FALSE(state == before);
  state = before;
  state.paused = !state.paused, state.panel = !state.panel;
  EXPECT_TRUE(state == before) << "what is hidden or paused is no step";
}

TEST(Focus, FollowsThePointWhenTheCameraMoves) {
  ViewState state("some.nff", scene(), {});
  const Vec3d point(0.3, 0.2, 0.4);
  state.focus_on(point);
  EXPECT_TRUE(state.is_on(Command::depth_of_field));
  for (const double factor : {0.8, 0.5, 1.7}) {
    state.camera = dollied(state.camera, point, factor);
    state.follow_focus();
    EXPECT_NEAR(state.options.focus, seen(state.camera, point).z, 1e-4);
  }
  state.camera = orbited(state.camera, {1, 1, 1}, 0.3, 0.1);
  state.follow_focus();
  EXPECT_NEAR(state.options.focus, seen(state.camera, point).z, 1e-4);
  // Someone types another one: it stays.
  state.options.focus = 2.5f;
  state.camera = dollied(state.camera, point, 0.9);
  state.follow_focus();
  EXPECT_EQ(state.options.focus, 2.5f);
  EXPECT_FALSE(state.focus_point);
}

// A hand that holds on to ground at the horizon.
TEST(Gestures, NoDragFlingsTheSceneAway) {
  for (const double times : {0.3, 1.0, 2.0, 30.0, 1e6})
    for (const auto button : {Gestures::Button::left, Gestures::Button::middle}) {
      ViewState state("some.nff", scene(), {});
      const Stage stage({0, 0, 512, 512}, 1, 512, 512);
      const Camera before = state.camera;
      const double distance = length(Vec3d(before.at) - Vec3d(before.from));
      Vec3d held;
      Gestures hand(state, stage, [&](double x, double y) {
        const CameraAxes axes(before);
        const double half = std::tan(double(before.fov_deg) * std::numbers::pi / 360);
        Pick pick;
        pick.hit = {}, pick.hit.item = 1, pick.hit.t = 1;
        pick.depth = times * distance;
        pick.point = Vec3d(before.from) + (axes.forward + axes.right * ((x / 256 - 1) * half) +
                                           axes.up * ((1 - y / 256) * half)) *
                                              pick.depth;
        held = pick.point;
        return pick;
      });
      hand.move(200, 300);
      hand.press(button, false);
      for (int i = 1; i <= 10; ++i) hand.move(200 + 10 * i, 300 + 2 * i);
      (void)hand.release(button);
      EXPECT_FALSE(state.camera == before);
      // What is near is held itself; what is far moves the point looked at.
      const Vec3d at = seen(state.camera, times < 1 ? held : Vec3d(before.at));
      EXPECT_GT(at.z, 0) << times;
      EXPECT_LE(std::abs(at.x), 1) << times;
      EXPECT_LE(std::abs(at.y), 1) << times;
      EXPECT_NEAR(at.z, std::min(times, 1.0) * distance, 0.5 * distance) << times;
    }
}

TEST(Help, FindsAllWordsInAnyCase) {
  EXPECT_EQ(help_lines("").size(),
            size_t(std::ranges::count_if(key_table(), [](auto& k) { return *k.name != 0; })) +
                hand_table().size());
  const auto found = help_lines("SHADOWS soft");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].keys, "s");
  EXPECT_TRUE(help_lines("no such thing").empty());
}

TEST(Status, SaysWhatGoesOn) {
  StatusFacts facts;
  facts.request = 2, facts.since_request_s = 6.2;
  EXPECT_EQ(status_of(facts).text, "Rendering the first sample, 6 s");
  facts.progress = SessionProgress{SessionProgress::sample, 3, 0.25, 9};
  EXPECT_EQ(status_of(facts).text, "Rendering the first sample: 25 %, 9 s left");
  SessionPicture picture;
  picture.request = 2, picture.samples = 1, picture.sample_s = {0.05, 0.05, 0.05};
  picture.settings.samples = 64;
  facts.picture = &picture;
  EXPECT_EQ(status_of(facts).kind, Status::Kind::working);
  EXPECT_THAT(status_of(facts).text, HasSubstr("1 of 64 samples a pixel"));
  EXPECT_THAT(status_of(facts).text, HasSubstr(" 0 rays/s"));
  facts.paused = true;
  EXPECT_EQ(status_of(facts).text, "Paused at 1 sample a pixel; space goes on");
  picture.finished = true;
  EXPECT_EQ(status_of(facts).kind, Status::Kind::done);
  EXPECT_EQ(status_of(facts).text, "Finished: 1 sample a pixel");
  picture.error = Error{ErrorKind::no_resource, "", "no memory"};
  EXPECT_EQ(status_of(facts).kind, Status::Kind::failed);
}

TEST(Stage, FillsTheAreaOrShowsAGivenSizeWhole) {
  const Stage free({0, 40, 500, 500}, 2, 0, 0);
  EXPECT_EQ(free.picture_width, 1000);
  EXPECT_EQ(free.picture_height, 920);
  EXPECT_TRUE(free.contains(499, 499));
  EXPECT_FALSE(free.contains(500, 40));
  EXPECT_FALSE(free.contains(10, 39));
  EXPECT_EQ(free.down(40), 0);
  const Stage given({0, 0, 500, 500}, 1, 1000, 500);
  EXPECT_EQ(given.picture_width, 1000);
  EXPECT_EQ(given.hi.x - given.lo.x, 500);
  EXPECT_EQ(given.lo.y, 125);
  EXPECT_FALSE(given.sharp);
  EXPECT_TRUE(Stage({0, 0, 400, 500}, 1, 400, 300).sharp);
  const Stage none({0, 0, 1, 0}, 1, 0, 0);
  EXPECT_GE(none.picture_width * none.picture_height, 1);
}

TEST(Edit, MakesAnotherSceneThatSharesWhatDidNotChange) {
  const auto before = scene();
  const Rgb color = before->materials[0].color;
  const auto after = edited(before, [](Scene& s) {
    s.materials[0].color = Rgb(0.25f, 0.5f, 0.75f);
    s.lights.push_back({Vec3f(1, 2, 3), Rgb(1)});
    s.background = Rgb(0.5f);
  });
  EXPECT_EQ(before->materials[0].color, color);
  EXPECT_EQ(after->materials[0].color, Rgb(0.25f, 0.5f, 0.75f));
  EXPECT_EQ(after->lights.size(), before->lights.size() + 1);
  EXPECT_EQ(after->spheres.data(), before->spheres.data()) << "copied";
  EXPECT_EQ(after->positions.data(), before->positions.data()) << "copied";
  EXPECT_NE(content_hash(*after), content_hash(*before));
  EXPECT_TRUE(validate(*after).empty());
  const auto back = edited(after, [&](Scene& s) {
    s.materials[0].color = color;
    s.lights.pop_back();
    s.background = before->background;
  });
  EXPECT_EQ(content_hash(*back), content_hash(*before));
  EXPECT_EQ(back->spheres.data(), before->spheres.data());
}

TEST(Edit, WhatIsSavedReadsBackAsItWasSeen) {
  ViewState state("some.nff", scene(), {});
  state.camera = orbited(state.camera, {0.1, 0.2, 0.3}, 0.4, 0.1);
  state.scene = edited(state.scene, [](Scene& s) { s.materials[0].ks = 0.625f; });
  const Scene seen = as_seen(*state.scene, state.camera, Rgb(0.25f, 0.5f, 1));
  const auto read = parse_nff(write_nff(seen), "some");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene.camera.from, state.camera.from);
  EXPECT_EQ(read->scene.camera.at, state.camera.at);
  EXPECT_EQ(read->scene.background, Rgb(0.25f, 0.5f, 1));
  EXPECT_EQ(count_primitives(read->scene), count_primitives(seen));
}

TEST(Edit, WhatIsEditedWhileTheSceneIsWrittenStays) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("raio_edit_{}", std::random_device()());
  std::filesystem::create_directories(folder);
  const auto saved = [&](const ViewState& state, const std::string& name) {
    SceneWriter writer;
    writer.write(state, (folder / name).string());
    while (true)
      if (auto written = writer.poll()) {
        EXPECT_FALSE(writer.is_busy());
        return *written;
      }
  };
  ViewState state("some.nff", scene(), {});
  state.camera = orbited(state.camera, {0.1, 0.2, 0.3}, 0.4, 0.1);
  const WrittenColor blue{.color = Rgb(0.25f, 0.5f, 1)};
  state.options.background = blue;
  const auto first = saved(state, "first.nff");
  ASSERT_TRUE(first.result) << first.result.error().text();
  const auto read = read_nff((folder / "first.nff").string());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene.camera.from, state.camera.from);
  EXPECT_EQ(read->scene.background, Rgb(0.25f, 0.5f, 1));
  ViewState quiet = state;
  take_saved(quiet, first);
  EXPECT_EQ(quiet.scene, first.scene);
  EXPECT_EQ(quiet.scene->name, "first");
  EXPECT_FALSE(quiet.options.background);
  // Edited meanwhile.
  state.scene = edited(state.scene, [](Scene& s) { s.materials[0].ks = 0.625f; });
  take_saved(state, first);
  EXPECT_NE(state.scene, first.scene);
  EXPECT_EQ(state.scene->materials[0].ks, 0.625f);
  EXPECT_EQ(state.scene->camera.from, state.camera.from);
  EXPECT_EQ(state.scene->name, "first");
  EXPECT_TRUE(state.path.ends_with("first.nff"));
  EXPECT_EQ(state.options.background, blue);
  // What cannot be written says why.
  EXPECT_FALSE(saved(state, "nowhere/first.nff").result);
  EXPECT_FALSE(saved(state, "first.txt").result);
  std::filesystem::remove_all(folder);
}

TEST(Memory, KeepsTheLookAndTheScenesThatAreThere) {
  const auto folder = std::filesystem::temp_directory_path() /
                      fmt::format("raio_memory_{}", std::random_device()());
  std::filesystem::create_directories(folder);
  const auto file = folder / "deep" / "window";
  EXPECT_EQ(recall(file), Memory());
  Memory memory;
  memory.look = {.light = true, .projector = true};
  memory.language = Language::portuguese;
  for (const char* name : {"a.nff", "b b.nff", "a.nff"}) {
    ASSERT_TRUE(write_file(folder / name, "x"));
    memory.opened((folder / name).string());
  }
  ASSERT_EQ(memory.recent.size(), 2u);
  EXPECT_TRUE(memory.recent.front().ends_with("a.nff"));
  remember(memory, file);
  EXPECT_EQ(recall(file), memory);
  std::filesystem::remove(folder / "a.nff");
  EXPECT_EQ(recall(file).recent.size(), 1u);
  for (int i = 0; i < 100; ++i) memory.opened(fmt::format("/x/{}.nff", i));
  EXPECT_EQ(memory.recent.size(), 12u);
  ASSERT_TRUE(write_file(file, "nonsense\nlight"));
  EXPECT_TRUE(recall(file).look.light);
  std::filesystem::remove_all(folder);
}

TEST(FileDialog, ListsFoldersThenScenes) {
  const auto folder = std::filesystem::temp_directory_path() /
                      fmt::format("raio_entries_{}", std::random_device()());
  for (const char* name : {"z", "A", ".hidden"}) std::filesystem::create_directories(folder / name);
  for (const char* name : {"b.nff", "a.raio", "c.png", ".d.nff"})
    ASSERT_TRUE(write_file(folder / name, "x"));
  EXPECT_EQ(entries_of(folder), (std::vector<std::string>{"A/", "z/", "a.raio", "b.nff"}));
  EXPECT_TRUE(entries_of(folder / "nowhere").empty());
  std::filesystem::remove_all(folder);
}

TEST(Samples, AreTheScenesOfTheTree) { EXPECT_GE(sample_scenes().size(), 5u); }

// Every text of the screen has a line in the table: those within tr(), trf() and number_of(), the
// tables of keys and hands, and the names of sections.
TEST(Texts, AllAreInPortuguese) {
  std::map<std::string, std::string> table;
  for (const auto& [english, portuguese] : text_table()) {
    EXPECT_TRUE(table.emplace(english, portuguese).second) << english << " is there twice";
    EXPECT_EQ(std::ranges::count(std::string_view(english), '{'),
              std::ranges::count(std::string_view(portuguese), '{'))
        << english;
  }
  std::set<std::string> texts;
  for (const KeySpec& key : key_table())
    if (*key.name) texts.insert({key.help, key.about});
  for (const HandSpec& hand : hand_table()) texts.insert({hand.name, hand.help});
  const std::regex literal(R"re("((?:[^"\\]|\\.)*)")re");
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RAIO_SOURCE_DIR) + "/src/view")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string source = read_file(entry.path(), 1 << 20).value();
    const std::regex text(
        R"re((?:\btrf?\(|open_section\(|heat_legend\()\s*((?:"(?:[^"\\]|\\.)*"\s*)+))re");
    for (std::sregex_iterator it(source.begin(), source.end(), text), end; it != end; ++it) {
      std::string joined;
      const std::string pieces = (*it)[1];
      for (std::sregex_iterator piece(pieces.begin(), pieces.end(), literal); piece != end; ++piece)
        joined += (*piece)[1].str();
      if (joined.find('\\') == std::string::npos) texts.insert(joined);
    }
    const std::regex counts(R"re(number_of\([^;]*?"([^"]*)",\s*"([^"]*)"\))re");
    for (std::sregex_iterator it(source.begin(), source.end(), counts), end; it != end; ++it)
      texts.insert({(*it)[1].str(), (*it)[2].str()});
  }
  EXPECT_GT(texts.size(), 100u);
  for (const std::string& text : texts) EXPECT_TRUE(table.contains(text)) << '"' << text << '"';
  set_language(Language::portuguese);
  EXPECT_STREQ(tr("undone"), "desfeito");
  EXPECT_EQ(number_of(1, "light", "lights"), "1 luz");
  EXPECT_EQ(number_of(2, "light", "lights"), "2 luzes");
  set_language(Language::english);
  EXPECT_STREQ(tr("undone"), "undone");
  EXPECT_EQ(language_of("pt_BR.UTF-8"), Language::portuguese);
  EXPECT_EQ(language_of("C.UTF-8"), Language::english);
}

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

TEST(ReadOut, SaysTheValueWithItsUnitAndWhatIsThere) {
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
  EXPECT_EQ(shell_word("plain-1.nff"), "plain-1.nff");
  EXPECT_EQ(shell_word("two words"), "'two words'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace raio::view
