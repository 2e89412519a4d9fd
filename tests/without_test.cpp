// Messages of builds without optional parts, when these are requested.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/command_line.h"
#include "base/parallel.h"
#include "temporary_folder.h"

namespace raio::core::app {
namespace {

using testing::HasSubstr;

const std::string kScene =
    "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 16 16\n"
    "b 0 0 0\nl 3 4 5\nf 1 0 0 1 0 0 0 1\ns 0 0 0 1\n";

class BuildWithout : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    put(file("s.nff"), kScene);
  }

  struct Answer {
    int status;
    std::string said;
  };
  Answer ask(std::vector<std::string> words) {
    words.insert(words.begin(), "raio");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    testing::internal::CaptureStderr();
    const int status = run_command_line(int(arguments.size()), arguments.data());
    return {status, testing::internal::GetCapturedStderr()};
  }
  void refuses(const std::vector<std::string>& words, const std::string& why) {
    const Answer answer = ask(words);
    EXPECT_THAT(answer.status, testing::AnyOf(int(kBadInput), int(kNoResource))) << words.back();
    EXPECT_THAT(answer.said, HasSubstr(why));
    EXPECT_EQ(std::ranges::count(answer.said, '\n'), 1) << answer.said;
  }

  std::string scene_ = file("s.nff").string(), picture_ = file("s.png").string();
};

TEST_F(BuildWithout, GivesTheSamePicture) {
  for (const char* accel : {"none", "grid", "bvh"}) {
    const Answer answer = ask({"render", scene_, "-o", file(accel).string() + ".ppm", "--accel",
                               accel, "--aa", "2", "--soft-shadows"});
    EXPECT_EQ(answer.status, int(kDone)) << answer.said;
    EXPECT_EQ(get(file(accel + std::string(".ppm"))), get(file("none.ppm")));
  }
  EXPECT_EQ(ask({"render", scene_, "-o", picture_, "--checkpoint", file("s.raio").string()}).status,
            int(kDone));
  EXPECT_TRUE(std::filesystem::exists(file("s.raio")));
}

#ifdef RAIO_NO_WINDOW
TEST_F(BuildWithout, Window) { refuses({"view", scene_}, "no window"); }
#endif

#ifdef RAIO_NO_THREADS
TEST_F(BuildWithout, Threads) {
  EXPECT_EQ(max_concurrency(), 1);
  refuses({"render", scene_, "-o", picture_, "--threads", "2"}, "no threads");
  refuses({"render", scene_, "-o", picture_, "--progress", "on"}, "no threads");
  EXPECT_FALSE(std::filesystem::exists(picture_));
  EXPECT_EQ(ask({"render", scene_, "-o", picture_, "--threads", "1"}).status, int(kDone));
  EXPECT_EQ(ask({"render", scene_, "-o", picture_, "--checkpoint", file("c.raio").string(),
                 "--checkpoint-interval", "3"})
                .status,
            int(kDone));
}
#endif

#ifdef RAIO_NO_POSIX
TEST_F(BuildWithout, Posix) {
  refuses({"render", scene_, "-o", picture_, "--memory-limit", "1G"}, "cannot limit its memory");
}
#endif

#ifdef RAIO_NO_EMBREE
TEST_F(BuildWithout, Embree) {
  refuses({"render", scene_, "-o", picture_, "--accel", "embree"}, "no Embree");
}
#endif

#ifdef RAIO_NO_OPENEXR
TEST_F(BuildWithout, OpenExr) {
  refuses({"render", scene_, "-o", file("s.exr").string()}, "no OpenEXR");
  EXPECT_FALSE(std::filesystem::exists(file("s.exr")));
  put(file("b.exr"), "\x76\x2f\x31\x01 and more");
  refuses({"compare", file("b.exr").string(), file("b.exr").string()}, "no OpenEXR");
}
#endif

#ifdef RAIO_NO_JPEG
TEST_F(BuildWithout, Jpeg) {
  put(file("b.jpg"), "\xff\xd8\xff\xe0 and more");
  refuses({"compare", file("b.jpg").string(), file("b.jpg").string()}, "no libjpeg");
}
#endif

#ifdef RAIO_NO_GEMMI
TEST_F(BuildWithout, Gemmi) {
  refuses({"render", RAIO_SOURCE_DIR "/scenes/quartz.cif", "-o", picture_}, "no gemmi");
  put(file("a.pdb"),
      "CRYST1   10.000   20.000   30.000  90.00  90.00  90.00 P 1           1\n"
      "HETATM    1  O   HOH A   1       1.000   2.000   3.000  1.00  0.00           O\n");
  const Answer answer = ask({"render", file("a.pdb").string(), "-o", picture_});
  EXPECT_EQ(answer.status, int(kDone));
  EXPECT_THAT(answer.said, HasSubstr("the cell, since this build has no gemmi"));
}
#endif

#ifdef RAIO_NO_PLOTS
TEST_F(BuildWithout, Plots) {
  refuses({"bench", scene_, "--plot", file("p.svg").string()}, "no plots");
  refuses({"info", scene_, "--color-bar", file("p.svg").string()}, "no plots");
  refuses({"render", scene_, "-o", picture_, "--color-bar"}, "no plots");
}
#endif

}  // namespace
}  // namespace raio::core::app
