// Which pictures `raio render` makes and how they look, by the program.
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

}  // namespace
}  // namespace raio
