// Tests the window's rules without a window, a thread or a clock: sends events, checks requests.
#include "view/app_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "view_scenes.h"

namespace raio::core::view {
namespace {

using testing::HasSubstr;

// A window of the size it was opened with, at rest.
class AppStateTest : public testing::Test {
 protected:
  AppStateTest() {
    facts.now = 100;
    (void)tell(event::Resized{.width = 715, .height = 371, .pixels_per_unit = 1, .em = 15});
  }

  static RenderOptions first_options() {
    RenderOptions o;
    o.width = 64, o.height = 48;
    return o;
  }

  Requests tell(const Event& event) { return app.update(event, facts); }
  Requests press(int key, Modifiers held = {}) { return tell(event::KeyPressed{key, held}); }
  Requests tick(double seconds = 0.01) {
    facts.now += seconds;
    return tell(event::Tick{});
  }

  // A whole picture of the newest request.
  std::shared_ptr<SessionPicture> picture(double sample_s = 0.01) const {
    auto p = std::make_shared<SessionPicture>();
    p->request = app.request, p->samples = 1;
    p->settings = resolve_options(app.view.request(64, 48), *app.view.scene);
    p->sample_s = {sample_s, sample_s, sample_s};
    return p;
  }
  Requests take(std::shared_ptr<SessionPicture> p) {
    return tell(event::PictureTaken{std::move(p), true});
  }
  SceneFile::Read read(const std::string& path) const { return {path, view::scene(), {}}; }
  // The same file, a trajectory, read with other options.
  static SceneFile::Read reread(const ReadOptions& options) {
    auto file = std::make_shared<ReadScene>();
    file->scene = *view::scene();
    file->frames = 3, file->colors = ColorScale{"speed", "viridis", 0, 1};
    return {"some.nff", std::shared_ptr<const Scene>(file, &file->scene), {}, options, file, true};
  }
  Requests change(std::string_view option, std::string text) {
    event::ControlsUsed used{app.view, {}};
    const auto spec = std::ranges::find(read_option_table(), option, &ReadOptionSpec::name);
    used.did.figure.reads.push_back({&*spec, std::move(text)});
    return tell(used);
  }

  template <class R>
  static const R* find(const Requests& requests) {
    for (const Request& one : requests)
      if (const R* found = std::get_if<R>(&one)) return found;
    return nullptr;
  }
  static std::string lines(const Requests& requests) {
    std::string all;
    for (const Request& one : requests)
      if (const auto* log = std::get_if<request::Log>(&one)) all += log->line + "\n";
    return all;
  }

  // The costs are visible, and everything has been at rest for long.
  void rest_with_costs() {
    event::ControlsUsed used{app.view, {}};
    used.did.wants_costs = true;
    (void)tell(used);
    (void)take(picture());
    facts.now += 10;
  }

  Facts facts;
  AppState app{ViewState("some.nff", view::scene(), first_options()), first_options(), {}, {}};
};

TEST_F(AppStateTest, AKeyChangesTheStateAndRequestsAPicture) {
  ASSERT_FALSE(app.view.options.no_reflection);
  const Requests requests = press('R');
  EXPECT_TRUE(app.view.options.no_reflection);
  const auto* render = find<request::Render>(requests);
  ASSERT_TRUE(render);
  EXPECT_EQ(render->what.options, app.view.request(64, 48));
  EXPECT_EQ(render->what.scene, app.view.scene);
  EXPECT_EQ(render->what.frame_s, 0);
  EXPECT_EQ(app.request, 2u);
  EXPECT_THAT(lines(requests), HasSubstr("reflection off: waiting for a whole sample\n"));
  EXPECT_THAT(lines(requests), HasSubstr("request: 2\n"));
  EXPECT_TRUE(app.is_waiting());
  EXPECT_TRUE(press('R', {.ctrl = true}).empty()) << "no such key";
  EXPECT_THAT(lines(take(picture())), HasSubstr("reflection off: ~10 ms per sample, no whole"));
  EXPECT_FALSE(app.is_waiting());
}

TEST_F(AppStateTest, UndoAndRedoRestoreAllButTheView) {
  (void)press('R');
  (void)tick();
  (void)press('H');
  EXPECT_TRUE(find<request::Render>(press('Z', {.ctrl = true})));
  EXPECT_FALSE(app.view.options.no_reflection);
  EXPECT_FALSE(app.view.panel);
  EXPECT_THAT(lines(press('Z', {.ctrl = true})), HasSubstr("nothing to undo"));
  EXPECT_TRUE(find<request::Render>(press('Y', {.ctrl = true})));
  EXPECT_TRUE(app.view.options.no_reflection);
  EXPECT_THAT(lines(press('Y', {.ctrl = true})), HasSubstr("nothing to redo"));
}

TEST_F(AppStateTest, KeysPressedAtOnceAreStepsOfTheHistory) {
  (void)press('R');
  (void)press('R');
  ASSERT_FALSE(app.view.options.no_reflection);
  (void)press('Z', {.ctrl = true});
  EXPECT_TRUE(app.view.options.no_reflection);
}

constexpr int kEscape = 256, kF1 = 290;  // GLFW's

TEST_F(AppStateTest, NoKeyReachesThePictureBehindADialog) {
  facts.has_dialog = true;
  for (const KeySpec& key : key_table()) {
    const Requests requests = press(key.key, key.held);
    if (key.key == kEscape) {
      EXPECT_TRUE(find<request::CloseDialogs>(requests));
    } else if (key.key == kF1) {
      EXPECT_TRUE(find<request::SwitchHelp>(requests));
    } else {
      EXPECT_TRUE(requests.empty()) << key.name;
    }
  }
}

TEST_F(AppStateTest, EscapeClosesAtOnceAndFirstLeavesAFieldOfThePanel) {
  facts.types = true;
  EXPECT_TRUE(press(kEscape).empty()) << "the field keeps it";
  facts.full_screen = true;
  EXPECT_TRUE(press(kEscape).empty());
  facts.inspects = true;
  EXPECT_TRUE(find<request::CloseInspector>(press(kEscape)));
  facts.inspects = false, facts.picks = true;
  EXPECT_TRUE(find<request::CloseInspector>(press(kEscape)));
  facts.has_dialog = true;
  EXPECT_TRUE(find<request::CloseDialogs>(press(kEscape)));
  facts = {};
  EXPECT_TRUE(find<request::CloseWindow>(press(kEscape)));
}

TEST_F(AppStateTest, AHeldControlIsOneStepOfTheHistory) {
  facts.control_held = true;
  for (const double exposure : {1, 2, 3}) {
    event::ControlsUsed used{app.view, {}};
    used.view.options.exposure.ev = float(exposure);
    used.did.changed = used.did.dragging = true;
    const auto requests = tell(used);
    ASSERT_TRUE(find<request::Render>(requests));
    EXPECT_GT(find<request::Render>(requests)->what.frame_s, 0);
    (void)tick(1);
    EXPECT_FALSE(app.history.can_undo());
  }
  facts.control_held = false;
  (void)tick(1);
  (void)press('Z', {.ctrl = true});
  EXPECT_EQ(app.view.options.exposure, Exposure());
}

TEST_F(AppStateTest, AnotherFileIsANewStartAndANewVersionAStep) {
  (void)press('R');
  (void)tick();
  Requests requests = tell(read("some.nff"));
  EXPECT_FALSE(find<request::CloseInspector>(requests));
  EXPECT_TRUE(find<request::ForgetMeasurements>(requests));
  EXPECT_TRUE(find<request::Render>(requests));
  (void)tick();
  EXPECT_TRUE(app.history.can_undo());
  requests = tell(read("other.nff"));
  EXPECT_TRUE(find<request::CloseInspector>(requests));
  ASSERT_TRUE(find<request::FollowFile>(requests));
  EXPECT_EQ(find<request::FollowFile>(requests)->path, "other.nff");
  EXPECT_THAT(lines(requests), HasSubstr("opened other.nff"));
  EXPECT_EQ(app.view.path, "other.nff");
  EXPECT_FALSE(app.history.can_undo());
  EXPECT_EQ(find<request::OpenFile>(tell(event::FileDropped{"third.nff"}))->path, "third.nff");
}

TEST_F(AppStateTest, AnotherProgramsPictureIsComparedAtItsSize) {
  EXPECT_EQ(find<request::CompareWith>(tell(event::FileDropped{"mine.PPM"}))->path, "mine.PPM");
  auto mine = std::make_shared<ComparedPicture>("mine.ppm", Image(30, 20));
  Requests requests = tell(ComparedFile::Read{"mine.ppm", mine});
  EXPECT_EQ(app.other, Other::compared);
  EXPECT_TRUE(app.view.has_bar());
  // Pixels are squares of the screen.
  requests = tell(event::Resized{.width = 715, .height = 371, .pixels_per_unit = 1, .em = 15});
  ASSERT_TRUE(find<request::Render>(requests));
  EXPECT_EQ(find<request::Render>(requests)->what.options.width, 30);
  const float times = (app.stage.hi.x - app.stage.lo.x) / 30;
  EXPECT_GT(times, 2);
  EXPECT_EQ(times, std::floor(times));
  EXPECT_EQ(app.stage.hi.y - app.stage.lo.y, 20 * times);
  // `x` shows the differences, and a click the rays.
  (void)press('X');
  EXPECT_EQ(app.other, Other::difference);
  EXPECT_FALSE(app.view.split);
  (void)press('X');
  EXPECT_EQ(app.other, Other::compared);
  (void)tell(event::CursorMoved{app.stage.lo.x + 2.5 * times, app.stage.lo.y + 1.5 * times});
  (void)tell(event::MouseButton{.number = 0, .down = true});
  requests = tell(event::MouseButton{.number = 0, .down = false});
  ASSERT_TRUE(find<request::Inspect>(requests));
  EXPECT_EQ(int(find<request::Inspect>(requests)->from.x * 30), 2);
  EXPECT_EQ(int(find<request::Inspect>(requests)->from.y * 20), 1);
  // A new version of the scene keeps it; another scene and Escape end it.
  EXPECT_FALSE(find<request::StopComparing>(tell(read("some.nff"))));
  EXPECT_TRUE(app.view.compared);
  EXPECT_TRUE(find<request::StopComparing>(press(kEscape)));
  EXPECT_EQ(app.other, Other::none);
  EXPECT_EQ(app.view.picture_size()[0], 64);
  (void)tell(ComparedFile::Read{"mine.ppm", mine});
  EXPECT_TRUE(find<request::StopComparing>(tell(read("other.nff"))));
  EXPECT_FALSE(app.view.compared);
}

TEST_F(AppStateTest, APictureNeedsItsSceneFirst) {
  app.view.path.clear();
  EXPECT_THAT(lines(tell(event::FileDropped{"mine.png"})), HasSubstr("open the scene of this"));
  EXPECT_THAT(lines(press(292)), HasSubstr("no scene is open"));
}

TEST_F(AppStateTest, ALessonsCommandSetsSceneOptionsAndPixel) {
  Requests requests = press(291);  // F2
  ASSERT_TRUE(find<request::OpenLesson>(requests));
  (void)tell(event::Resized{.width = 1400, .height = 371, .pixels_per_unit = 1, .em = 15});
  EXPECT_GT(app.layout.lesson.width(), 200);
  EXPECT_EQ(app.layout.picture.left, app.layout.lesson.right);
  app::ShownScene shown{.scene = "some.nff", .options = {}};
  shown.options.no_reflection = true, shown.options.view = View::normals;
  shown.pixel = {9, 7}, shown.size = {40, 30};
  event::ControlsUsed used{app.view, {}};
  used.did.lesson.show = shown;
  requests = tell(used);
  ASSERT_TRUE(find<request::OpenFile>(requests));
  EXPECT_EQ(find<request::OpenFile>(requests)->path, "some.nff");
  EXPECT_EQ(find<request::OpenFile>(requests)->options, kForWindow);
  EXPECT_FALSE(app.view.options.no_reflection) << "not before the file is read";
  requests = tell(read("some.nff"));
  ASSERT_TRUE(find<request::Render>(requests));
  EXPECT_TRUE(app.view.options.no_reflection);
  EXPECT_EQ(find<request::Render>(requests)->what.options.view, View::normals);
  EXPECT_EQ(app.view.program, "raio");
  // The pixel's rays, once they can be traced: in a picture of that size, enlarged.
  (void)tell(event::Resized{.width = 1400, .height = 371, .pixels_per_unit = 1, .em = 15});
  EXPECT_EQ(app.stage.picture_width, 40);
  EXPECT_GT(app.stage.hi.x - app.stage.lo.x, 200);
  requests = take(picture());
  ASSERT_TRUE(find<request::Inspect>(requests));
  const ImVec2 at = find<request::Inspect>(requests)->from;
  EXPECT_NEAR(at.x, 9.5 / 40, 1e-4);
  EXPECT_NEAR(at.y, 7.5 / 30, 1e-4);
  EXPECT_FALSE(find<request::Inspect>(take(picture()))) << "once";
  // It is a step that can be undone.
  (void)tick();
  (void)press('Z', {.ctrl = true});
  EXPECT_FALSE(app.view.options.no_reflection);
  EXPECT_FALSE(find<request::CloseWindow>(press(kEscape)));
  EXPECT_FALSE(app.shows_lesson);
}

TEST_F(AppStateTest, ALessonsCommandThatTheWindowRefusesSaysWhy) {
  app::ShownScene shown{.scene = "gone.nff", .options = {}};
  event::ControlsUsed used{app.view, {}};
  used.did.lesson.show = shown;
  (void)tell(used);
  Diagnostic why;
  why.file = "gone.nff", why.message = "does not exist";
  SceneFile::Read failed = read("gone.nff");
  failed.scene = std::unexpected(Diagnostics{why});
  EXPECT_THAT(lines(tell(failed)), HasSubstr("does not exist"));
  // A later file of this name is not the lesson's.
  (void)press('R');
  (void)tell(read("gone.nff"));
  EXPECT_TRUE(app.view.options.no_reflection);
}

TEST_F(AppStateTest, OptionsOfReadingAreUsedOnceTheFileIsReadAndUndone) {
  const auto before = app.view.scene;
  Requests requests = change("style", "sticks");
  const auto* asked = find<request::Reread>(requests);
  ASSERT_TRUE(asked);
  const ReadOptions sticks = asked->options;
  EXPECT_EQ(sticks.style, AtomStyle::sticks);
  EXPECT_TRUE(sticks.hide_solvent) << "other options stay";
  EXPECT_TRUE(app.is_reading());
  EXPECT_EQ(app.view.read_options, kForWindow) << "of the scene that is shown";
  EXPECT_THAT(app.command_line("a.png"), testing::Not(HasSubstr("--style")));
  // A further change meanwhile does not forget the first.
  requests = change("frame", "1");
  EXPECT_EQ(find<request::Reread>(requests)->options.style, AtomStyle::sticks);
  ReadOptions both = sticks;
  both.frame = 1;
  EXPECT_TRUE(find<request::Render>(tell(reread(sticks)))) << "better than nothing";
  EXPECT_TRUE(app.is_reading());
  requests = tell(reread(both));
  ASSERT_TRUE(find<request::Render>(requests));
  EXPECT_EQ(find<request::Render>(requests)->what.scene, app.view.scene);
  EXPECT_FALSE(find<request::FollowFile>(requests));
  EXPECT_FALSE(app.is_reading());
  EXPECT_EQ(app.view.read_options, both);
  EXPECT_THAT(app.command_line("a.png"), HasSubstr("some.nff --style sticks --frame 1 "));
  const auto after = app.view.scene;
  (void)tick();
  EXPECT_TRUE(find<request::Render>(press('Z', {.ctrl = true})));
  EXPECT_EQ(app.view.scene, before);
  EXPECT_EQ(app.view.read_options, kForWindow);
  (void)press('Y', {.ctrl = true});
  EXPECT_EQ(app.view.scene, after);
  EXPECT_EQ(app.view.read_options, both);
  EXPECT_THAT(lines(press('C')), testing::Not(HasSubstr("not in the file")));
  // Undone while it is read: it comes in vain.
  (void)change("frame", "2");
  (void)press('Z', {.ctrl = true});
  both.frame = 2;
  EXPECT_FALSE(find<request::Render>(tell(reread(both))));
  EXPECT_EQ(app.view.scene, before);
}

TEST_F(AppStateTest, RefusedOptionsOfReadingStayInTheirField) {
  Requests requests = change("hide", "chian A");
  EXPECT_FALSE(find<request::Reread>(requests));
  EXPECT_EQ(app.view.form.option, "hide");
  EXPECT_EQ(app.view.form.typed, "chian A");
  EXPECT_THAT(app.view.form.problem, HasSubstr("chian"));
  EXPECT_FALSE(app.is_reading());
  // The file itself may refuse them.
  requests = change("hide", "chain Z");
  EXPECT_TRUE(app.view.form.problem.empty());
  ASSERT_TRUE(find<request::Reread>(requests));
  SceneFile::Read refused = reread(find<request::Reread>(requests)->options);
  Diagnostic why;
  why.file = "some.nff", why.message = "no chain Z";
  refused.scene = std::unexpected(Diagnostics{why}), refused.file = nullptr;
  EXPECT_FALSE(find<request::Render>(tell(refused)));
  EXPECT_EQ(app.view.form.problem, "no chain Z");
  EXPECT_TRUE(app.errors.empty()) << "the file is sound";
  EXPECT_EQ(app.view.read_options, kForWindow);
  EXPECT_EQ(app.read_options(), kForWindow);
  // A good text is forgotten.
  const ReadOptions good = find<request::Reread>(change("hide", "water"))->options;
  (void)tell(reread(good));
  EXPECT_TRUE(app.view.form.option.empty());
}

TEST_F(AppStateTest, AnotherColumnHasItsOwnColours) {
  (void)change("color-by", "speed");
  (void)change("colormap", "plasma");
  ReadOptions o = find<request::Reread>(change("color-range", "0,2"))->options;
  EXPECT_EQ(o.colormap, "plasma");
  EXPECT_TRUE(o.color_range);
  o = find<request::Reread>(change("color-by", "mass"))->options;
  EXPECT_EQ(o.colormap, "plasma");
  EXPECT_FALSE(o.color_range);
  o = find<request::Reread>(change("color-by", "element"))->options;
  EXPECT_TRUE(o.colormap.empty()) << "it would be refused";
  o = find<request::Reread>(change("color-by", ""))->options;
  EXPECT_TRUE(o.color_by.empty());
}

TEST_F(AppStateTest, FramesPlayAsFastAsTheyAreShownAndAreOneStep) {
  app.view.file = reread(kForWindow).file;
  (void)take(picture());
  (void)tick();
  const Camera camera = app.view.camera;
  app.view.form.plays = true, app.view.form.frames_per_s = 10;
  for (const int frame : {1, 2, 0, 1}) {
    Requests requests = tick(1);
    ASSERT_TRUE(find<request::Reread>(requests)) << frame;
    EXPECT_EQ(find<request::Reread>(requests)->options.frame, frame);
    EXPECT_FALSE(find<request::Reread>(tick(1))) << "it is being read";
    EXPECT_TRUE(find<request::Render>(tell(reread(find<request::Reread>(requests)->options))));
    EXPECT_FALSE(find<request::Reread>(tick(1))) << "it is not yet shown";
    EXPECT_EQ(app.view.frame(), frame);
    EXPECT_TRUE(app.view.camera == camera);
    (void)take(picture());
  }
  // Not faster than requested.
  Requests requests = tick(0.01);
  ASSERT_TRUE(find<request::Reread>(requests));
  (void)tell(reread(find<request::Reread>(requests)->options));
  (void)take(picture());
  EXPECT_FALSE(find<request::Reread>(tick(0.05)));
  EXPECT_TRUE(find<request::Reread>(tick(0.06)));
  app.view.form.plays = false;
  (void)tell(reread(app.read_options()));
  (void)tick();
  (void)press('Z', {.ctrl = true});
  EXPECT_EQ(app.view.read_options, kForWindow);
  EXPECT_THAT(lines(press('Z', {.ctrl = true})), HasSubstr("nothing to undo"));
}

TEST_F(AppStateTest, PicturesForPrintHaveTheirOwnSize) {
  app.view.form.width_mm = 88, app.view.form.dpi = 300, app.view.form.samples = 16;
  app.view.options.integrator = IntegratorKind::ambient, app.view.options.aa = 0;
  event::ControlsUsed used{app.view, {}};
  used.did.figure.copies_print = true;
  Requests requests = tell(used);
  EXPECT_THAT(find<request::CopyText>(requests)->text,
              testing::AllOf(HasSubstr(" --size 88x66mm --dpi 300 --integrator ambient "),
                             HasSubstr(" --samples 16 ")));
  EXPECT_FALSE(find<request::PrintPicture>(requests));
  used.did.figure = {};
  used.did.figure.prints = true;
  requests = tell(used);
  const auto* print = find<request::PrintPicture>(requests);
  ASSERT_TRUE(print);
  EXPECT_FALSE(print->scene) << "that of the file";
  const RenderSettings s = resolve_options(print->options, *app.view.scene);
  EXPECT_EQ(s.width, 1039);
  EXPECT_EQ(s.height, 780);
  EXPECT_EQ(s.samples, 16);
  EXPECT_FALSE(find<request::PrintPicture>(tell(used))) << "one at a time";
  requests = tell(event::Printed{{"some.png", "raio render", {}}});
  EXPECT_THAT(lines(requests), HasSubstr("saved some.png in "));
  EXPECT_THAT(lines(requests), HasSubstr("command: raio render"));
  used.view.form.transparent = true, used.view.options.depth_cue = 0.5f;
  used.view.scene = edited(app.view.scene, [](Scene& s) { s.materials[0].kd = 0.3f; });
  requests = tell(used);
  print = find<request::PrintPicture>(requests);
  ASSERT_TRUE(print && print->options.background);
  EXPECT_TRUE(print->options.background->transparent);
  EXPECT_FALSE(print->options.depth_cue) << "nothing to fade into";
  EXPECT_EQ(print->scene, app.view.scene) << "not yet in the file";
  used.did.figure = {};
  used.did.figure.stops_printing = true;
  EXPECT_TRUE(find<request::StopPrinting>(tell(used)));
  requests = tell(event::Printed{{"some.png", "", std::unexpected(stopped_error())}});
  EXPECT_THAT(lines(requests), HasSubstr("stopped"));
  EXPECT_FALSE(app.says_error);
  EXPECT_FALSE(app.is_printing());
}

TEST_F(AppStateTest, ErrorsInTheFileStayUntilItIsFixed) {
  const auto before = app.view.scene;
  Diagnostic wrong;
  wrong.file = "some.nff", wrong.line = 2, wrong.message = "wrong";
  const auto broken = [&](const std::string& path) {
    return SceneFile::Read{path, std::unexpected(Diagnostics{wrong}), {}};
  };
  EXPECT_FALSE(find<request::Render>(tell(broken("other.nff"))));
  EXPECT_TRUE(app.errors.empty()) << "another file's are reported once";
  EXPECT_TRUE(app.says_error);
  EXPECT_FALSE(find<request::Render>(tell(broken("some.nff"))));
  EXPECT_EQ(app.errors.size(), 1u);
  EXPECT_EQ(app.view.scene, before);
  (void)tick(60);
  EXPECT_EQ(app.errors.size(), 1u);
  (void)tell(read("some.nff"));
  EXPECT_TRUE(app.errors.empty());
  EXPECT_FALSE(app.says_error);
}

TEST_F(AppStateTest, SavingWaitsForAWholePicture) {
  EXPECT_FALSE(find<request::WritePicture>(press('P')));
  auto preview = picture();
  preview->samples = 0;
  (void)take(preview);
  EXPECT_FALSE(find<request::WritePicture>(tick()));
  (void)press('R');
  auto older = picture();
  --older->request;
  (void)take(older);
  EXPECT_FALSE(find<request::WritePicture>(tick()));
  const auto whole = picture();
  (void)take(whole);
  const Requests requests = tick();
  ASSERT_TRUE(find<request::WritePicture>(requests));
  EXPECT_EQ(find<request::WritePicture>(requests)->picture, whole);
  EXPECT_EQ(find<request::WritePicture>(requests)->suffix, ".png");
  EXPECT_FALSE(find<request::WritePicture>(tick())) << "once";
  EXPECT_EQ(find<request::WritePicture>(press('P', {.shift = true}))->suffix, ".exr") << "at once";
  EXPECT_THAT(lines(tell(PictureWriter::Written{"some.png", "raio render", {}})),
              HasSubstr("saved some.png in "));
}

TEST_F(AppStateTest, WithPatternsOfSamplesAWholePictureIsAFinishedOne) {
  app.view.options.aa = 3;
  (void)press('R');
  (void)press('P');
  auto part = picture();
  (void)take(part);
  EXPECT_FALSE(find<request::WritePicture>(tick()));
  auto all = picture();
  all->finished = true;
  (void)take(all);
  EXPECT_TRUE(find<request::WritePicture>(tick()));
}

TEST_F(AppStateTest, OneSceneIsSavedAtATime) {
  event::ControlsUsed used{app.view, {}};
  used.did.save = "new.nff";
  EXPECT_EQ(find<request::SaveScene>(tell(used))->path, "new.nff");
  Requests requests = tell(used);
  EXPECT_FALSE(find<request::SaveScene>(requests));
  EXPECT_THAT(lines(requests), HasSubstr("the scene is still being saved"));
  const auto saved = edited(app.view.scene, [](Scene& s) { s.name = "new"; });
  requests = tell(SceneWriter::Written{"new.nff", app.view.scene, saved, "the sky"});
  EXPECT_TRUE(find<request::FollowFile>(requests)->saved);
  EXPECT_THAT(lines(requests), HasSubstr("saved the scene as new.nff; lost: the sky"));
  EXPECT_EQ(app.view.path, "new.nff");
  EXPECT_EQ(app.saved_scene, saved);
  EXPECT_TRUE(find<request::SaveScene>(tell(used)));
}

TEST_F(AppStateTest, RequestedWorkStartsAtOnceBesideTheRefiningPicture) {
  (void)press('M');
  const Requests requests = tick();
  ASSERT_TRUE(find<request::Measure>(requests));
  EXPECT_EQ(find<request::Measure>(requests)->work, Measuring::Work::table);
  EXPECT_FALSE(find<request::Pause>(requests));
  EXPECT_FALSE(find<request::Measure>(tick()));
  EXPECT_THAT(lines(tell(event::Measured{"measured the table", {}})), HasSubstr("measured"));
}

TEST_F(AppStateTest, CostsAreMeasuredWhileVisibleAndGiveWay) {
  (void)take(picture());
  EXPECT_FALSE(find<request::Measure>(tick(10))) << "nobody asked for them";
  rest_with_costs();
  Requests requests = tick();
  EXPECT_EQ(find<request::Measure>(requests)->work, Measuring::Work::costs);
  EXPECT_THAT(lines(requests), HasSubstr("measures the costs"));
  EXPECT_FALSE(app.costs_are_old);
  // A change cancels them; they start again only after its picture and a rest.
  requests = press('R');
  EXPECT_EQ(find<request::Measure>(requests)->work, Measuring::Work::none);
  EXPECT_TRUE(app.costs_are_old);
  requests = tell(event::Measured{"", {}});
  EXPECT_THAT(lines(requests), HasSubstr("did not measure the costs"));
  EXPECT_FALSE(find<request::Measure>(tick(10))) << "without its picture";
  (void)take(picture());
  EXPECT_FALSE(find<request::Measure>(tick(0.5))) << "the message has just come";
  EXPECT_TRUE(find<request::Measure>(tick(0.5)));
}

TEST_F(AppStateTest, CostsEndWhenTheirSectionClosesAndStartAgainForAnotherKind) {
  rest_with_costs();
  (void)tick();
  event::ControlsUsed used{app.view, {}};
  used.did.wants_costs = true, used.view.costs_of = CostOf::report;
  EXPECT_EQ(find<request::Measure>(tell(used))->work, Measuring::Work::none);
  (void)tell(event::Measured{"", {}});
  EXPECT_EQ(find<request::Measure>(tick())->work, Measuring::Work::costs);
  used.did.wants_costs = false;
  EXPECT_EQ(find<request::Measure>(tell(used))->work, Measuring::Work::none);
  (void)tell(event::Measured{"", {}});
  EXPECT_FALSE(find<request::Measure>(tick(10)));
}

TEST_F(AppStateTest, CostsGiveWayToRequestedWorkWhichItsKeyStops) {
  rest_with_costs();
  (void)tick(), (void)tick();
  ASSERT_EQ(app.measuring, Measuring::Work::costs);
  EXPECT_EQ(find<request::Measure>(press('N'))->work, Measuring::Work::none);
  EXPECT_TRUE(app.costs_are_old);
  EXPECT_FALSE(find<request::Measure>(tick())) << "the costs have not ended";
  (void)tell(event::Measured{"", {}});
  EXPECT_EQ(find<request::Measure>(tick())->work, Measuring::Work::curve);
  EXPECT_EQ(find<request::Measure>(press('N'))->work, Measuring::Work::none);
  (void)tell(event::Measured{"stopped", {}});
  EXPECT_THAT(lines(press('M')), HasSubstr("measuring all combinations"));
  EXPECT_THAT(lines(press('M')), HasSubstr("stopped"));
  EXPECT_FALSE(find<request::Measure>(tick()));
}

TEST_F(AppStateTest, MessagesExpire) {
  (void)press('H');
  EXPECT_EQ(app.message.text(), "panel hidden; h shows it");
  (void)tick(3.9);
  EXPECT_FALSE(app.message.text().empty());
  (void)tick(0.2);
  EXPECT_TRUE(app.message.text().empty());
}

TEST_F(AppStateTest, AMovementEndsAfterItsRest) {
  (void)tick();
  facts.walking = {.right = 1};
  Requests requests = tick();
  ASSERT_TRUE(find<request::Render>(requests));
  EXPECT_GT(find<request::Render>(requests)->what.frame_s, 0);
  EXPECT_FALSE(find<request::FollowInspection>(requests));
  EXPECT_TRUE(app.is_moving());
  facts.walking = {};
  requests = tick(0.1);
  EXPECT_FALSE(find<request::Render>(requests));
  EXPECT_FALSE(app.history.can_undo()) << "in the middle of a movement";
  requests = tick(0.06);
  ASSERT_TRUE(find<request::Render>(requests));
  EXPECT_EQ(find<request::Render>(requests)->what.frame_s, 0);
  EXPECT_TRUE(find<request::FollowInspection>(requests));
  EXPECT_THAT(lines(requests), HasSubstr("camera: from "));
  EXPECT_TRUE(app.history.can_undo());
  EXPECT_FALSE(find<request::Render>(tick(1))) << "once";
}

TEST_F(AppStateTest, DragsMoveTheCameraAndClicksFindNothingWithoutAPicture) {
  (void)tell(event::Resized{715, 371, 1, 15});
  const auto hold = [&](bool down) { return tell(event::MouseButton{0, down, false}); };
  (void)tell(event::CursorMoved{200, 150});
  (void)hold(true);
  EXPECT_TRUE(lines(hold(false)).empty()) << "nothing is there to select";
  const Camera before = app.view.camera;
  (void)hold(true);
  EXPECT_TRUE(find<request::Render>(tell(event::CursorMoved{240, 150})));
  EXPECT_FALSE(app.view.camera == before);
  EXPECT_TRUE(lines(hold(false)).empty()) << "no click";
  facts.picks = true;
  (void)hold(true);
  EXPECT_TRUE(find<request::Inspect>(hold(false)));
  facts.has_dialog = facts.over_controls = true;
  (void)hold(true);
  EXPECT_FALSE(app.gestures.is_busy()) << "the dialog is over the picture";
}

TEST_F(AppStateTest, OnlyAPictureWithoutASizeFillsTheWindow) {
  EXPECT_FALSE(find<request::Render>(tell(event::Resized{1000, 500, 1, 15})));
  EXPECT_EQ(app.stage.picture_width, 64);
  event::ControlsUsed used{app.view, {}};
  used.view.options.width = used.view.options.height = 0, used.did.changed = true;
  (void)tell(used);
  Requests requests = tell(event::Resized{715, 371, 1, 15});
  EXPECT_THAT(lines(requests), HasSubstr("size: 400x300"));
  EXPECT_EQ(find<request::Render>(requests)->what.options.width, 400);
  (void)press('H');
  requests = tell(event::Resized{715, 371, 1, 15});
  EXPECT_THAT(lines(requests), HasSubstr("size: 715x300"));
  // A narrow window has no room for the panel; the key shows it over the picture.
  (void)press('H');
  requests = tell(event::Resized{600, 371, 1, 15});
  EXPECT_THAT(lines(requests), HasSubstr("size: 600x300"));
  EXPECT_FALSE(app.has_panel());
  (void)press('H');
  requests = tell(event::Resized{600, 371, 1, 15});
  EXPECT_TRUE(app.has_panel());
  EXPECT_FALSE(find<request::Render>(requests)) << "the picture keeps its size";
}

TEST_F(AppStateTest, TheFocusToolTakesClicksUntilEscape) {
  const auto click = [&](bool ctrl = false) {
    (void)tell(event::CursorMoved{200, 150});
    (void)tell(event::MouseButton{0, true, false, ctrl});
    return lines(tell(event::MouseButton{0, false, false, ctrl}));
  };
  EXPECT_EQ(click(), "") << "without a picture nothing is there to select";
  facts.now += 1;
  EXPECT_THAT(lines(press('E')), HasSubstr("click what shall be sharp"));
  EXPECT_THAT(click(), HasSubstr("nothing there to focus on"));
  EXPECT_FALSE(find<request::CloseWindow>(press(kEscape)));
  EXPECT_FALSE(app.focuses);
  EXPECT_TRUE(find<request::CloseWindow>(press(kEscape)));
}

TEST_F(AppStateTest, TheSplitViewRendersTheOtherPicture) {
  const Requests requests = press('X');
  const auto* other = find<request::RenderOther>(requests);
  ASSERT_TRUE(other && other->what);
  EXPECT_TRUE(other->is_new);
  EXPECT_EQ(other->what->options, app.view.other_request(64, 48));
  EXPECT_FALSE(find<request::RenderOther>(press('R'))->is_new);
  EXPECT_FALSE(find<request::RenderOther>(press('X'))->what);
}

TEST_F(AppStateTest, EscapeClosesOneThingAfterTheOther) {
  facts.has_dialog = facts.inspects = facts.full_screen = true;
  EXPECT_TRUE(find<request::CloseDialogs>(press(kEscape)));
  facts.has_dialog = false;
  EXPECT_THAT(lines(press(kEscape)), HasSubstr("inspector closed"));
  facts.inspects = false;
  Requests requests = press(kEscape);
  ASSERT_TRUE(find<request::SetFullScreen>(requests));
  EXPECT_FALSE(find<request::SetFullScreen>(requests)->on);
  EXPECT_FALSE(find<request::CloseWindow>(requests));
  facts.full_screen = false;
  EXPECT_TRUE(find<request::CloseWindow>(press(kEscape)));
  facts.full_screen = true;
  EXPECT_TRUE(find<request::CloseWindow>(press('Q')));
}

TEST_F(AppStateTest, DrawsWhatIsNewAndThenRests) {
  (void)take(picture());
  int drawn = 0;
  for (int i = 0; i < 100; ++i) drawn += find<request::Draw>(tick()) != nullptr;
  EXPECT_EQ(drawn, 3);
  (void)take(picture());
  EXPECT_TRUE(find<request::Draw>(tick()));
  EXPECT_FALSE(find<request::Draw>(tick()));
  // While the first sample takes long, its progress is drawn now and then.
  (void)press('R');
  drawn = 0;
  for (int i = 0; i < 400; ++i) drawn += find<request::Draw>(tick()) != nullptr;
  EXPECT_GT(drawn, 5);
  EXPECT_LT(drawn, 60);
  facts.hidden = true;
  (void)take(picture());
  EXPECT_FALSE(find<request::Draw>(tick()));
  facts.hidden = false;
  EXPECT_FALSE(find<request::Draw>(tick()));
}

}  // namespace
}  // namespace raio::core::view
