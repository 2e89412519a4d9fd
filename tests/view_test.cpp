// The window's state, texts and layout, without a window.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <ranges>
#include <regex>
#include <set>

#include "integrate/camera.h"
#include "io/file.h"
#include "io/scene_file.h"
#include "view/bars.h"
#include "view/comparison.h"
#include "view/costs_panel.h"
#include "view/help.h"
#include "view/layout.h"
#include "view/stage.h"
#include "view/state.h"
#include "view/texts.h"
#include "view_scenes.h"

namespace raio::core::view {
namespace {

using testing::HasSubstr;

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

SessionPicture timed_picture(uint64_t request, double seconds, int width = 64) {
  SessionPicture p;
  p.request = request, p.samples = 1, p.settings.width = width, p.settings.height = 48;
  p.sample_s = {0.999 * seconds, seconds, 1.001 * seconds};
  return p;
}

TEST(ViewState, EveryStateIsACommandLine) {
  ViewState state("some.nff", scene(), {});
  state.focus_at(3.7f);
  state.scale_aperture(1.21f);
  state.options.light_size = 0.3f, state.options.accel.grid_factor = 1.5f;
  state.options.background = parse_color("#ff8000").value();
  state.options.exposure.ev = -1.5f, state.options.tone = Tone::agx;
  for (unsigned i = 0; i < 4096; ++i) {
    ViewState s = state;
    for (unsigned effect = 0; effect < 9; ++effect)
      if (i >> effect & 1) (void)s.toggle(Command(effect));
    if (i & 512) s.camera = orbited(s.camera, {}, 0.1 * i, 0.05);
    if (i & 1024) s.show(View(i % kViews));
    if (i & 2048) s.options.aa = 3, s.options.lens_samples = 2;
    const RenderOptions o = read_back(s, 5), wanted = s.request(64, 48, 5);
    EXPECT_EQ(option_arguments(o), option_arguments(wanted));
    const Camera a = camera_of(*s.scene, o);
    EXPECT_EQ(a.from, s.camera.from);
    EXPECT_EQ(a.at, s.camera.at);
  }
}

TEST(ViewState, DistantCamerasReadBackExactly) {
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

// Nothing that a render of it would refuse.
TEST(ViewState, AFigureHasNoEffectsOfSurfaces) {
  Scene molecule = *scene();
  molecule.dialect = Dialect::data;
  ViewState state("some.xyz", std::make_shared<const Scene>(std::move(molecule)), {});
  const RenderOptions before = state.options;
  EXPECT_EQ(state.toggle(Command::soft_shadows), "a figure has no soft shadows");
  for (const Command effect :
       {Command::reflection, Command::refraction, Command::gloss, Command::translucency})
    EXPECT_THAT(state.toggle(effect), HasSubstr("a figure has no "));
  EXPECT_EQ(state.options, before);
  EXPECT_EQ(state.toggle(Command::depth_of_field), "depth of field on");
  (void)read_back(state, 4);
  state.options.integrator = IntegratorKind::classic;
  EXPECT_EQ(state.toggle(Command::soft_shadows), "soft shadows on");
}

// An option from another scene waits for one in which it has an effect.
TEST(ViewState, OptionsWithoutEffectWait) {
  Scene molecule = *scene();
  molecule.dialect = Dialect::data;
  ViewState state("some.nff", scene(), {});
  state.toggle(Command::soft_shadows);
  state.options.gloss = 0.2f;
  state.open("some.xyz", std::make_shared<const Scene>(std::move(molecule)));
  EXPECT_FALSE(read_back(state, 4).soft_shadows);
  state.options.outline = 2, state.options.look = FigureStyle::dark_1;
  EXPECT_EQ(read_back(state, 4).outline, 2);
  state.open("some.nff", scene());
  EXPECT_TRUE(read_back(state, 4).soft_shadows);
  EXPECT_FALSE(read_back(state, 4).outline);
}

TEST(ViewState, ClickedFocusStaysWithItsScene) {
  ViewState state("some.nff", scene(), {});
  state.focus_on({0, 0, 0});
  EXPECT_GT(state.options.focus, 0);
  state.open("some.nff", scene());
  EXPECT_GT(state.options.focus, 0);
  state.open("other.nff", scene());
  EXPECT_EQ(state.options.focus, 0);
}

TEST(ViewState, ShowsAllOfTheData) {
  Scene molecule = *scene();
  molecule.dialect = Dialect::data;
  molecule.camera.horizontal_fov_deg = 60;
  const ViewState state("some.xyz", std::make_shared<const Scene>(molecule), {});
  EXPECT_GT(state.camera.fov_deg, molecule.camera.fov_deg);
  EXPECT_NEAR(state.camera.fov_deg, 60, 1e-4) << "also in a square";
}

TEST(ViewState, ParallelRaysChangeOnlyTheCamera) {
  const auto read = parse_scene("3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n", "water.xyz");
  ASSERT_TRUE(read);
  const auto water = std::make_shared<const Scene>(read->scene);
  ViewState state("water.xyz", water, {});
  const Camera cone = state.camera;
  RenderOptions asked;
  asked.projection = core::Projection::orthographic, asked.width = asked.height = 512;
  // The scene's own camera is that of the other projection; any other one stays where it is.
  state.set_projection(core::Projection::orthographic);
  EXPECT_EQ(state.camera, resolve_options(asked, *water).camera);
  EXPECT_EQ(ViewState("water.xyz", water, asked).camera, state.camera);
  EXPECT_EQ(state.camera, state.own_camera());
  state.set_projection(core::Projection::perspective);
  EXPECT_EQ(state.camera, cone);
  state.camera = orbited(cone, {}, 0.3, 0.1);
  Camera turned = state.camera;
  turned.projection = core::Projection::orthographic;
  state.set_projection(core::Projection::orthographic);
  EXPECT_EQ(state.camera, turned);
  const Camera back = camera_of(*water, read_back(state, 5));
  EXPECT_TRUE(back.is_parallel() && back.from == turned.from && back.at == turned.at);
  // They have no lens: one switched on before waits.
  EXPECT_EQ(state.toggle(Command::depth_of_field), "parallel rays have no lens");
  state.options.dof = true, state.options.aperture = 0.3f;
  EXPECT_FALSE(state.is_on(Command::depth_of_field));
  EXPECT_FALSE(read_back(state, 5).dof);
  state.set_projection(core::Projection::perspective);
  EXPECT_TRUE(read_back(state, 5).dof);
  // Another file has its own.
  state.set_projection(core::Projection::orthographic);
  state.open("some.nff", scene());
  EXPECT_FALSE(state.camera.is_parallel());
}

TEST(ViewState, ReportsTheEffectOfKeys) {
  ViewState state("some.nff", scene(), {});
  EXPECT_EQ(state.toggle(Command::antialiasing), "antialiasing on");
  EXPECT_EQ(state.toggle(Command::antialiasing), "antialiasing off");
  EXPECT_EQ(state.toggle(Command::structure), "structure grid");
  EXPECT_EQ(state.toggle(Command::reflection), "reflection off");
  EXPECT_EQ(state.command_line(64, 48, 1, "a b.png"),
            "raio render some.nff --size 64x48 --accel grid --aa 1 --no-reflection -o 'a b.png'");
}

TEST(ViewState, RoughnessComesBackAndIsSampled) {
  for (const Command effect : {Command::gloss, Command::translucency}) {
    ViewState state("some.nff", scene(), {});
    EXPECT_FALSE(state.is_on(effect));
    EXPECT_EQ(state.request(8, 8).samples, 0);
    (void)state.toggle(effect);
    EXPECT_EQ(state.roughness(effect), kUsualRoughness);
    EXPECT_EQ(state.request(8, 8).samples, kRefineSamples);
    state.roughness(effect) = 0.3f;
    EXPECT_EQ(core::is_on(effect_of(effect), state.other_request(8, 8), *state.scene), false);
    (void)state.toggle(effect);
    EXPECT_FALSE(state.is_on(effect));
    EXPECT_EQ(state.roughness(effect), std::nullopt) << "no option where none is needed";
    (void)state.toggle(effect);
    EXPECT_EQ(state.roughness(effect), 0.3f);
  }
  // For rough materials `0` is stored, and nothing when they decide again.
  Scene rough = *scene();
  rough.material_roughness = std::vector<float>(rough.materials.size(), 0.2f);
  ViewState state("rough.p3f", std::make_shared<const Scene>(rough), {});
  EXPECT_TRUE(state.is_on(Command::gloss));
  EXPECT_EQ(state.toggle(Command::gloss), "gloss off");
  EXPECT_EQ(state.options.gloss, 0.0f);
  EXPECT_TRUE(state.is_on(Command::translucency)) << "each on its own";
  EXPECT_EQ(state.toggle(Command::gloss), "gloss on");
  EXPECT_EQ(state.options.gloss, std::nullopt);
}

TEST(ViewState, MotionStopsWhereTheShutterOpens) {
  Scene moving = *scene();
  moving.moving_spheres = std::vector<MovingSphere>{{{0, 0, 0}, {1, 0, 0}, 0.1f, 2, 4}};
  moving.moving_sphere_materials = std::vector<MaterialId>{0};
  ViewState state("moving.p3f", std::make_shared<const Scene>(moving), {});
  EXPECT_TRUE(state.is_on(Command::motion));
  EXPECT_EQ(state.request(8, 8).samples, kRefineSamples);
  state.options.shutter = {3.0f, 4.0f};
  EXPECT_EQ(state.toggle(Command::motion), "motion blur off");
  EXPECT_EQ(state.options.shutter, (std::array{3.0f, 3.0f}));
  EXPECT_EQ(state.request(8, 8).samples, 0);
  EXPECT_EQ(state.other_request(8, 8).shutter, (std::array{3.0f, 4.0f}));
  EXPECT_EQ(state.toggle(Command::motion), "motion blur on");
  EXPECT_EQ(state.options.shutter, (std::array{3.0f, 4.0f}));
  state.open("other.nff", scene());
  EXPECT_FALSE(state.is_on(Command::motion));
  EXPECT_EQ(state.request(8, 8).shutter, std::nullopt) << "it would be refused";
  EXPECT_EQ(state.toggle(Command::motion), "nothing moves in this scene");
}

TEST(ViewState, TheOtherPictureDiffersInTheLastEffect) {
  ViewState state("some.nff", scene(), {});
  (void)state.toggle(Command::soft_shadows);
  EXPECT_TRUE(state.request(8, 8).soft_shadows);
  EXPECT_FALSE(state.other_request(8, 8).soft_shadows);
  (void)state.toggle(Command::refraction);
  EXPECT_FALSE(state.other_request(8, 8).no_refraction);
}

TEST(ViewState, ANewVersionOfTheFileKeepsTheCamera) {
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

TEST(ViewState, AnAngleToCentersIsAWiderOneToEdges) {
  ViewState state("scene.nff", std::make_shared<const Scene>(), {});
  state.camera.from = {1, 2, 3}, state.camera.at = {0, 0, 0};
  state.options.angle_to_centers = true;
  const EyeRays to_centers(state.camera, 64, 48, true);
  const EyeRays to_edges(state.edge_to_edge(64, 48), 64, 48);
  for (const float x : {0.5f, 20.5f, 63.5f})
    EXPECT_NEAR(dot(to_centers.pinhole(x, 0.5f).dir, to_edges.pinhole(x, 0.5f).dir), 1, 1e-6);
  state.options.angle_to_centers = false;
  EXPECT_EQ(state.edge_to_edge(64, 48), state.camera);
}

// In any shape, the picture contains the frame of the scene: its width to height, or a square.
TEST(ViewState, ANarrowPictureShowsTheWholeFrame) {
  auto wide = std::make_shared<Scene>();
  wide->camera.from = {0, 0, 5}, wide->camera.fov_deg = 40;
  wide->camera.width = 300, wide->camera.height = 200;
  const ViewState state("scene.nff", wide, {});
  const double frame = std::tan(20 * std::numbers::pi / 180);
  for (const auto& [width, height] : {std::pair(600, 400), {900, 400}, {300, 300}, {100, 900}}) {
    const Camera shown = state.shown_camera(width, height);
    const double half = std::tan(double(shown.fov_deg) * std::numbers::pi / 360);
    EXPECT_NEAR(half, frame * std::max(1.0, 1.5 * height / width), 1e-5) << width;
    const RenderOptions asked = state.request(width, height);
    EXPECT_EQ(resolve_options(asked, *wide).camera.fov_deg, shown.fov_deg);
  }
  EXPECT_EQ(state.shown_camera(900, 400), state.camera);
}

TEST(Comparison, ComparesWholeSamplesOfOneSize) {
  Comparison c;
  const SessionPicture before = timed_picture(1, 0.028), after = timed_picture(2, 0.05);
  EXPECT_EQ(c.begin("structure bvh", &before, 1), "structure bvh: waiting for a whole sample");
  EXPECT_FALSE(c.take(before, 2));
  SessionPicture preview = after;
  preview.samples = 0;
  EXPECT_FALSE(c.take(preview, 2));
  SessionPicture untimed = after;
  untimed.sample_s = {};
  EXPECT_FALSE(c.take(untimed, 2));
  EXPECT_EQ(c.take(after, 2), "structure bvh: 50 ms per sample, before 28 ms");
  EXPECT_FALSE(c.take(after, 2)) << "said once";

  (void)c.begin("structure bvh", &before, 1);
  EXPECT_EQ(c.take(timed_picture(2, 0.05, 65), 2),
            "structure bvh: 50 ms per sample, different size before");
  // One that takes long is timed once.
  SessionPicture slow = timed_picture(3, 2.5);
  slow.sample_s = {2.5, 2.5, 2.5};
  c.begin("structure none", &after, 2);
  EXPECT_EQ(c.take(slow, 3), "structure none: ~2.5 s per sample, before 50 ms");
}

TEST(Comparison, PreviewsAndOlderPicturesDoNotCount) {
  Comparison c;
  SessionPicture preview = timed_picture(1, 0.028);
  preview.samples = 0;
  const SessionPicture older = timed_picture(1, 0.028), after = timed_picture(3, 0.05);
  for (const auto& [before, request] :
       {std::pair<const SessionPicture*, uint64_t>(nullptr, 1), {&preview, 1}, {&older, 2}}) {
    (void)c.begin("structure bvh", before, request);
    EXPECT_EQ(c.take(after, 3), "structure bvh: 50 ms per sample, no whole sample before");
  }
  (void)c.begin("structure bvh", &older, 1);
  c.end();
  EXPECT_FALSE(c.take(after, 3));
}

TEST(Costs, LinesShowMeasurementsAndCounts) {
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

TEST(Keys, EachOccursOnce) {
  std::set<std::pair<int, Modifiers>> seen_keys;
  for (const KeySpec& key : key_table()) {
    EXPECT_TRUE(seen_keys.emplace(key.key, key.held).second) << key.name;
    EXPECT_EQ(find_key(key.key, key.held), &key);
  }
  EXPECT_EQ(find_key('Z'), nullptr);
}

TEST(Keys, LettersDifferFromThoseWithCtrlOrAlt) {
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
        const bool is_narrow = width < kLeastWidthEms * em;
        if (!panel || !is_narrow) {
          EXPECT_EQ(l.panel, Rect(l.picture.right, l.picture.top, width, l.picture.bottom));
        } else {
          EXPECT_EQ(l.picture.right, width) << "covered by the panel";
          EXPECT_GT(l.panel.width(), 0);
        }
        EXPECT_GE(l.picture.width(), 1);
        EXPECT_GE(l.picture.height(), 1);
        if (!panel) {
          EXPECT_EQ(l.picture.right, width);
        } else if (width > 1000 && !is_narrow) {
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

TEST(State, TheSplitViewComparesAnEffectOfTheCommandLine) {
  const auto compared = [](void (*give)(RenderOptions&)) {
    RenderOptions options;
    give(options);
    return ViewState("some.nff", scene(), options).split_effect;
  };
  EXPECT_EQ(compared([](RenderOptions& o) { o.dof = true; }), Command::depth_of_field);
  EXPECT_EQ(compared([](RenderOptions& o) { o.dof = false; }), Command::antialiasing) << "off";
  EXPECT_EQ(compared([](RenderOptions& o) { o.soft_shadows = true, o.aa = 3; }),
            Command::soft_shadows);
  EXPECT_EQ(compared([](RenderOptions& o) { o.gloss = 0.2f; }), Command::gloss);
  EXPECT_EQ(compared([](RenderOptions&) {}), Command::antialiasing);
}

TEST(Help, FindsAllWordsInAnyCase) {
  EXPECT_EQ(help_lines("").size(),
            size_t(std::ranges::count_if(key_table(), [](auto& k) { return *k.about != 0; })) +
                hand_table().size());
  // Each key is in a line, also a second one of its command.
  std::set<std::string> keys;
  for (const HelpLine& line : help_lines(""))
    for (const auto key : std::views::split(line.keys, std::string_view(", ")))
      keys.emplace(key.begin(), key.end());
  for (const KeySpec& key : key_table()) EXPECT_TRUE(keys.contains(key.name)) << key.name;
  EXPECT_EQ(help_lines("redoes")[0].keys, "Ctrl+Y, Ctrl+Shift+Z");
  const auto found = help_lines("SHADOWS soft");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].keys, "s");
  EXPECT_TRUE(help_lines("no such thing").empty());
}

TEST(Status, ShowsTheActivity) {
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
  EXPECT_THAT(status_of(facts).text, HasSubstr("1 of 64 samples per pixel"));
  EXPECT_THAT(status_of(facts).text, HasSubstr(" 0 rays/s"));
  picture.settings.samples = 0, picture.settings.aa = 3, picture.settings.lens_samples = 1;
  EXPECT_THAT(status_of(facts).text, HasSubstr("1 of 9 samples per pixel"));
  facts.paused = true;
  EXPECT_EQ(status_of(facts).text, "Paused at 1 sample per pixel; space resumes");
  picture.finished = true;
  EXPECT_EQ(status_of(facts).kind, Status::Kind::done);
  EXPECT_EQ(status_of(facts).text, "Finished: 1 sample per pixel");
  picture.error = Error{ErrorKind::no_resource, "", "no memory"};
  EXPECT_EQ(status_of(facts).kind, Status::Kind::failed);
}

TEST(Stage, FillsTheAreaOrFitsAGivenSize) {
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
    if (*key.about) texts.insert({key.help, key.about});
  for (const HandSpec& hand : hand_table()) texts.insert({hand.name, hand.help});
  const std::regex literal(R"re("((?:[^"\\]|\\.)*)")re");
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RAIO_SOURCE_DIR) + "/src/view")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string source = read_file(entry.path(), 1 << 20).value();
    const std::regex text(
        R"re((?:\btrf?\(|open_section\(|heat_legend\(|\blabel\(|\bheading\(|\b(?:combo|field|number|on_or_off|box)\()\s*((?:"(?:[^"\\]|\\.)*"\s*)+))re");
    for (std::sregex_iterator it(source.begin(), source.end(), text), end; it != end; ++it) {
      std::string joined;
      const std::string pieces = (*it)[1];
      for (std::sregex_iterator piece(pieces.begin(), pieces.end(), literal); piece != end; ++piece)
        joined += (*piece)[1].str();
      if (!joined.empty() && joined.find('\\') == std::string::npos) texts.insert(joined);
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

TEST(Quoted, IsReadBackByAShell) {
  EXPECT_EQ(shell_word("plain-1.nff"), "plain-1.nff");
  EXPECT_EQ(shell_word("two words"), "'two words'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace raio::core::view
