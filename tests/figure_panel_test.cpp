// The section of figures: what it offers for a file, what its widgets change, and the work behind
// it.
#include "view/figure_panel.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <ranges>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "app/command_line.h"
#include "data_files.h"
#include "screen.h"
#include "temporary_folder.h"
#include "view/files.h"

namespace raio::core::view {
namespace {

using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

ViewState state_of(const std::string& text, const std::string& name,
                   const ReadOptions& options = kForPictures) {
  auto read = parse_scene(text, name, options);
  EXPECT_TRUE(read) << (read ? "" : read.error().front().text());
  const auto file = std::make_shared<const ReadScene>(*std::move(read));
  ViewState state(name, std::shared_ptr<const Scene>(file, &file->scene), {});
  state.file = file, state.read_options = options;
  return state;
}

constexpr const char* kSpeeds =
    "3\nProperties=species:S:1:pos:R:3:speed:R:1 Lattice=\"3 0 0 0 3 0 0 0 3\"\n"
    "O 0 0 0 1\nH 1 0 0 2\nH 0 1 0 4\n";

// The names of all options that some widget changes: those of the reader as requests.
std::set<std::string> changed_by_widgets(const std::function<ViewState()>& begin) {
  ViewState state = begin();
  FigureResult did;
  std::string problem;
  const ImVec2 kSize(330, 900);
  const auto draw = [&] {
    ImGui::SetNextWindowPos({0, 0}), ImGui::SetNextWindowSize(kSize);
    ImGui::Begin("figure", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove);
    FigureFacts facts;
    facts.read = state.read_options;
    (void)draw_figure(state, facts, did, problem);
    ImGui::End();
  };
  Screen screen(draw, kSize);
  std::set<std::string> found;
  const auto look = [&](const ViewState& before) {
    for (const ReadChange& change : did.reads) found.emplace(change.option->name);
    for (const OptionSpec& spec : render_option_table())
      if (spec.text(before.options) != spec.text(state.options)) found.emplace(spec.name);
    if (before.camera.projection != state.camera.projection) found.emplace("projection");
    if (before.form.plays != state.form.plays) found.emplace("play");
    if (before.form.frames_per_s != state.form.frames_per_s) found.emplace("rate");
    if (before.form.width_mm != state.form.width_mm) found.emplace("width");
    if (before.form.dpi != state.form.dpi) found.emplace("dpi");
    if (before.form.samples != state.form.samples) found.emplace("samples");
    if (before.form.transparent != state.form.transparent) found.emplace("transparent");
    if (before.annotations.legend != state.annotations.legend) found.emplace("legend");
    if (before.annotations.color_bar != state.annotations.color_bar) found.emplace("color-bar");
    if (before.annotations.scale_bar != state.annotations.scale_bar) found.emplace("scale-bar");
    if (did.prints) found.emplace("print");
    if (did.copies_print) found.emplace("copy");
    EXPECT_EQ(problem, "");
  };
  for (const ImVec2 place : screen.widgets() | std::views::values) {
    const ViewState before = state = begin();
    did = {};
    screen.drag(place), look(before);
    if (screen.is_popup_open() || state == before) {
      state = begin(), did = {};
      ImGui::ClosePopupsOverWindow(nullptr, false), screen.frame();
      screen.click(place);
      if (screen.is_popup_open()) screen.click(screen.entries().back());
      look(before);
    }
    if (ImGui::GetIO().WantTextInput) {
      state = begin(), did = {};
      screen.type("all"), look(before);
    }
    ImGui::ClosePopupsOverWindow(nullptr, false);
    ImGui::ClearActiveID(), screen.frame();
  }
  return found;
}

constexpr const char* kAlways[] = {
    "look",           "background",         "opacity",        "key-light",  "outline", "depth-cue",
    "occlusion-rays", "occlusion-distance", "shadow-catcher", "projection", "width",   "dpi",
    "samples",        "transparent",        "scale-bar",      "print",      "copy"};

TEST(FigurePanel, OffersWhatAMoleculeHas) {
  const auto found = changed_by_widgets([] {
    ReadOptions options = kForPictures;
    options.color_by = "speed";
    return state_of(kSpeeds, "a.xyz", options);
  });
  EXPECT_THAT(found, IsSupersetOf(kAlways));
  EXPECT_THAT(found, IsSupersetOf({"style", "only", "hide", "show", "cell", "images", "color-by",
                                   "colormap", "color-range", "color-bar"}));
  for (const char* other : {"frame", "play", "assembly", "smooth", "legend", "radius"})
    EXPECT_FALSE(found.contains(other)) << other;
  // Elements have names, but no numbers.
  const auto elements = changed_by_widgets([] { return state_of(std::string(kWater), "a.xyz"); });
  EXPECT_THAT(elements, IsSupersetOf({"style", "color-by", "legend"}));
  for (const char* other : {"colormap", "color-range", "color-bar", "cell", "images"})
    EXPECT_FALSE(elements.contains(other)) << other;
}

TEST(FigurePanel, OffersWhatATrajectoryOrAMeshHas) {
  const std::string two = std::string(kSpeeds) + kSpeeds;
  const auto frames = changed_by_widgets([&] { return state_of(two, "a.xyz"); });
  EXPECT_THAT(frames, IsSupersetOf({"frame", "play", "rate"}));
  const auto mesh = changed_by_widgets([] { return state_of(std::string(kObj), "a.obj"); });
  EXPECT_THAT(mesh, IsSupersetOf(kAlways));
  EXPECT_THAT(mesh, testing::Contains("smooth"));
  for (const char* other : {"style", "only", "color-by", "cell", "frame", "legend", "color-bar"})
    EXPECT_FALSE(mesh.contains(other)) << other;
  const auto points = changed_by_widgets([] { return state_of(ply("ascii", 5, false), "a.ply"); });
  EXPECT_THAT(points, IsSupersetOf({"color-by", "radius"}));
  EXPECT_FALSE(points.contains("style"));
}

TEST(FigurePanel, ListsWhatColoursAFile) {
  const ViewState state = state_of(kSpeeds, "a.xyz");
  const ReadChoices& has = state.file->choices;
  EXPECT_THAT(has.columns, testing::Contains("speed"));
  EXPECT_EQ(has.color_by, "element");
  EXPECT_TRUE(has.has_cell && has.atoms && has.points && !has.mesh);
  for (const std::string& column : has.columns) {
    ReadOptions options;
    options.color_by = column;
    EXPECT_TRUE(parse_scene(kSpeeds, "a.xyz", options)) << column;
  }
  EXPECT_THAT(state_of(ply("ascii", 5, false), "a.ply").file->choices.columns,
              IsSupersetOf({"x", "y", "z"}));
  const ViewState scene = state_of(
      "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 24 16\n"
      "f 1 0 0 1 0 1 0 1\ns 0 0 0 1\n",
      "a.nff");
  EXPECT_FALSE(scene.file->choices.atoms || scene.file->choices.points || scene.file->choices.mesh);
}

TEST(FigurePanel, AnnotationsThatDoNotFitAreLeftOut) {
  ViewState state = state_of(kSpeeds, "a.xyz");
  state.annotations = {.color_bar = true, .legend = true, .scale_bar = true};
  EXPECT_THAT(state.command_line(400, 300, 1, "a.png"), HasSubstr(" --legend --scale-bar -o"));
  EXPECT_THAT(state.command_line(400, 300, 1, "a.png"), Not(HasSubstr("--color-bar")));
  EXPECT_THAT(state.command_line(10, 10, 1, "a.png"), Not(HasSubstr("--legend")));
  state.show(View::normals);
  EXPECT_THAT(state.command_line(400, 300, 1, "a.png"), Not(HasSubstr("--legend")));
  ReadOptions options = kForPictures;
  options.color_by = "speed";
  state = state_of(kSpeeds, "a.xyz", options);
  state.annotations = {.color_bar = true, .legend = true, .color_bar_side = "left"};
  EXPECT_THAT(state.command_line(400, 300, 1, "a.png"),
              HasSubstr(" --color-bar --color-bar-side left -o"));
}

class FigureFiles : public TemporaryFolder {
 protected:
  template <class Work>
  static auto wait_for(const Work& poll) {
    auto result = poll();
    for (int i = 0; !result && i < 3000; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      result = poll();
    }
    EXPECT_TRUE(result);
    return result;
  }
};

TEST_F(FigureFiles, AreReadAgainWithOtherOptions) {
  const std::string path = file("a.xyz").string();
  put(path, std::string(kSpeeds) + kSpeeds);
  SceneFile scenes(path);
  ReadOptions options = kForPictures;
  const auto poll = [&] { return scenes.poll(1, options); };
  options.style = AtomStyle::sticks;
  scenes.reread(options);
  auto read = wait_for(poll);
  ASSERT_TRUE(read->scene);
  EXPECT_TRUE(read->is_reread);
  EXPECT_EQ(read->options, options);
  EXPECT_EQ(read->file->choices.style, AtomStyle::sticks);
  EXPECT_EQ(read->file->frames, 2u);
  // Of several requests the newest counts.
  options.frame = 7, scenes.reread(options);
  options.frame = 1, scenes.reread(options);
  read = wait_for(poll);
  EXPECT_TRUE(read->scene) << "frame 7 was not read";
  options.frame = 2, scenes.reread(options);
  read = wait_for(poll);
  ASSERT_FALSE(read->scene);
  EXPECT_THAT(read->scene.error().front().message, HasSubstr("there is no frame 2"));
  // A change on the disk is read with the options in use.
  options.frame = 0;
  EXPECT_FALSE(poll());
  put(path, std::string(kSpeeds) + kSpeeds + kSpeeds);
  read = wait_for(poll);
  ASSERT_TRUE(read->scene);
  EXPECT_FALSE(read->is_reread);
  EXPECT_EQ(read->options.style, AtomStyle::sticks);
  EXPECT_EQ(read->file->frames, 3u);
  options.frame = 2, scenes.reread(options);
  EXPECT_TRUE(wait_for(poll)->scene) << "of the new text";
}

TEST_F(FigureFiles, PicturesForPrintEqualThoseOfTheCommand) {
  const std::string path = file("a.xyz").string(), output = file("a.png").string();
  put(path, kSpeeds);
  ReadOptions options = kForPictures;
  options.color_by = "speed";
  ViewState state = state_of(kSpeeds, "a.xyz", options);
  state.path = path, state.form.width_mm = 30, state.form.dpi = 100, state.form.samples = 2;
  state.annotations = {.color_bar = true, .scale_bar = true};
  const RenderOptions print = state.print_request(400, 300);
  JobRequest job;
  job.scene = path, job.read = options, job.options = print, job.output = output;
  job.overlay = state.overlay(resolve_options(print, *state.scene));
  PrintJob printer([] {});
  printer.start(job, state.command_line(print, output));
  EXPECT_TRUE(printer.is_busy());
  const auto written = wait_for([&] { return printer.poll(); });
  ASSERT_TRUE(written && written->result) << written->result.error().text();
  EXPECT_FALSE(printer.is_busy());
  std::vector<std::string> words;
  for (const auto word : std::views::split(written->command, ' '))
    words.emplace_back(word.begin(), word.end());
  words.back() = file("b.png").string(), words.emplace_back("--quiet");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ASSERT_EQ(app::run_command_line(int(argv.size()) - 1, argv.data()), 0) << written->command;
  EXPECT_TRUE(get(output) == get(file("b.png"))) << written->command;
  const auto picture = read_image(output);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 118);
  EXPECT_EQ(picture->height, 89);
}

TEST_F(FigureFiles, StoppedPicturesAreNotWritten) {
  const std::string path = file("a.xyz").string(), output = file("a.png").string();
  put(path, kSpeeds);
  JobRequest job;
  job.scene = path, job.options.samples = 65536, job.output = output;
  PrintJob printer([] {});
  printer.start(job, "");
  printer.stop();
  const auto written = wait_for([&] { return printer.poll(); });
  ASSERT_TRUE(written && !written->result);
  EXPECT_EQ(written->result.error().kind, ErrorKind::stopped);
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace raio::core::view
