// The style of pictures: the options `background`, `exposure` and `tone`.
#include <gmock/gmock.h>

#include "io/image/image.h"
#include "one_picture.h"
#include "render/job.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::random_scene;
using tests::same_bytes;

void set(RenderOptions& options, std::string_view name, std::string_view text) {
  const auto spec = std::ranges::find(render_option_table(), name, &OptionSpec::name);
  const auto done = set_option(options, *spec, text);
  EXPECT_TRUE(done) << done.error().text();
  // The option's text is as given.
  RenderOptions again;
  const std::string given = spec->text(options);
  EXPECT_TRUE(given.empty() || set_option(again, *spec, given));
  EXPECT_EQ(spec->text(again), given);
}

/// Pixels without anything, and with mirrors that see the ground.
Scene scene_of_two_balls() {
  Scene s;
  s.name = "balls";
  s.camera.from = {0, -5, 0}, s.camera.at = {}, s.camera.up = {0, 0, 1};
  s.background = {0.25f, 0.5f, 1};
  s.lights = {{{3, -4, 5}, std::nullopt}};
  s.materials = {{{1, 0.5f, 0.25f}, 0.5f, 0.5f, 10, 0, 1}};
  s.spheres = {{{0, 0, 0}, 1}, {{1.5f, 0, 0.5f}, 0.5f}};
  s.sphere_materials = {0, 0};
  return s;
}

class Look : public TemporaryFolder {
 protected:
  Look() { options_.width = 60, options_.height = 40, options_.aa = 2; }

  JobRequest request(std::string_view output) const {
    JobRequest r;
    r.loaded = std::make_shared<const Scene>(scene_);
    r.options = options_;
    r.output = file(output);
    return r;
  }
  static std::expected<void, Error> done(const JobRequest& r) {
    RenderJob job(r);
    if (auto ready = job.prepare(); !ready) return ready;
    if (auto run = job.run(); !run) return run;
    return job.write();
  }
  std::string bytes(std::string_view output) const {
    const auto all = done(request(output));
    EXPECT_TRUE(all) << all.error().text();
    return get(file(output));
  }
  // Again, from the picture.
  std::string repeated(std::string_view from, std::string_view output) const {
    JobRequest r = request(output);
    r.options = {}, r.repeat = file(from);
    const auto all = done(r);
    EXPECT_TRUE(all) << all.error().text();
    return get(file(output));
  }

  static Scene scene_of_black_ground() {
    Scene black = scene_of_two_balls();
    black.background = {};
    return black;
  }
  RenderOptions with_alpha() const {
    RenderOptions o = options_;
    o.background.reset();
    o.channels.add(Channel::alpha);
    return o;
  }

  Scene scene_ = scene_of_two_balls();
  RenderOptions options_;
};

TEST_F(Look, BackgroundReplacesTheScenes) {
  Scene other = random_scene(30, 2);
  other.background = Rgb(0.5f, 4, 0);
  options_.soft_shadows = true;
  const Image wanted = tests::expect_one_picture(other, options_);
  other.background = Rgb(0.1f);
  set(options_, "background", "0.5,4,0");
  EXPECT_TRUE(same_bytes(tests::expect_one_picture(other, options_), wanted));
}

TEST_F(Look, BackgroundIsTheBytesThatAreWritten) {
  for (const auto& [text, bytes] :
       {std::pair("#8081fe", std::array{0x80, 0x81, 0xfe}), {"orange", {0xff, 0xa5, 0}}}) {
    set(options_, "background", text);
    const std::string once = this->bytes("a.png");
    const Rgb corner = read_image(file("a.png"))->at(0, 0);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(to_byte(corner[c]), bytes[size_t(c)]);
    EXPECT_TRUE(repeated("a.png", "b.png") == once);
  }
}

TEST_F(Look, TheScenesBackgroundIsTheDefault) {
  const std::string own = bytes("a.png");
  set(options_, "background", "0.25,0.5,1");
  EXPECT_TRUE(bytes("b.png") == own);
  set(options_, "background", "0.25,0.5,0.75");
  EXPECT_THAT(bytes("c.png"), HasSubstr(std::string("raio.background\0", 16) + "0.25,0.5,0.75"));
}

TEST_F(Look, TransparentIsBlackWithAlpha) {
  const Image wanted = tests::picture_of(scene_of_black_ground(), with_alpha());

  set(options_, "background", "transparent");
  for (const char* name : {"a.png", "a.exr"}) {
    const std::string once = bytes(name);
    const Picture picture = *read_picture(file(name));
    ASSERT_EQ(picture.alpha.size(), 60u * 40);
    EXPECT_EQ(picture.alpha.front(), 0);
    EXPECT_EQ(picture.alpha[20 * 60 + 30], 1);
    EXPECT_TRUE(repeated(name, std::string("again-") + name) == once);
  }
  EXPECT_TRUE(same_bytes(read_picture(file("a.exr"))->color, wanted));
  for (const char* name : {"a.ppm", "a.pfm"}) {
    const auto refused = done(request(name));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("not alpha"));
  }
}

TEST_F(Look, ViewsTakeNoBackgroundButTransparent) {
  options_.view = View::normals;
  set(options_, "background", "white");
  EXPECT_THAT(option_conflict(options_)->text("--"), HasSubstr("no effect with --view normals"));
  set(options_, "background", "transparent");
  const std::string once = bytes("a.png");
  EXPECT_EQ(read_picture(file("a.png"))->alpha.front(), 0);
  EXPECT_TRUE(repeated("a.png", "b.png") == once);
  options_.view = View::picture, options_.integrator = IntegratorKind::views;
  set(options_, "background", "white");
  EXPECT_THAT(option_conflict(options_)->message, HasSubstr("`integrator` views"));
}

TEST_F(Look, InvalidBackgroundsAreRefused) {
  const auto spec = std::ranges::find(render_option_table(), "background", &OptionSpec::name);
  for (const char* text : {"evening.png", "faces/", "", "-1,0,0"}) {
    const auto refused = set_option(options_, *spec, text);
    ASSERT_FALSE(refused) << text;
    EXPECT_THAT(refused.error().message, HasSubstr("a name as in white, #rrggbb, three numbers"));
  }
  set(options_, "background", "transparent");
  EXPECT_THAT(window_conflict(options_)->message, HasSubstr("transparency"));
  set(options_, "background", "white");
  EXPECT_FALSE(window_conflict(options_));
}

TEST_F(Look, ToneAndExposureMakeTheBytesOfDisplays) {
  const Image light = tests::picture_of(scene_, options_);
  const std::string plain = bytes("plain.png"), pfm = bytes("plain.pfm");
  bytes("plain.exr");
  const Image exr = *read_image(file("plain.exr"));
  for (const auto& [tone, name] : {std::pair(Tone::none, "none"),
                                   {Tone::srgb, "srgb"},
                                   {Tone::agx, "agx"},
                                   {Tone::neutral, "neutral"}})
    for (const char* exposure : {"0", "-1.5", "2"}) {
      options_ = {};
      options_.width = 60, options_.height = 40, options_.aa = 2;
      set(options_, "tone", name), set(options_, "exposure", exposure);
      const ToneMap map(tone, options_.exposure.ev);
      const std::string once = bytes("a.png");
      bytes("a.ppm");
      const Image png = *read_image(file("a.png")), ppm = *read_image(file("a.ppm"));
      for (size_t i = 0; i < light.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(to_byte(png.pixels[i][c]), to_byte(map(light.pixels[i])[c])) << name;
          ASSERT_EQ(png.pixels[i][c], ppm.pixels[i][c]);
        }
      EXPECT_TRUE(repeated("a.png", "b.png") == once);
      EXPECT_EQ(once == plain, tone == Tone::none && options_.exposure == Exposure());
      // Numbers are unchanged, with their display settings.
      EXPECT_TRUE(bytes("a.pfm") == pfm);
      bytes("a.exr");
      EXPECT_TRUE(same_bytes(*read_image(file("a.exr")), exr));
      EXPECT_TRUE(repeated("a.exr", "c.png") == once);
    }
}

// EXR keeps light, for which the exposure is found again.
TEST_F(Look, AutomaticExposureIsThatOfTheNumber) {
  options_ = {};
  options_.width = 60, options_.height = 40, options_.aa = 2;
  set(options_, "tone", "srgb"), set(options_, "exposure", "auto");
  const std::string automatic = bytes("a.png");
  const auto settings = *read_metadata(file("a.png"));
  EXPECT_EQ(setting(settings, "exposure"), "auto");
  bytes("a.exr");
  EXPECT_TRUE(repeated("a.exr", "c.png") == automatic);
  set(options_, "exposure", setting(settings, "exposure_ev"));
  bytes("b.png");
  EXPECT_TRUE(same_bytes(*read_image(file("a.png")), *read_image(file("b.png"))));
  EXPECT_FALSE(set_option(options_, option_of("exposure"), "bright"));
}

TEST_F(Look, PartsKeepTheirTone) {
  set(options_, "tone", "agx"), set(options_, "exposure", "1");
  const std::string once = bytes("a.png");
  bytes("a.raio");
  const Part part = *read_part(file("a.raio"));
  ASSERT_TRUE(write_result(file("b.png"), part));
  EXPECT_TRUE(get(file("b.png")) == once);
  JobRequest plain = request("c.png");
  plain.options.tone = {}, plain.checkpoint = file("a.raio"), plain.resume = true;
  const auto refused = done(plain);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("`tone` agx, not without it"));
}

TEST_F(Look, ToneAppliesToTheCoveredPart) {
  set(options_, "background", "transparent");
  const Image light = tests::picture_of(scene_of_black_ground(), with_alpha());
  set(options_, "tone", "srgb"), set(options_, "exposure", "1");
  bytes("a.png");
  // Read, colours are multiplied by alpha.
  const Picture shown = *read_picture(file("a.png"));
  bytes("a.exr");
  const Picture numbers = *read_picture(file("a.exr"));
  EXPECT_TRUE(same_bytes(numbers.color, light));
  const ToneMap map(Tone::srgb, 1);
  int partly = 0;
  for (size_t i = 0; i < light.pixels.size(); ++i) {
    const float alpha = numbers.alpha[i];
    if (alpha == 0) {
      ASSERT_EQ(shown.color.pixels[i], Rgb());
      continue;
    }
    partly += alpha < 1;
    const Rgb straight = map(light.pixels[i] / alpha);
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(shown.color.pixels[i][c] / shown.alpha[i], straight[c], 0.503 / 255);
  }
  EXPECT_GT(partly, 20);
}

TEST_F(Look, BackgroundComesOutOfTheCurveAsItWasWritten) {
  set(options_, "tone", "srgb"), set(options_, "background", "#8081fe");
  const std::string once = bytes("a.png");
  const Rgb corner = read_image(file("a.png"))->at(0, 0);
  EXPECT_EQ(to_byte(corner.x), 0x80);
  EXPECT_EQ(to_byte(corner.y), 0x81);
  EXPECT_EQ(to_byte(corner.z), 0xfe);
  EXPECT_TRUE(repeated("a.png", "b.png") == once);
  // Numbers are light.
  set(options_, "background", "0.5,0.5,0.5");
  bytes("a.png");
  EXPECT_EQ(to_byte(read_image(file("a.png"))->at(0, 0).x), to_byte(srgb_from_linear(0.5f)));
}

TEST_F(Look, ViewsTakeNoTone) {
  options_.view = View::depth;
  set(options_, "tone", "agx");
  EXPECT_THAT(option_conflict(options_)->text("--"),
              HasSubstr("--tone: has no effect with --view depth; leave one of them out"));
  options_.tone = {};
  set(options_, "exposure", "-1");
  EXPECT_THAT(option_conflict(options_)->subject, HasSubstr("exposure"));
}

}  // namespace
}  // namespace raio::core
