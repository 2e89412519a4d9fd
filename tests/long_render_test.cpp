// Renders that are interrupted, resumed, split, merged and repeated, by the program.
#include <sys/resource.h>

#include <thread>

#include "io/image/image.h"
#include "program.h"
#include "render/part.h"
#include "sanitized.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

class LongRender : public CommandLine {
 protected:
  // Runs `raio render ok.nff --quiet` with more arguments; expects success.
  void render(Arguments more) const {
    more.insert(more.begin(), {"render", "ok.nff", "--quiet", "--soft-shadows"});
    const Outcome o = raio(more);
    EXPECT_EQ(o.status, 0) << o.err;
  }
  void refused(Arguments more, std::string_view message, int status = 2) const {
    more.insert(more.begin(), {"render", "ok.nff", "--quiet", "--soft-shadows"});
    expect_refusal(more, status, message);
  }
  bool same(std::string_view a, std::string_view b) const {
    const std::string bytes = get(file(a));
    return !bytes.empty() && bytes == get(file(b));
  }

  // Waits for the file, which the program may not have written yet.
  void await(std::string_view name) const {
    for (int i = 0; i < 3000 && !fs::exists(file(name)); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
};

const Arguments kLong = {"render", "ok.nff",  "--quiet",   "--soft-shadows",
                         "--size", "400x300", "--samples", "100000"};

Arguments operator+(Arguments a, const Arguments& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST_F(LongRender, ACheckpointIsWrittenAndResumed) {
  render({"--samples", "12", "-o", "whole.png"});
  render({"--samples", "5", "-o", "few.png", "--checkpoint", "c.raio"});
  EXPECT_TRUE(fs::exists(file("c.raio")));
  refused({"--samples", "12", "-o", "x.png", "--checkpoint", "c.raio"}, "--resume");
  render({"--samples", "12", "-o", "on.png", "--checkpoint", "c.raio", "--resume"});
  EXPECT_TRUE(same("on.png", "whole.png"));
  render({"--samples", "12", "-o", "again.png", "--checkpoint", "c.raio", "--resume"});
  EXPECT_TRUE(same("again.png", "whole.png"));

  const auto resume = [&](Arguments more, std::string_view message) {
    refused(more + Arguments{"-o", "x.png", "--checkpoint", "c.raio", "--resume"}, message);
  };
  resume({"--samples", "5"}, "already has 12 samples per pixel");
  resume({"--samples", "12", "--depth", "2"}, "--depth 5, not 2");
  resume({"--aa", "2"}, "--sampler sobol, not jitter");
  put(file("ok.nff"), replaced("0.8 0.2 10", "0.8 0.2 11"));
  resume({"--samples", "12"}, "the scene differs");
}

TEST_F(LongRender, ResumeWithoutAFileBegins) {
  render({"--aa", "2", "-o", "whole.png"});
  render({"--aa", "2", "-o", "x.png", "--checkpoint", "c.raio", "--resume"});
  EXPECT_TRUE(same("x.png", "whole.png"));
}

TEST_F(LongRender, SamplesAreAdded) {
  render({"--samples", "12", "-o", "whole.exr"});
  render({"--samples", "5", "-o", "part.raio"});
  const Outcome o = raio({"render", "ok.nff", "--add-samples", "7", "--checkpoint", "part.raio",
                          "-o", "more.exr", "--threads", "3"});
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.err, HasSubstr("12 samples per pixel"));
  EXPECT_TRUE(same("more.exr", "whole.exr"));
  const auto add = [](std::string part) {
    return Arguments{"render", "ok.nff", "--add-samples", "7", "--checkpoint", part, "-o", "x.png"};
  };
  render({"--aa", "2", "-o", "cells.raio"});
  expect_refusal(add("cells.raio"), 2, "its samples are cells of");
  expect_refusal(add("none.raio"), 2, "No such file");
  expect_refusal(add("part.raio") + Arguments{"--depth", "3"}, 2, "leave out --depth");
}

// tests/kill_and_resume.py resumes from checkpoints.
TEST_F(LongRender, AnInterruptedRenderKeepsItsSamples) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Arguments keep = {"--checkpoint", "c.raio", "-o", "x.png"};
    const Running running(*this, kLong + keep + Arguments{"--checkpoint-interval", "0.05"}, {});
    await("c.raio");
    running.send(signal);
    const Outcome o = running.wait();
    EXPECT_EQ(o.status, 130) << o.err;
    EXPECT_THAT(o.err, HasSubstr("the samples so far are in c.raio, and --resume continues"));
    EXPECT_EQ(names(), (std::vector<std::string>{"c.raio", "ok.nff"}));
    const auto part = read_part(file("c.raio"));
    ASSERT_TRUE(part.has_value()) << part.error().text();
    fs::remove(file("c.raio"));
  }
}

TEST_F(LongRender, ShardsMergeToTheSameBytes) {
  render({"--size", "100x70", "--aa", "2", "-o", "whole.png"});
  for (const char* i : {"1", "2", "3"})
    render({"--size", "100x70", "--aa", "2", "--shard", std::string(i) + "/3", "-o",
            std::string(i) + ".raio", "--threads", i});
  EXPECT_EQ(raio({"merge", "3.raio", "1.raio", "2.raio", "-o", "x.png", "--quiet"}).status, 0);
  EXPECT_TRUE(same("x.png", "whole.png"));
  expect_refusal({"merge", "3.raio", "1.raio", "-o", "y.png"}, 2, "missing: shard 2/3");
  expect_refusal({"merge", "3.raio", "1.raio", "3.raio", "-o", "y.png"}, 2, "both have");
  EXPECT_EQ(raio({"merge", "3.raio", "1.raio", "-o", "y.raio", "--quiet"}).status, 0);
  EXPECT_EQ(raio({"merge", "2.raio", "y.raio", "-o", "y.png", "--quiet"}).status, 0);
  EXPECT_TRUE(same("y.png", "whole.png"));

  render({"--size", "100x70", "--aa", "3", "--shard", "2/3", "-o", "other.raio"});
  expect_refusal({"merge", "1.raio", "other.raio", "3.raio", "-o", "y.png"}, 2, "--aa 3, not 2");
  expect_refusal({"merge", "1.raio", "ok.nff", "-o", "z.png"}, 2,
                 "ok.nff: it is not a Raio part file");
  for (const char* target : {"no/z.png", "/proc/z.raio"})
    expect_refusal({"merge", "1.raio", "-o", target}, 3, target);
  expect_refusal({"merge", "1.raio", "2.raio", "3.raio", "-o", "/dev/full"}, 3, "No space left");
  expect_refusal({"merge", "-o", "z.png"}, 2, "PART is missing");
}

TEST_F(LongRender, SampleRangesMergeToTheSameBytes) {
  const Arguments all = {"--size", "60x40", "--samples", "9", "--soft-shadows"};
  const auto part = [&](const Arguments& options, const std::string& name) {
    render(all + options + Arguments{"-o", name, "--stats", "s.json"});
  };
  render(all + Arguments{"-o", "whole.png"});
  part({"--sample-range", "4:9"}, "late.raio");
  part({"--sample-range", "0:4", "--shard", "1/2"}, "a.raio");
  part({"--sample-range", "0:2", "--shard", "2/2"}, "b.raio");
  part({"--sample-range", "2:4", "--shard", "2/2"}, "c.raio");
  expect_refusal({"merge", "late.raio", "a.raio", "c.raio", "-o", "x.png"}, 2,
                 "samples 0:2 are missing in 2 of 4 tiles");
  expect_refusal({"merge", "late.raio", "b.raio", "late.raio", "-o", "x.png"}, 2,
                 "both have samples 4:9 in 4 of the 4 tiles");
  EXPECT_EQ(raio({"merge", "late.raio", "c.raio", "a.raio", "-o", "most.raio", "--quiet"}).status,
            0);
  EXPECT_EQ(raio({"merge", "b.raio", "most.raio", "-o", "x.png", "--quiet"}).status, 0);
  EXPECT_TRUE(same("x.png", "whole.png"));
  // A part with gaps is resumed like any other.
  render(all + Arguments{"--checkpoint", "most.raio", "--resume", "-o", "y.png"});
  EXPECT_TRUE(same("y.png", "whole.png"));

  for (const char* range : {"4", ":4", "4:", "4:4", "5:4", "-1:4", "0:4:2", "a:b"})
    refused({"--sample-range", range, "-o", "x.raio"}, "as in 0:64 or 64:128");
  refused({"--sample-range", "0:4", "-o", "x.png"}, ".raio");
  refused({"--sample-range", "0:4", "--time-limit", "3", "-o", "x.raio"}, "--time-limit");
  refused({"--sample-range", "0:10", "--samples", "9", "-o", "x.raio"},
          "exceeds the 9 samples per pixel");
  refused({"--sample-range", "0:4", "--add-samples", "2", "--checkpoint", "c.raio"},
          "--add-samples");
  part({"--sample-range", "0:4", "--checkpoint", "d.raio"}, "d2.raio");
  refused({"--size", "60x40", "--samples", "9", "--soft-shadows", "--checkpoint", "d.raio",
           "--resume", "-o", "x.png"},
          "add --sample-range 0:4");
}

TEST_F(LongRender, APictureIsRepeatedFromItself) {
  for (const Arguments& options : {Arguments{"--aa", "2", "--dof", "--seed", "5"},
                                   {"--samples", "7", "--light-size", "0.3", "--size", "33x21"},
                                   {"--accel", "grid", "--grid-factor", "1.5", "--depth", "3"}})
    for (const char* picture : {"a.png", "a.exr"}) {
      render(options + Arguments{"-o", picture});
      const std::string again = "again" + fs::path(picture).extension().string();
      EXPECT_EQ(
          raio({"render", "--repeat", picture, "ok.nff", "-o", again, "--threads", "1"}).status, 0);
      EXPECT_TRUE(same(again, picture));
    }
  // Without a scene, the stored file name in the picture's folder.
  EXPECT_EQ(raio({"render", "--repeat", "a.png", "-o", "b.png"}).status, 0);
  EXPECT_TRUE(same("a.png", "b.png"));

  expect_refusal({"render", "--repeat", "a.png", "--aa", "3", "-o", "x.png"}, 2, "leave out --aa");
  EXPECT_EQ(raio({"render", "ok.nff", "-o", "plain.ppm"}).status, 0);
  expect_refusal({"render", "--repeat", "plain.ppm", "ok.nff"}, 2, "only PNG and EXR pictures");
  ASSERT_TRUE(write_image(Image(2, 2), file("foreign.png"), {{"note", "none"}}).has_value());
  expect_refusal({"render", "--repeat", "foreign.png", "ok.nff"}, 2, "no settings of Raio");
  put(file("other.nff"), replaced("angle 40", "angle 41"));
  expect_refusal({"render", "--repeat", "a.png", "other.nff"}, 2, "the scene differs");
}

TEST_F(LongRender, APictureOfDataStoresHowItWasRead) {
  fs::copy_file(fs::path(RAIO_SOURCE_DIR) / "scenes/quartz.cif", file("quartz.cif"));
  const auto picture = [](const char* name) {
    return Arguments{"--quiet", "--size", "33x21", "--samples", "1", "-o", name};
  };
  const Arguments reads{"--style", "sticks", "--no-cell", "--images", "2,1,1"};
  ASSERT_EQ(raio(Arguments{"render", "quartz.cif"} + reads + picture("a.png")).status, 0);
  EXPECT_EQ(raio({"render", "--quiet", "--repeat", "a.png", "-o", "b.png"}).status, 0);
  EXPECT_TRUE(same("a.png", "b.png"));
  // Given ones replace all of the picture's, since old pictures stored none.
  EXPECT_EQ(raio(Arguments{"render", "--quiet", "--repeat", "a.png", "-o", "c.png"} + reads).status,
            0);
  EXPECT_TRUE(same("a.png", "c.png"));
  expect_refusal({"render", "--quiet", "--repeat", "a.png", "--style", "sticks"}, 2,
                 "the scene differs");
  // Annotations come from the same atoms.
  ASSERT_EQ(raio({"render", "--quiet", "--repeat", "a.png", "--scale-bar", "-o", "d.png"}).status,
            0);
  EXPECT_FALSE(same("a.png", "d.png"));
  expect_refusal({"render", "--quiet", "--repeat", "a.png", "--legend", "-o", "e.png"}, 2,
                 "no room for --legend");
  expect_refusal({"render", "--quiet", "quartz.cif", "--legend", "--view", "depth", "-o", "e.png"},
                 2, "--legend cannot be combined with --view depth");
}

TEST_F(LongRender, MetadataHoldNothingThatChanges) {
  render({"-o", "a.png", "--threads", "1"});
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  render({"-o", "b.png", "--threads", "2", "--counters", "--checkpoint", "c.raio"});
  EXPECT_TRUE(same("a.png", "b.png"));
}

TEST_F(LongRender, EndsInTime) {
  // One sample per pixel takes this many seconds on a busy machine.
  const std::string limit = tests::if_sanitized("4", "0.5");
  Outcome o = raio(kLong + Arguments{"--time-limit", limit, "-o", "a.png"});
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_LT(o.seconds, 20);
  EXPECT_EQ(raio({"render", "--repeat", "a.png", "ok.nff", "-o", "b.png"}).status, 0);
  EXPECT_TRUE(same("a.png", "b.png"));

  const Arguments cells = {"render", "ok.nff", "--aa",    "256",          "--lens-samples",
                           "9",      "--size", "400x300", "--time-limit", limit};
  o = raio(cells + Arguments{"-o", "a.png"});
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.err, HasSubstr(" of 589824 samples per pixel"));
  EXPECT_EQ(raio({"render", "--repeat", "a.png", "ok.nff", "-o", "b.png"}).status, 0);
  EXPECT_TRUE(same("a.png", "b.png"));

  refused({"--time-limit", "0.001", "--size", "3000x3000", "-o", "x.png"}, "too short", 3);
}

TEST_F(LongRender, NamesConflictingOptions) {
  refused({"--resume"}, "add --checkpoint");
  refused({"--add-samples", "3"}, "add --checkpoint");
  refused({"--shard", "1/2", "-o", "x.png"}, ".raio");
  refused({"--shard", "1/2"}, ".raio");
  for (const char* shard : {"0/2", "3/2", "1", "1/", "a/b", "-1/2"})
    refused({"--shard", shard, "-o", "x.raio"}, "as in 2/5");
  refused({"--shard", "1/2", "-o", "x.raio", "--time-limit", "3"}, "--time-limit");
  refused({"--checkpoint", "x.png", "-o", "x.png"}, "the picture cannot both be x.png");
  for (const char* kept : {"no/c.raio", "/proc/c.raio"}) refused({"--checkpoint", kept}, kept, 3);
  refused({"--checkpoint", "ok.nff", "--resume"}, "not a Raio part file");
}

TEST_F(LongRender, AFolderThatVanishesLosesTheCheckpointOnly) {
  fs::create_directory(file("kept"));
  const Running running(
      *this,
      {"render", "ok.nff", "--soft-shadows", "--size", "300x200", "--samples", "60", "-o", "x.png",
       "--checkpoint", "kept/c.raio", "--checkpoint-interval", "0.01"},
      {});
  await("kept/c.raio");
  fs::rename(file("kept"), file("gone"));  // at once, whatever is being written in it
  const Outcome o = running.wait();
  EXPECT_EQ(o.status, 3);
  EXPECT_THAT(o.err, HasSubstr("kept/c.raio"));
  EXPECT_TRUE(read_image(file("x.png")));
}

TEST_F(LongRender, AnUnwritablePictureIsInTheCheckpoint) {
  const Arguments keep = {"--samples", "60", "--size", "300x200", "--checkpoint", "c.raio"};
  fs::create_directory(file("out"));
  const Running running(
      *this,
      Arguments{"render", "ok.nff", "--quiet", "--soft-shadows", "--checkpoint-interval", "0.01"} +
          keep + Arguments{"-o", "out/x.png"},
      {});
  await("c.raio");
  fs::remove_all(file("out"));
  const Outcome o = running.wait();
  EXPECT_EQ(o.status, 3);
  EXPECT_THAT(o.err, HasSubstr("out/x.png"));
  render(keep + Arguments{"-o", "x.png", "--resume"});
  render({"--samples", "60", "--size", "300x200", "-o", "whole.png"});
  EXPECT_TRUE(same("x.png", "whole.png"));
}

// A limit of file sizes acts like a full disk.
TEST_F(LongRender, AFullDiskKeepsTheOldFile) {
#ifdef RAIO_SANITIZED
  GTEST_SKIP() << "the file that coverage writes is not to be limited";
#endif
  render({"--samples", "5", "--size", "100x70", "-o", "x.png", "--checkpoint", "c.raio"});
  const std::string before = get(file("c.raio")), picture = get(file("x.png"));
  rlimit limit{}, small{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  small = limit, small.rlim_cur = 10000;
  const Arguments more = {"render", "ok.nff", "--add-samples", "7",
                          "-o",     "x.png",  "--checkpoint",  "c.raio"};
  ::setrlimit(RLIMIT_FSIZE, &small);
  const Running running(*this, more, {});
  ::setrlimit(RLIMIT_FSIZE, &limit);
  const Outcome o = running.wait();
  EXPECT_EQ(o.status, 3);
  EXPECT_THAT(o.err, HasSubstr("c.raio: File too large"));
  EXPECT_TRUE(get(file("c.raio")) == before);
  EXPECT_TRUE(get(file("x.png")) == picture || read_image(file("x.png")).has_value());
  EXPECT_EQ(names(), (std::vector<std::string>{"c.raio", "ok.nff", "x.png"}));
}

TEST_F(LongRender, StaysWithinItsMemory) {
#ifdef RAIO_SANITIZED
  GTEST_SKIP() << "the sanitizers take memory of their own";
#endif
  for (const char* size : {"63M", "4", "4P", "x", "-4G", "4GB", "nan"})
    refused({"--memory-limit", size}, "as in 900M or 4G");
  render({"--memory-limit", "1G", "-o", "a.png"});
  refused({"--memory-limit", "0.25G", "--size", "9000x9000"}, "choose a smaller --size", 3);
  const Outcome group =
      raio({"render", "ok.nff", "--memory-limit", "64M", "--threads", "64", "--size", "500x500"});
  EXPECT_EQ(group.status, 3);
  EXPECT_THAT(group.err, HasSubstr("fewer --threads"));
  std::string many(kScene);
  for (int i = 0; i < 3000000; ++i) many += "s 1 2 3 4\n";
  put(file("many.nff"), many);
  const Outcome o = raio({"render", "many.nff", "--memory-limit", "64M", "-o", "x.png"});
  EXPECT_EQ(o.status, 3) << o.err;
  EXPECT_THAT(o.err, HasSubstr("not enough memory for the scene"));
  EXPECT_FALSE(fs::exists(file("x.png")));
}

}  // namespace
}  // namespace raio::core
