// Which pictures `raio render` makes and how they look, by the program.
#include <thread>

#include "io/image/image.h"
#include "program.h"

namespace raio {
namespace {

using Pictures = CommandLine;

TEST_F(Pictures, OfAPartAreCutFromTheWhole) {
  ASSERT_EQ(raio({"render", "ok.nff", "--aa", "2", "-o", "whole.ppm"}).status, 0);
  const Outcome o = raio({"render", "ok.nff", "--aa", "2", "--crop", "5,3,17,12", "-o", "part.ppm",
                          "--stats", "x.json"});
  EXPECT_EQ(o.status, 0);
  EXPECT_THAT(o.err, HasSubstr("part.ppm: 12x9 of 24x16, "));
  EXPECT_THAT(get(file("x.json")), HasSubstr("\"crop\": [\n    5,\n    3,\n    17,\n    12\n"));
  const Image whole = *read_image(file("whole.ppm")), part = *read_image(file("part.ppm"));
  ASSERT_EQ(part.width, 12);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) EXPECT_EQ(part.at(x, y), whole.at(x + 5, y + 3));
  expect_refusal({"render", "ok.nff", "--crop", "5,3,25,12"}, 2, "--crop: 5,3,25,12 ends outside");
  expect_refusal({"view", "ok.nff", "--crop", "5,3,17,12"}, 2, "--crop: the window shows whole");
  EXPECT_THAT(raio({"view", "--help"}).out, ::testing::Not(HasSubstr("--crop")));
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
  refused({"--checkpoint", "c.raio"}, "--checkpoint is about one picture");
  refused({"--shard", "1/2", "-o", "x.raio"}, "--shard is about one picture");
  refused({"--repeat", "a.png"}, "--repeat is about one picture");
  refused({"--stats", "x.json"}, "--stats is about one picture");
  refused({"--resume"}, "--resume is about one picture");
  refused({"--add-samples", "3"}, "--add-samples is about one picture");
  refused({"-o", "-"}, "standard output takes one picture");
  expect_refusal({"render", "ok.nff", "--turntable", "0"}, 2, "from 1 to 100000");
  expect_refusal({"render", "ok.nff", "--turntable", "2", "-o", "no/x.png"}, 3, "no/x-0001.png");
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
  EXPECT_THAT(o.err, ::testing::MatchesRegex(
                         "raio: interrupted(; [0-9]+ of 100000 pictures were written)?\n"));
}

}  // namespace
}  // namespace raio
