// Environments from files: Radiance HDR pictures, the light and the orientation of a picture, what
// is refused, and pictures that are continued and repeated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/srgb.h"
#include "io/image/codecs.h"
#include "io/scene_file.h"
#include "one_picture.h"
#include "render/job.h"
#include "render/picture_options.h"
#include "render/read_options.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using std::numbers::pi;
using testing::HasSubstr;
using tests::picture_of;
using tests::same_bytes;

const std::string kHead = "#?RADIANCE\n# by hand\nFORMAT=32-bit_rle_rgbe\n";

std::string hdr_of(std::string_view size, std::string_view pixels, std::string_view more = "") {
  return kHead + std::string(more) + "\n" + std::string(size) + "\n" + std::string(pixels);
}
std::string why_no_hdr(std::string_view bytes) {
  const auto image = decode_image(bytes);
  return image ? "" : image.error();
}

TEST(HdrPictures, Flat) {
  const auto image =
      decode_image(hdr_of("-Y 2 +X 1", std::string("\x80\x40\xff\x81\x05\x06\x07\x00", 8)));
  ASSERT_TRUE(image) << image.error();
  EXPECT_EQ(image->pixels, (Column<Rgb>{{1, 0.5f, 255 / 128.f}, Rgb(0)}));
  // Exposures multiply, and the pixels were multiplied by them.
  const auto exposed =
      decode_image(hdr_of("-Y 1 +X 1", "\x80\x40\xff\x81", "EXPOSURE=4\nEXPOSURE = 0.5\n"));
  ASSERT_TRUE(exposed) << exposed.error();
  EXPECT_EQ(exposed->pixels, (Column<Rgb>{{0.5f, 0.25f, 255 / 256.f}}));
}

// A row of 8 pixels: a run, a list, both, and a run.
const std::string kRuns(
    "\x02\x02\x00\x08\x88\x80\x08\x01\x02\x03\x04\x05\x06\x07\x08\x83\x10\x05"
    "\x09\x08\x07\x06\x05\x88\x81",
    25);

TEST(HdrPictures, Runs) {
  const auto image = decode_image(hdr_of("-Y 2 +X 8", kRuns + kRuns));
  ASSERT_TRUE(image) << image.error();
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x)
      EXPECT_EQ(image->at(x, y), Rgb(128, float(1 + x), float(x < 3 ? 16 : 12 - x)) / 128) << x;
}

TEST(HdrPictures, DamageIsNamed) {
  const std::string whole = hdr_of("-Y 2 +X 8", kRuns + kRuns);
  for (size_t size = 2; size < whole.size(); ++size)
    ASSERT_THAT(why_no_hdr(whole.substr(0, size)), HasSubstr("broken HDR")) << size;
  const std::string pixel = "\x80\x40\xff\x81";
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 2 +X 1", pixel)), HasSubstr("too short for 1 x 2"));
  EXPECT_THAT(why_no_hdr(hdr_of("+Y 1 +X 1", pixel)),
              HasSubstr("expected the size as -Y HEIGHT +X WIDTH, found \"+Y 1 +X 1\""));
  EXPECT_THAT(why_no_hdr(hdr_of("+X 1 -Y 1", pixel)), HasSubstr("found \"+X 1 -Y 1\""));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 1 ", pixel.substr(1))), HasSubstr("too short"));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 16384 +X 16384", pixel)), HasSubstr("too short for 16384"));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 99999 +X 99999", pixel)), HasSubstr("more than 268435456"));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 0 +X 9", pixel)), HasSubstr("9 x 0"));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 8", kRuns, "EXPOSURE=0\n")),
              HasSubstr("expected a positive EXPOSURE, found \"EXPOSURE=0\""));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 8", kRuns, "COLORCORR=1 2 3\n")), HasSubstr("COLORCORR"));
  EXPECT_THAT(why_no_hdr("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd"),
              HasSubstr("expected FORMAT=32-bit_rle_rgbe, found \"FORMAT=32-bit_rle_xyze\""));
  EXPECT_THAT(why_no_hdr("#?RADIANCE\n\n-Y 1 +X 1\nabcd"), HasSubstr("expected a line FORMAT="));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 9", kRuns)), HasSubstr("a row of 8 pixels in a picture"));
  std::string runs = kRuns;
  runs[4] = '\x89';
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 8", runs)), HasSubstr("row 0: 9 pixels at column 0"));
  runs[4] = 0;
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 8", runs)), HasSubstr("0 pixels at column 0"));
  EXPECT_THAT(why_no_hdr(hdr_of("-Y 1 +X 2", pixel + "\x01\x01\x01\x01")),
              HasSubstr("run-length coding of whole pixels"));
}

// A grey floor without lights, seen from above; +Z is up.
constexpr std::string_view kUnlitFloor =
    "v\nfrom 0.3 -0.4 0.5\nat 0 0 0\nup 0 0.1 1\nangle 0.001\nhither 0.001\nresolution 8 8\n"
    "b 0 0 0\nf 0.5 0.5 0.5 1 0 1 0 1\np 4\n-9 -9 0\n9 -9 0\n9 9 0\n-9 9 0\n";

constexpr int kAcross = 16, kDown = 8;

class EnvironmentFile : public TemporaryFolder {
 protected:
  EnvironmentFile() { put(file("floor.nff"), kUnlitFloor); }

  std::string picture(std::string_view name, const Image& image) {
    const auto done = write_image(image, file(name));
    EXPECT_TRUE(done) << done.error().text();
    return file(name).string();
  }
  std::string gradient(std::string_view name, int shift = 0) {
    Image image(kAcross, kDown);
    for (int y = 0; y < kDown; ++y)
      for (int x = 0; x < kAcross; ++x) {
        const int from = (x + shift) % kAcross;
        image.at(x, y) = Rgb(float(from), float(y), float(from % 3 * y));
      }
    return picture(name, image);
  }
  Scene lit_by(const std::string& path, float rotation = 0) {
    auto read =
        read_scene(file("floor.nff"), {.environment = path, .environment_rotation = rotation});
    if (read) return std::move(read->scene);
    ADD_FAILURE() << read.error().front().text();
    return {};
  }
  std::string refusal(const ReadOptions& options) {
    const auto read = read_scene(file("floor.nff"), options);
    if (read) return "";
    EXPECT_EQ(read.error().size(), 1u);
    return read.error().front().text();
  }
};

RenderOptions some_paths(int samples) {
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 8;
  options.samples = samples, options.depth = 2;
  return options;
}

// The texel's tent, times the cosine: with s = pi / height and the altitude a of its centre,
// R 2 pi / width s sin(2 a) / 2 (sin s / s)^2.
TEST_F(EnvironmentFile, OneBrightTexelLightsAFloor) {
  Image image(kAcross, kDown);
  image.at(11, 2) = Rgb(40);
  const Image seen = picture_of(lit_by(picture("sun.pfm", image)), some_paths(256));
  const double s = pi / kDown, altitude = pi / 2 - 2.5 * s;
  const double irradiance =
      40 * 2 * pi / kAcross * s * std::sin(2 * altitude) / 2 * std::pow(std::sin(s) / s, 2);
  double mean = 0;
  for (const Rgb& c : seen.pixels) mean += double(c.y) / double(seen.pixels.size());
  EXPECT_NEAR(mean, 0.5 / pi * irradiance, 0.005 * 0.5 / pi * irradiance);
  // Below the horizon it lights nothing.
  Image under(kAcross, kDown);
  under.at(11, 5) = Rgb(40);
  EXPECT_EQ(picture_of(lit_by(picture("under.pfm", under)), some_paths(4)).at(3, 3), Rgb(0));
}

TEST_F(EnvironmentFile, IsSeenAsItIsAndTurned) {
  RenderOptions around;
  around.width = kAcross, around.height = kDown, around.aa = 1;
  around.projection = Projection::omnidirectional, around.integrator = IntegratorKind::ambient;
  const auto seen = [&](Scene scene) {
    scene.polygons = {}, scene.polygon_materials = {};
    scene.camera.from = {}, scene.camera.at = {0, 1, 0}, scene.camera.up = {0, 0, 1};
    return picture_of(scene, around);
  };
  const auto expect_near = [](const Image& a, const Image& b) {
    for (size_t i = 0; i < a.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.pixels[i][c], b.pixels[i][c], 1e-4f) << i;
  };
  const std::string path = gradient("a.pfm");
  expect_near(seen(lit_by(path)), read_image(path).value());
  // Counterclockwise from above: what was a quarter to the right is in the middle.
  expect_near(seen(lit_by(path, 90)), read_image(gradient("b.pfm", kAcross / 4)).value());
  expect_near(seen(lit_by(path, -90)), read_image(gradient("b.pfm", 3 * kAcross / 4)).value());
}

TEST_F(EnvironmentFile, UpIsThatOfTheFile) {
  const std::string path = gradient("a.pfm");
  const auto axes = [&](std::string_view up) {
    std::string text(kUnlitFloor);
    text.replace(text.find("up 0 0.1 1"), 10, "up " + std::string(up));
    const auto read = parse_scene(text, "a.nff", {.environment = path});
    EXPECT_TRUE(read) << read.error().front().text();
    const Environment e = read->scene.environment[0];
    return std::pair(e.up, e.direction);
  };
  EXPECT_EQ(axes("0 0.1 1"), std::pair(Vec3f(0, 0, 1), Vec3f(0, 1, 0)));
  EXPECT_EQ(axes("0 1 0.9"), std::pair(Vec3f(0, 1, 0), Vec3f(0, 0, -1)));
  EXPECT_EQ(axes("0 -1 0.1"), std::pair(Vec3f(0, -1, 0), Vec3f(0, 0, -1)));
  EXPECT_EQ(axes("2 1 1"), std::pair(Vec3f(1, 0, 0), Vec3f(0, 0, -1)));
  // glTF has +Y up, wherever the camera looks.
  const auto crates = read_scene(RAIO_SOURCE_DIR "/scenes/crates.gltf", {.environment = path});
  ASSERT_TRUE(crates);
  EXPECT_EQ(crates->scene.environment[0].up, Vec3f(0, 1, 0));
  EXPECT_EQ(crates->scene.environment[0].direction, Vec3f(0, 0, -1));
}

TEST_F(EnvironmentFile, DisplayValuesAreDecoded) {
  Image image(4, 2);
  image.at(1, 0) = Rgb(100, 7, 255) / 255;
  const Scene scene = lit_by(picture("a.png", image));
  EXPECT_EQ(scene.environment_texels[1], linear_from_srgb(Rgb(100, 7, 255) / 255));
  EXPECT_EQ(scene.environment_texels[0], Rgb(0));
}

TEST_F(EnvironmentFile, RefusalsNameWhatWasFound) {
  EXPECT_THAT(refusal({.environment = file("none.hdr").string()}),
              HasSubstr("none.hdr: error: the environment: No such file"));
  EXPECT_THAT(refusal({.environment = picture("wide.pfm", Image(18, 8))}),
              HasSubstr("wide.pfm: error: the environment: it has 18 x 8 pixels; expected a "
                        "picture of all directions, twice as wide as high"));
  EXPECT_EQ(refusal({.environment = picture("odd.pfm", Image(17, 8))}), "");
  EXPECT_THAT(refusal({.environment = picture("large.png", Image(16386, 1))}),
              HasSubstr("16386 x 1 pixels; expected at most 16384 x 8192"));
  for (const float wrong : {-1.0f, INFINITY, NAN}) {
    Image image(4, 2);
    image.at(2, 1).y = wrong;
    EXPECT_THAT(refusal({.environment = picture("a.pfm", image)}),
                HasSubstr("the pixel in column 2, row 1 (from 0, 0 at the upper left) is 0,"));
  }
  EXPECT_THAT(refusal({.environment_rotation = 10}),
              HasSubstr("env-rotate has no effect without environment or sky"));
  put(file("a.hdr"), "GIF89a");
  EXPECT_THAT(refusal({.environment = file("a.hdr").string()}), HasSubstr("expected a PNG, JPEG"));
}

TEST_F(EnvironmentFile, BackgroundsThatLightTheSceneAreRead) {
  const auto read_by = [](std::string_view background, ReadOptions read) {
    RenderOptions options;
    EXPECT_TRUE(set_option(options, option_of("background"), background));
    const auto why = read_background(options, read);
    EXPECT_EQ(options.background.has_value(), why.has_value());
    return std::pair(read, why ? why->message : "");
  };
  EXPECT_EQ(read_by("sky", {}).first.sky, (std::array{3.F, 45.F, 0.F}));
  EXPECT_EQ(read_by("sky", {.sky = {{2, 9, 5}}}).first.sky, (std::array{2.F, 9.F, 5.F}));
  EXPECT_EQ(read_by("a.HDR", {}).first.environment, "a.HDR");
  EXPECT_EQ(read_by("a.exr", {.environment = "a.exr"}).first.environment, "a.exr");
  EXPECT_THAT(read_by("sky", {.environment = "a.hdr"}).second,
              HasSubstr("sky cannot be combined with `environment`"));
  EXPECT_THAT(read_by("a.exr", {.environment = "b.exr"}).second,
              HasSubstr("a.exr cannot be combined with `environment`"));
  EXPECT_THAT(read_by("a.exr", {.sky = {{2, 9, 5}}}).second,
              HasSubstr("a.exr cannot be combined with `sky`"));
}

TEST_F(EnvironmentFile, PathsAreTheDefault) {
  const Scene lit = lit_by(gradient("a.pfm"));
  RenderOptions options;
  EXPECT_EQ(integrator_of(options, lit), IntegratorKind::path);
  options.integrator = IntegratorKind::ambient;
  EXPECT_EQ(integrator_of(options, lit), IntegratorKind::ambient);
}

TEST_F(EnvironmentFile, ReplacesTheScenes) {
  const Scene scene = lit_by(gradient("a.pfm"));
  ASSERT_TRUE(write_scene(scene, file("lit.raio")));
  const auto own = read_scene(file("lit.raio"));
  EXPECT_EQ(content_hash(own->scene), content_hash(scene));
  const auto other = read_scene(file("lit.raio"), {.environment = gradient("b.pfm", 3)});
  ASSERT_TRUE(other);
  ASSERT_EQ(other->notices.size(), 1u);
  EXPECT_THAT(other->notices[0].text(),
              HasSubstr("left out: its own environment; environment replaces"));
  EXPECT_EQ(content_hash(other->scene), content_hash(lit_by(file("b.pfm").string())));
  EXPECT_NE(content_hash(other->scene), content_hash(scene));
  EXPECT_NE(content_hash(lit_by(file("a.pfm").string(), 1)), content_hash(scene));
}

std::expected<void, Error> job_done(const JobRequest& r) {
  RenderJob job(r);
  if (auto ready = job.prepare(); !ready) return ready;
  if (auto run = job.run(); !run) return run;
  return job.write();
}

TEST_F(EnvironmentFile, PicturesAreContinuedAndRepeated) {
  JobRequest request;
  request.scene = file("floor.nff").string(), request.options = some_paths(4);
  request.read.environment = gradient("a.pfm"), request.read.environment_rotation = 30;
  request.output = file("whole.png").string();
  ASSERT_TRUE(job_done(request));
  JobRequest part = request;
  part.output = file("late.png").string();
  part.options.samples = 2, part.checkpoint = file("c.raio").string();
  ASSERT_TRUE(job_done(part));
  part.options.samples = 4, part.resume = true;
  JobRequest other = part;
  other.read.environment_rotation = 31;
  ASSERT_FALSE(job_done(other));
  EXPECT_THAT(job_done(other).error().text(), HasSubstr("the scene differs"));
  const auto resumed = job_done(part);
  ASSERT_TRUE(resumed) << resumed.error().text();
  EXPECT_TRUE(
      same_bytes(read_image(file("late.png")).value(), read_image(file("whole.png")).value()));
  JobRequest again;
  again.repeat = file("whole.png").string(), again.output = file("again.png").string();
  const auto repeated = job_done(again);
  ASSERT_TRUE(repeated) << repeated.error().text();
  EXPECT_EQ(get(file("again.png")), get(file("whole.png")));
}

}  // namespace
}  // namespace raio::core
