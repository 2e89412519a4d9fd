// The pictures of `raio render` and their annotations, by the program.
#include <thread>

#include "io/image/image.h"
#include "program.h"
#include "render/provenance.h"

namespace raio::core {
namespace {

using Pictures = CommandLine;

TEST_F(Pictures, OfAPartAreCutFromTheWhole) {
  ASSERT_EQ(raio({"render", "ok.nff", "--aa", "2", "-o", "whole.ppm"}).status, 0);
  const Outcome o = raio({"render", "ok.nff", "--aa", "2", "--crop", "5,3,17,12", "-o", "part.ppm",
                          "--stats", "x.json"});
  EXPECT_EQ(o.status, 0);
  EXPECT_THAT(o.err, HasSubstr("part.ppm: 12x9 of 24x16, "));
  EXPECT_THAT(get(file("x.json")), HasSubstr("\"crop\": [5, 3, 17, 12],\n"));
  const Image whole = *read_image(file("whole.ppm")), part = *read_image(file("part.ppm"));
  ASSERT_EQ(part.width, 12);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) EXPECT_EQ(part.at(x, y), whole.at(x + 5, y + 3));
  expect_refusal({"render", "ok.nff", "--crop", "5,3,25,12"}, 2, "--crop: 5,3,25,12 ends outside");
  expect_refusal({"view", "ok.nff", "--crop", "5,3,17,12"}, 2, "--crop: the window shows whole");
  EXPECT_THAT(raio({"view", "--help"}).out, testing::Not(HasSubstr("--crop")));
}

TEST_F(Pictures, OfATurntableGoAroundTheScene) {
  const std::vector<std::string> turn = {"render",  "ok.nff",     "--turntable", "4",
                                         "--aa",    "2",          "--dof",       "-o",
                                         "x/t.png", "--progress", "on"};
  std::filesystem::create_directory(file("x"));
  const Outcome o = raio(turn);
  EXPECT_EQ(o.status, 0) << o.err;
  for (const char* label : {"1/4  ", "4/4  ", "x/t-0001.png: 24x16", "x/t-0004.png: 24x16"})
    EXPECT_THAT(o.err, HasSubstr(label));
  // From (0, -5, 0) about z.
  for (const auto& [picture, from] :
       {std::pair("1", "0,-5,0"), {"2", "5,0,0"}, {"3", "0,5,0"}, {"4", "-5,0,0"}}) {
    const std::string name = std::string("x/t-000") + picture + ".png";
    EXPECT_EQ(
        raio({"render", "ok.nff", "--aa", "2", "--dof", "--from", from, "-o", "a.png"}).status, 0);
    EXPECT_TRUE(get(file("a.png")) == get(file(name))) << picture;
    EXPECT_EQ(raio({"render", "--repeat", name, "ok.nff", "-o", "b.png"}).status, 0);
    EXPECT_TRUE(get(file("b.png")) == get(file(name))) << picture;
  }
  EXPECT_FALSE(get(file("x/t-0001.png")) == get(file("x/t-0002.png")));
  EXPECT_FALSE(std::filesystem::exists(file("x/t.png")));
}

// Data has the angle of view at which all of it is in the picture, from every side the same.
TEST_F(Pictures, OfATurntableOfDataHaveOneAngle) {
  put(file("row.xyz"), "3\n\nC 0 0 0\nC 0 0 2\nC 0 0 4\n");
  ASSERT_EQ(raio({"render", "row.xyz", "--size", "16x40", "--samples", "2", "--turntable", "2",
                  "-o", "t.png"})
                .status,
            0);
  const auto angle = [&](const std::string& name) {
    return std::string(setting(read_metadata(file(name)).value(), "fov"));
  };
  EXPECT_NE(angle("t-0001.png"), "");
  EXPECT_EQ(angle("t-0001.png"), angle("t-0002.png"));
}

TEST_F(Pictures, OfATurntableAreOfOneReading) {
  // A scene without a light is warned of once, and a pipe can be read once.
  put(file("dark.nff"), replaced("l 3 -4 5\n", ""));
  const Outcome o = raio({"render", "-", "--turntable", "3", "--crop", "1,1,9,9"},
                         {.input = file("dark.nff"), .output = {}, .errors = {}});
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_EQ(o.err.find("has no light"), o.err.rfind("has no light"));
  EXPECT_EQ(names(), (std::vector<std::string>{"dark.nff", "ok.nff", "stdin-0001.png",
                                               "stdin-0002.png", "stdin-0003.png"}));
}

TEST_F(Pictures, OfATurntableGoIntoFiles) {
  const auto refused = [&](std::vector<std::string> more, std::string_view message) {
    more.insert(more.begin(), {"render", "ok.nff", "--turntable", "4"});
    expect_refusal(more, 2, message);
  };
  refused({"--checkpoint", "c.raio"}, "--checkpoint works for one picture only");
  refused({"--shard", "1/2", "-o", "x.raio"}, "--shard works for one picture only");
  refused({"--repeat", "a.png"}, "--repeat works for one picture only");
  refused({"--stats", "x.json"}, "--stats works for one picture only");
  refused({"--resume"}, "--resume works for one picture only");
  refused({"--add-samples", "3"}, "--add-samples works for one picture only");
  refused({"-o", "-"}, "standard output takes one picture");
  expect_refusal({"render", "ok.nff", "--turntable", "0"}, 2, "from 1 to 100000");
  expect_refusal({"render", "ok.nff", "--turntable", "2", "-o", "no/x.png"}, 3, "no/x-0001.png");
}

TEST_F(Pictures, OfFramesGoIntoFiles) {
  std::string frames;
  for (int i = 0; i < 5; ++i) frames += "2\n\nC 0 0 0\nO " + std::to_string(i + 1) + ".5 0 0\n";
  put(file("run.xyz"), frames);
  const auto render = [&](const std::string& range, const std::string& output) {
    return raio(
        {"render", "run.xyz", "--frame", range, "--size", "24x16", "--samples", "2", "-o", output});
  };
  const Outcome o = render("1::2", "a.png");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.err, HasSubstr("a-0002.png: 24x16"));
  EXPECT_FALSE(std::filesystem::exists(file("a-0003.png")));
  // The first is the picture of that frame; the others have its camera.
  EXPECT_EQ(render("1", "one.ppm").status, 0);
  EXPECT_EQ(render("3", "other.ppm").status, 0);
  EXPECT_EQ(render("-4:-1:2", "b.ppm").status, 0);
  EXPECT_TRUE(get(file("b-0001.ppm")) == get(file("one.ppm")));
  EXPECT_FALSE(get(file("b-0002.ppm")) == get(file("other.ppm")));
  const Outcome again =
      raio({"render", "--repeat", "a-0002.png", "run.xyz", "--frame", "3", "-o", "c.png"});
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(get(file("c.png")) == get(file("a-0002.png")));
  std::string broken = frames;
  broken.replace(broken.find("O 3"), 3, "O z");
  put(file("broken.xyz"), broken);
  const Outcome half =
      raio({"render", "broken.xyz", "--frame", "0:4", "--size", "8x8", "-o", "d.png"});
  EXPECT_EQ(half.status, 2);
  EXPECT_THAT(half.err, HasSubstr("broken.xyz:12:3: error"));
  const auto refused = [&](std::vector<std::string> more, std::string_view message) {
    more.insert(more.begin(), "render");
    expect_refusal(more, 2, message);
  };
  refused({"run.xyz", "--frame", "3:3"}, "this range contains no frame; the file has 5");
  refused({"run.xyz", "--frame", "7:9"}, "there is no frame 7; the file has 5");
  refused({"run.xyz", "--frame", "1:2:0"}, "a range such as 0:100:5, found '1:2:0'");
  refused({"run.xyz", "--frame", "x"}, "expected the number of a frame");
  refused({"ok.nff", "--frame", "0:2"}, "has no effect on this file");
  refused({"-", "--frame", "0:2"}, "needs one scene file");
  refused({"run.xyz", "--frame", "0:2", "--turntable", "3"}, "cannot be combined with --turntable");
  refused({"run.xyz", "--frame", "0:2", "--shard", "1/2"}, "--shard works for one picture only");
}

TEST_F(Pictures, OfATurntableEndWhenInterrupted) {
  const Running running(
      *this, {"render", "ok.nff", "--turntable", "100000", "--quiet", "-o", "t.png"}, {});
  for (int i = 0; i < 3000 && !std::filesystem::exists(file("t-000002.png")); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  running.send(SIGINT);
  const Outcome o = running.wait();
  EXPECT_EQ(o.status, 130) << o.err;
  // On a machine that is too busy it ends without a count.
  EXPECT_THAT(o.err, testing::MatchesRegex(
                         "raio: interrupted(; [0-9]+ of 100000 pictures were written)?\n"));
}

TEST_F(Pictures, OfSeveralScenesGoIntoAFolder) {
  put(file("a.nff"), replaced("s 0 0 0 1", "s 0 0 0 0.5"));
  put(file("b.b.p3f"), kScene);
  const Outcome o = raio({"render", "a.nff", "ok.nff", "b.b.p3f", "--aa", "2", "-o", "deep/down/"});
  EXPECT_EQ(o.status, 0) << o.err;
  for (const auto& [scene, picture] : {std::pair("a.nff", "deep/down/a.png"),
                                       {"ok.nff", "deep/down/ok.png"},
                                       {"b.b.p3f", "deep/down/b.b.png"}}) {
    EXPECT_THAT(o.err, HasSubstr(std::string(picture) + ": 24x16"));
    EXPECT_EQ(raio({"render", scene, "--aa", "2", "-o", "x.png"}).status, 0);
    EXPECT_TRUE(get(file("x.png")) == get(file(picture))) << picture;
  }
  // One that is there needs no slash, and without a name the pictures come here.
  EXPECT_EQ(raio({"render", "a.nff", "ok.nff", "--crop", "0,0,9,9", "-o", "deep"}).status, 0);
  EXPECT_EQ(read_image(file("deep/ok.png"))->width, 9);
  EXPECT_EQ(raio({"render", "a.nff", "ok.nff", "--turntable", "2"}).status, 0);
  EXPECT_TRUE(std::filesystem::exists(file("a-0002.png")));
  EXPECT_TRUE(std::filesystem::exists(file("ok-0001.png")));
  EXPECT_EQ(raio({"render", "ok.nff", "-o", "one/"}).status, 0);
  EXPECT_TRUE(read_image(file("one/ok.png")));
}

TEST_F(Pictures, OfValidScenesAreRenderedDespiteBrokenOnes) {
  put(file("bad.nff"), replaced("s 0 0 0 1", "s 0 0 zero 1"));
  put(file("small.nff"), replaced("resolution 24 16", "resolution 8 8"));
  const Outcome o = raio(
      {"render", "missing.nff", "bad.nff", "small.nff", "ok.nff", "--crop", "0,0,9,9", "-o", "x/"});
  EXPECT_EQ(o.status, 2);
  for (const char* said :
       {"missing.nff: error: ", "bad.nff:", "small.nff: --crop: 0,0,9,9", "x/ok.png: 9x9 of 24x16"})
    EXPECT_THAT(o.err, HasSubstr(said));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(file("x")), {}), 1);
  // The first of several failures determines the status.
  std::filesystem::create_directory(file("x/bad.png"));
  put(file("bad.nff"), kScene);
  EXPECT_EQ(raio({"render", "bad.nff", "missing.nff", "-o", "x/"}).status, 3);
  EXPECT_EQ(raio({"render", "missing.nff", "bad.nff", "-o", "x/"}).status, 2);
}

TEST_F(Pictures, OfSeveralScenesHaveDistinctNames) {
  std::filesystem::create_directory(file("other"));
  put(file("other/ok.p3f"), kScene);
  put(file("a.nff"), kScene);
  expect_refusal({"render", "ok.nff", "a.nff", "other/ok.p3f", "-o", "x/"}, 2,
                 "ok.nff and other/ok.p3f would both become ok.png");
  expect_refusal({"render", "ok.nff", "a.nff", "-o", "x.png"}, 2,
                 "need an output folder, as in -o");
  expect_refusal({"render", "ok.nff", "a.nff", "-o", "-"}, 2, "standard output takes one picture");
  expect_refusal({"render", "ok.nff", "a.nff", "-o", "ok.nff/x/"}, 3, "ok.nff/x/");
  for (const std::vector<std::string>& about_one :
       {std::vector<std::string>{"--checkpoint", "c.raio"},
        {"--shard", "1/2"},
        {"--stats", "x.json"},
        {"--repeat", "x.png"},
        {"--resume"},
        {"--add-samples", "2"}}) {
    std::vector<std::string> arguments = {"render", "ok.nff", "a.nff", "-o", "x/"};
    arguments.insert(arguments.end(), about_one.begin(), about_one.end());
    expect_refusal(arguments, 2, about_one.front() + " works for one picture only; give one scene");
  }
}

}  // namespace
}  // namespace raio::core
