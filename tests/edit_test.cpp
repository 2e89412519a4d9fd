// Edits of scenes, their history, and the window's files.
#include "view/edit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "io/file.h"
#include "io/nff/nff.h"
#include "io/scene_file.h"
#include "view/file_dialog.h"
#include "view/files.h"
#include "view/history.h"
#include "view/memory.h"
#include "view/state.h"
#include "view/texts.h"
#include "view/thumbnails.h"
#include "view_scenes.h"

namespace raio::core::view {
namespace {

TEST(History, UndoesAndRedoesUntilAChange) {
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

TEST(History, ForgetsTheOldestButNotTheCurrentState) {
  History<int> history(0);
  EXPECT_FALSE(history.settle(0));
  for (const int state : {1, 2, 3}) EXPECT_TRUE(history.settle(state));
  EXPECT_TRUE(history.forget_oldest());
  EXPECT_EQ(history.states(), (std::vector{1, 2, 3}));
  EXPECT_EQ(history.undo(), 2);
  EXPECT_TRUE(history.forget_oldest());
  EXPECT_FALSE(history.can_undo());
  EXPECT_FALSE(history.forget_oldest());
  EXPECT_EQ(history.redo(), 3);
}

TEST(History, EveryChangeOfTheStateIsAStep) {
  ViewState state("some.nff", scene(), {});
  History<ViewState> history(state);
  for (const Command effect :
       {Command::antialiasing, Command::soft_shadows, Command::depth_of_field, Command::structure,
        Command::reflection, Command::refraction, Command::gloss, Command::translucency}) {
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

TEST(Edit, SharesUnchangedArrays) {
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
  EXPECT_TRUE(after->spheres.shares(before->spheres));
  EXPECT_TRUE(after->positions.shares(before->positions));
  EXPECT_NE(content_hash(*after), content_hash(*before));
  EXPECT_TRUE(validate(*after).empty());
  const auto back = edited(after, [&](Scene& s) {
    s.materials[0].color = color;
    s.lights.pop_back();
    s.background = before->background;
  });
  EXPECT_EQ(content_hash(*back), content_hash(*before));
  EXPECT_TRUE(back->spheres.shares(before->spheres));
}

TEST(Edit, SavedScenesReadBackAsDisplayed) {
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

TEST(Edit, EditsDuringWritingAreKept) {
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
  // Failed writes say why.
  EXPECT_FALSE(saved(state, "nowhere/first.nff").result);
  EXPECT_FALSE(saved(state, "first.txt").result);
  std::filesystem::remove_all(folder);
}

TEST(Memory, KeepsTheThemeAndExistingScenes) {
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
  EXPECT_EQ(entries_of(folder, FileKind::all),
            (std::vector<std::string>{"A/", "z/", "a.raio", "b.nff", "c.png"}));
  EXPECT_TRUE(entries_of(folder / "nowhere").empty());
  std::filesystem::remove_all(folder);
}

TEST(Samples, AreTheScenesOfTheTree) {
  const SampleScenes samples = sample_scenes();
  EXPECT_GE(samples.others.size(), 20u);
  EXPECT_GE(samples.course.size(), 5u);
  EXPECT_TRUE(samples.course.front().ends_with("/scenes/course/glass.nff"));
}

// Looks at the disk until there is a result.
SceneFile::Read next_read(SceneFile& file) {
  for (int i = 0; i < 600; ++i) {
    if (auto read = file.poll(1, kForPictures)) return std::move(*read);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return {"nothing", std::unexpected(Diagnostics{}), {}};
}

TEST(SceneFile, AFileThatIsGoneIsReportedOnceAndReadAgainWhenItReturns) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("raio_gone_{}", std::random_device()());
  std::filesystem::create_directories(folder);
  const auto path = folder / "a.nff", away = folder / "away.nff";
  ASSERT_TRUE(write_file(path, write_nff(*scene())));
  SceneFile file(path.string());
  std::filesystem::rename(path, away);
  const SceneFile::Read gone = next_read(file);
  EXPECT_EQ(gone.path, path.string());
  ASSERT_FALSE(gone.scene);
  ASSERT_EQ(gone.scene.error().size(), 1u);
  EXPECT_EQ(gone.scene.error()[0].text(),
            path.string() + ": error: the file is gone; the picture shows its last version");
  for (int i = 0; i < 30; ++i) {
    EXPECT_FALSE(file.poll(1, kForPictures)) << "it was reported";
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  std::filesystem::rename(away, path);  // with the time that it had
  const SceneFile::Read back = next_read(file);
  EXPECT_EQ(back.path, path.string());
  ASSERT_TRUE(back.scene);
  EXPECT_EQ((*back.scene)->spheres.size(), scene()->spheres.size());
  std::filesystem::remove_all(folder);
}

TEST(Thumbnails, HaveOneShape) {
  const std::string scenes = std::string(RAIO_SOURCE_DIR) + "/scenes/";
  const auto wide = make_thumbnail(scenes + "course/solids.nff");  // 300 x 200
  ASSERT_TRUE(wide) << wide.error();
  const auto billiards = make_thumbnail(scenes + "billiards.p3f");  // wider
  ASSERT_TRUE(billiards) << billiards.error();
  for (const Image& image : {wide->image, billiards->image}) {
    EXPECT_EQ(image.width, 240);
    EXPECT_EQ(image.height, 160);
  }
  EXPECT_TRUE(wide->about.starts_with("A ball, a pyramid")) << wide->about;
  const auto square = make_thumbnail(scenes + "shapes.nff");
  ASSERT_TRUE(square) << square.error();
  EXPECT_EQ(square->image.height, 160);
  EXPECT_NE(square->image.pixels.front(), square->image.pixels[80 * 240 + 120]);
  const auto atoms = make_thumbnail(scenes + "fullerene.xyz");
  ASSERT_TRUE(atoms) << atoms.error();
  EXPECT_EQ(atoms->primitives,
            read_scene(scenes + "fullerene.xyz", kForPictures)->scene.primitive_count());
  EXPECT_FALSE(make_thumbnail(scenes + "README"));
}

TEST(Thumbnails, AreMadeInOrderAndEndWithTheirOwner) {
  const std::string scenes = std::string(RAIO_SOURCE_DIR) + "/scenes/";
  const std::vector<std::string> paths = {scenes + "salt.xyz", "none.nff", scenes + "shapes.nff"};
  Thumbnails thumbnails(paths, [] {});
  std::vector<Thumbnails::Made> made;
  for (int i = 0; i < 6000 && made.size() < paths.size(); ++i) {
    for (auto& one : thumbnails.take()) made.push_back(std::move(one));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_EQ(made.size(), paths.size());
  for (size_t i = 0; i < paths.size(); ++i) {
    EXPECT_EQ(made[i].path, paths[i]);
    EXPECT_EQ(made[i].thumbnail.has_value(), i != 1);
  }
  std::atomic<int> calls = 0;
  {
    const Thumbnails ended(std::vector(1000, paths[2]), [&] { ++calls; });
  }
  EXPECT_LT(calls, 1000);
}

}  // namespace
}  // namespace raio::core::view
