// The real window's files: scenes that are opened, edited and saved, and pictures.
#include <X11/keysym.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "io/image/image.h"
#include "window_fixture.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using Held = WindowDriver::Held;

class WindowFilesTest : public WindowTest {};

TEST_F(WindowFilesTest, SavedPicturesMatchTheCommandLine) {
  const auto window = open({"--light-size", "0.5", "--soft-shadows"});
  window->key(XK_a);
  window->key(XK_d);
  window->drag(80, 60, 113, 77);
  ASSERT_TRUE(window->wait_for("camera: ", 0)) << window->log();
  for (const auto& [shift, suffix] : {std::pair(false, ".png"), {true, ".exr"}}) {
    const size_t from = window->mark();
    ASSERT_TRUE(window->wait_for("picture: .* samples [5-9]", from)) << window->log();
    window->key(XK_p, shift ? Held::shift : Held::nothing);
    const auto saved = window->wait_for("saved (.*)", from);
    ASSERT_TRUE(saved) << window->log();
    EXPECT_EQ(saved->groups[1], std::string("scene") + suffix + " in " +
                                    std::filesystem::canonical(folder()).string());
    const auto command = window->wait_for("command: (.*)", from);
    ASSERT_TRUE(command) << window->log();
    EXPECT_THAT(command->groups[1], HasSubstr(" --samples "));
    run(command->groups[1], std::string("again") + suffix);
    EXPECT_TRUE(get(file(std::string("scene") + suffix)) ==
                get(file(std::string("again") + suffix)))
        << command->groups[1];
    window->key(XK_s);  // another one
  }
  // A second one does not replace the first.
  const size_t from = window->mark();
  window->key(XK_p);
  EXPECT_TRUE(window->wait_for("saved scene-2.png in ", from));
}

TEST_F(WindowFilesTest, AtomsAreDrawnAsRequested) {
  put(file("water.xyz"), "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
  WindowDriver window(*display_,
                      {"water.xyz", "--size", "60x40", "--style", "sticks", "--radius", "1"},
                      folder().string());
  const auto picture = window.picture(0, 4);
  ASSERT_TRUE(picture) << window.log();
  size_t from = window.mark();
  window.key(XK_c);
  const auto command = window.wait_for("command: (.*)", from);
  ASSERT_TRUE(command) << window.log();
  EXPECT_THAT(command->groups[1], HasSubstr("water.xyz --style sticks --radius 1 --"));
  // And again when the file changes.
  from = window.mark();
  put(file("water.xyz"), "2\n\nO 0 0 0\nH 0.96 0 0\n");
  ASSERT_TRUE(window.picture(from)) << window.log();
  from = window.mark();
  window.key(XK_c);
  EXPECT_TRUE(window.wait_for("command: .* --style sticks", from)) << window.log();
}

// A key that follows a click before the next frame: only that frame shows that a field was hit. And
// clicks that follow each other within a frame are two.
TEST_F(WindowFilesTest, KeysRightAfterAClickIntoAFieldAreText) {
  put(file("water.xyz"), "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
  remember("size 900 900");
  WindowDriver window(*display_, {"water.xyz"}, folder().string());
  constexpr int kAcross = 780, kDown = 246;  // in the panel's field "hide"
  constexpr int kTimes = 10;
  for (int i = 0; i < kTimes; ++i) {
    size_t from = window.mark();
    window.click(kAcross, kDown);
    window.key(i % 2 == 0 ? XK_k : XK_l);
    ASSERT_TRUE(window.wait_for(" types$", from)) << window.log();
    from = window.mark();
    window.click(100, 100);
    ASSERT_TRUE(window.wait_for(" typed$", from)) << window.log();
  }
  for (const char* said : {"boxes of the structure", "light colours", "dark colours"})
    EXPECT_EQ(window.log().find(said), std::string::npos) << said;
  // After a click into the picture they are keys.
  const size_t from = window.mark();
  window.click(100, 100);
  window.key(XK_k);
  EXPECT_TRUE(window.wait_for("boxes of the structure shown", from)) << window.log();
}

TEST_F(WindowFilesTest, ShowsPicturesAsTheyAreWritten) {
  const auto window =
      open({"--aa", "1", "--exposure", "0.5", "--tone", "agx", "--background", "navy"});
  const auto shown = window->picture(0);
  ASSERT_TRUE(shown) << window->log();
  size_t from = window->mark();
  window->key(XK_p);
  const auto command = window->wait_for("command: (.*)", from);
  ASSERT_TRUE(command) << window->log();
  ASSERT_TRUE(window->wait_for("saved scene.png", from)) << window->log();
  run(command->groups[1], "again.png");
  EXPECT_TRUE(get(file("scene.png")) == get(file("again.png"))) << command->groups[1];
  const auto picture = read_image(file("again.png"));
  ASSERT_TRUE(picture);
  uint64_t sum = 14695981039346656037u;  // FNV-1a, as Texture::checksum() has it
  for (const Rgb& c : picture->pixels)
    for (const uint8_t byte : {to_byte(c.x), to_byte(c.y), to_byte(c.z), uint8_t(255)})
      sum = (sum ^ byte) * 1099511628211u;
  EXPECT_EQ(shown->sum, fmt::format("{:016x}", sum));
  // A view has no exposure, and it is not lost by looking at one.
  from = window->mark();
  window->key(XK_2);
  ASSERT_TRUE(window->picture(from)) << window->log();
  from = window->mark();
  window->key(XK_1);
  EXPECT_EQ(window->picture(from)->sum, shown->sum);
}

TEST_F(WindowFilesTest, ABrokenEditKeepsTheSceneAndAValidOneReplacesIt) {
  const auto window = open();
  const auto before = window->picture(0);
  size_t from = window->mark();
  put(file("scene.nff"), "b 0 0 0\ns 1 2 three 4\n");
  ASSERT_TRUE(window->wait_for("scene.nff:2:7: error: ", from)) << window->log();
  from = window->mark();
  window->key(XK_2);
  window->key(XK_1);
  ASSERT_TRUE(window->wait_for("view: picture", from));
  EXPECT_EQ(window->picture(window->wait_for("view: picture", from)->next)->sum, before->sum);

  from = window->mark();
  put(file("scene.nff"), std::string(kWindowScene) + "f 0 0 1 1 0 1 0 1\ns 0 -2 0.4 0.4\n");
  ASSERT_TRUE(window->wait_for("opened scene.nff", from)) << window->log();
  EXPECT_NE(window->picture(from)->sum, before->sum);
}

TEST_F(WindowFilesTest, ADeletedFileIsReportedAndReadWhenItReturns) {
  const auto window = open();
  size_t from = window->mark();
  std::filesystem::remove(file("scene.nff"));
  ASSERT_TRUE(window->wait_for("scene.nff: error: the file is gone; ", from)) << window->log();
  from = window->mark();
  put(file("scene.nff"), kWindowScene);
  ASSERT_TRUE(window->wait_for("opened scene.nff", from)) << window->log();
  EXPECT_TRUE(window->picture(from));
}

TEST_F(WindowFilesTest, ComparesWithAnotherProgramsPicture) {
  const std::string render = RAIO_PROGRAM " render scene.nff";
  run(render + " --size 40x30 -o .png", "mine.ppm");
  const auto window = open({"--compare", "mine.ppm", "--size", "160x120"});
  ASSERT_TRUE(window->wait_for("compared: samples 1 rmse 0 largest 0 above 8 0", 0))
      << window->log();
  EXPECT_TRUE(window->wait_for("picture: 40x30 ", 0)) << window->log();
  // It is read again when the program has written it again.
  size_t from = window->mark();
  run(render + " --size 40x30 --no-reflection -o .png", "mine.ppm");
  const auto found =
      window->wait_for("compared: samples 1 rmse ([0-9.]+) .* above 8 0.[0-9]+", from);
  ASSERT_TRUE(found) << window->log();
  // As `raio compare` finds it.
  run(render + " --size 40x30 -o .png", "raio.ppm");
  const Image a = *read_image(file("raio.ppm")), b = *read_image(file("mine.ppm"));
  EXPECT_EQ(found->groups[1], fmt::format("{:.6g}", compare(a, b).rmse));
  // The effect that the other program lacks.
  from = window->mark();
  window->key(XK_r);
  EXPECT_TRUE(window->wait_for("compared: samples 1 rmse 0 ", from)) << window->log();
  from = window->mark();
  put(file("mine.ppm"), "P6 2");
  EXPECT_TRUE(window->wait_for("mine.ppm: ", from)) << window->log();
}

TEST_F(WindowFilesTest, OpensASceneByItsNameAndRemembersIt) {
  const auto window = open_without_scene();
  EXPECT_EQ(window->title(), "Raio");
  EXPECT_TRUE(window->wait_for(" pictured: .*/scenes/course/solids.nff", 0)) << window->log();
  size_t from = window->mark();
  window->key(XK_o, Held::ctrl);
  ASSERT_TRUE(window->wait_for(" types", from)) << window->log();
  for (const unsigned long key : {XK_s, XK_c, XK_e, XK_n, XK_e, XK_period, XK_n, XK_f, XK_f})
    window->key(key);
  window->key(XK_Return);
  ASSERT_TRUE(window->wait_for("opened scene.nff", from)) << window->log();
  ASSERT_TRUE(window->picture(from)) << window->log();
  EXPECT_THAT(window->title(), HasSubstr("scene"));
  ASSERT_TRUE(window->wait_for(" typed", from)) << window->log();
  from = window->mark();
  window->key(XK_a);
  EXPECT_TRUE(window->wait_for("antialiasing on", from)) << "the dialog keeps the keys";
  EXPECT_THAT(get(file("state/raio/window")), HasSubstr("/scene.nff\n"));
}

TEST_F(WindowFilesTest, EscapeClosesTheDialogAndNotTheWindow) {
  const auto window = open();
  window->key(XK_o, Held::ctrl);
  ASSERT_TRUE(window->wait_for(" types", 0)) << window->log();
  window->key(XK_Escape);
  ASSERT_TRUE(window->wait_for(" typed", 0)) << window->log();
  const size_t from = window->mark();
  window->key(XK_r);
  ASSERT_TRUE(window->wait_for("reflection off", from)) << window->log();
}

TEST_F(WindowFilesTest, SavesTheSceneAsDisplayed) {
  const auto window = open();
  window->drag(80, 60, 110, 70);
  const auto rest = window->wait_for("camera: ", 0);
  ASSERT_TRUE(rest) << window->log();
  const auto moved = window->picture(rest->next - 1);
  size_t from = window->mark();
  window->key(XK_s, Held::ctrl);
  ASSERT_TRUE(window->wait_for(" types", from)) << window->log();
  window->key(XK_Return);
  ASSERT_TRUE(window->wait_for("saved the scene as .*/scene-2.nff", from)) << window->log();
  EXPECT_EQ(get(file("scene.nff")), kWindowScene);
  const auto again = window->picture(from);
  ASSERT_TRUE(again) << window->log();
  EXPECT_EQ(again->sum, moved->sum);
  ASSERT_TRUE(window->wait_for(" typed", from)) << window->log();
  // The file is the picture, without a camera on the command line.
  from = window->mark();
  window->key(XK_p);
  const auto command = window->wait_for("command: (.*)", from);
  ASSERT_TRUE(command) << window->log();
  EXPECT_THAT(command->groups[1], HasSubstr(" scene-2.nff "));
  EXPECT_THAT(command->groups[1], testing::Not(HasSubstr("--from")));
  ASSERT_TRUE(window->wait_for("saved scene-2.png", from)) << window->log();
  run(command->groups[1], "again.png");
  EXPECT_TRUE(get(file("scene-2.png")) == get(file("again.png")));
}

}  // namespace
}  // namespace raio::core
