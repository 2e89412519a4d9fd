// Skies: valid files, the texel of a direction, and their use in pictures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "integrate/explain.h"
#include "io/scene_file.h"
#include "jpeg_bytes.h"
#include "one_picture.h"
#include "render/job.h"
#include "render/part.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "scenes.h"
#include "sky_files.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::distinct_texel;
using tests::expect_one_picture;
using tests::jpeg_of;
using tests::picture_of;
using tests::put_sky;
using tests::random_scene;
using tests::same_bytes;
using tests::sky_of;

// As in P3F: with ma the magnitude of the largest component, s = (sc / ma + 1) / 2 from the left
// and t = (tc / ma + 1) / 2 from the bottom, (sc, tc) by face; and back to a direction. Right is
// towards -x, so the pictures of a sky join at their edges.
Vec3f towards(CubeFace face, float s, float t) {
  const float sc = 2 * s - 1, tc = 2 * t - 1;
  switch (face) {
    case CubeFace::right:  // (-z, y)
      return {-1, tc, -sc};
    case CubeFace::left:  // (z, y)
      return {1, tc, sc};
    case CubeFace::top:  // (-x, -z)
      return {-sc, 1, -tc};
    case CubeFace::bottom:  // (-x, z)
      return {-sc, -1, tc};
    case CubeFace::front:  // (-x, y)
      return {-sc, tc, 1};
    case CubeFace::back:  // (x, y)
      break;
  }
  return {sc, tc, -1};
}

// A picture of one pixel, with its ray in that direction.
Scene looking(Vec3f direction, std::shared_ptr<const CubeMap> sky) {
  Scene s;
  s.camera.from = {0, 0, 0}, s.camera.at = direction;
  s.camera.up = std::abs(direction.y) > 0.9f * length(direction) ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
  s.camera.width = s.camera.height = 1;
  s.materials = {Material()};
  s.requests.sky_folder = "sky", s.sky = std::move(sky);
  return s;
}
Rgb seen(Vec3f direction, const std::shared_ptr<const CubeMap>& sky) {
  return picture_of(looking(direction, sky), {}).at(0, 0);
}

void expect_near(Rgb a, Rgb b, float by = 2e-6f) {
  EXPECT_NEAR(a.x, b.x, by);
  EXPECT_NEAR(a.y, b.y, by);
  EXPECT_NEAR(a.z, b.z, by);
}

class Sky : public TemporaryFolder {
 protected:
  std::shared_ptr<const CubeMap> sky(int side, const tests::TexelColor& color = distinct_texel) {
    put_sky(file("sky"), side, color);
    return sky_of(file("sky"));
  }
  std::string error() const {
    const auto read = read_cube_map(file("sky"));
    if (read) return "none";
    std::string text = read.error().text();
    for (size_t at; (at = text.find(folder().string() + "/")) != std::string::npos;)
      text.erase(at, folder().string().size() + 1);
    return text;
  }
};

TEST_F(Sky, TexelsAreWhereP3fHasThem) {
  constexpr int kSide = 4;
  const auto map = sky(kSide);
  for (size_t f = 0; f < kCubeFaces; ++f)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const auto face = CubeFace(f);
        const float s = (float(x) + 0.5f) / kSide, t = 1 - (float(y) + 0.5f) / kSide;
        SCOPED_TRACE(testing::Message() << kCubeFaceNames[f] << " " << x << "," << y);
        expect_near(seen(towards(face, s, t), map), distinct_texel(face, x, y));
        // Not of unit length: the same.
        expect_near(seen(towards(face, s, t) * 100, map), distinct_texel(face, x, y));
      }
}

TEST_F(Sky, IsBilinearBetweenTexels) {
  constexpr int kSide = 4;
  const auto map = sky(kSide);
  const auto face = CubeFace::left;
  for (const auto& [x, y, right, down] :
       {std::tuple(0, 0, 0.5f, 0.f), {1, 2, 0.f, 0.5f}, {2, 1, 0.25f, 0.75f}, {0, 2, 0.9f, 0.1f}}) {
    const auto at = [&](int i, int j) { return distinct_texel(face, x + i, y + j); };
    const Rgb expected = (at(0, 0) * (1 - right) + at(1, 0) * right) * (1 - down) +
                         (at(0, 1) * (1 - right) + at(1, 1) * right) * down;
    const float s = (float(x) + 0.5f + right) / kSide, t = 1 - (float(y) + 0.5f + down) / kSide;
    expect_near(seen(towards(face, s, t), map), expected);
  }
}

TEST_F(Sky, ContinuesAcrossEdgesAndCorners) {
  constexpr int kSide = 4;
  const auto map = sky(kSide);
  // On the edge of left (+x) and top (+y), at the centre of a texel of each: half of both. On left
  // s is (z + 1) / 2; on top it is 0, and t is (1 - z) / 2 from the bottom.
  const float z = 0.25f;
  const Rgb by_left = distinct_texel(CubeFace::left, 2, 0);
  const Rgb by_top = distinct_texel(CubeFace::top, 0, 2);
  expect_near(seen({1, 1, z}, map), (by_left + by_top) * 0.5f, 5e-6f);
  // In the corner +x +y +z: a third of each, except for the rounding of texels.
  const Rgb corner = (distinct_texel(CubeFace::left, 3, 0) + distinct_texel(CubeFace::top, 0, 3) +
                      distinct_texel(CubeFace::front, 0, 0)) *
                     (1 / 3.f);
  expect_near(seen({1, 1, 1}, map), corner, 0.5f / 255);
  // Nowhere a step: a little to both sides of every edge.
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int k = 0; k < 200; ++k) {
    Vec3f d{unit(rng), unit(rng), unit(rng)};
    const int a = int(rng() % 3), b = (a + 1 + int(rng() % 2)) % 3;
    d[a] = rng() % 2 ? 1.f : -1.f, d[b] = rng() % 2 ? 1.f : -1.f;
    Vec3f other = d;
    d[a] *= 1.00001f, other[b] *= 1.00001f;
    expect_near(seen(d, map), seen(other, map), 1e-3f);
  }
  // One texel per face.
  const auto tiny = sky(1);
  expect_near(seen({0, 0, -1}, tiny), distinct_texel(CubeFace::back, 0, 0));
}

TEST_F(Sky, IsVisibleInMirrorsAndThroughGlass) {
  const auto map = sky(8);
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int k = 0; k < 20; ++k) {
    const Vec3f in = normalize(Vec3f(unit(rng), -1, unit(rng)));
    const auto on_plane = [&](const Material& material, int depth) {
      Scene s = looking(in, map);
      s.planes = {Plane{{0, -3, 0}, {0, 1, 0}}}, s.plane_materials = {0}, s.materials = {material};
      RenderOptions o;
      o.depth = depth;
      return picture_of(s, o).at(0, 0);
    };
    // Beyond the last level and within.
    for (const int depth : {1, 5}) {
      const Vec3f mirrored{in.x, -in.y, in.z};
      expect_near(on_plane({{0, 0, 0}, 0, 0.5f, 1, 0, 1}, depth), seen(mirrored, map) * 0.5f,
                  1e-5f);
      const Vec3f through = normalize(Vec3f(in.x / 1.5f, 0, in.z / 1.5f) -
                                      Vec3f(0, std::sqrt(1 - (1 - in.y * in.y) / 2.25f), 0));
      expect_near(on_plane({{0, 0, 0}, 0, 0, 1, 0.75f, 1.5f}, depth), seen(through, map) * 0.75f,
                  1e-5f);
    }
  }
}

RenderOptions all_effects() {
  RenderOptions o;
  o.width = 90, o.height = 60, o.aa = 2, o.soft_shadows = true, o.dof = true;
  return o;
}
Scene scene_under(std::shared_ptr<const CubeMap> sky) {
  Scene s = random_scene(60, 4);
  s.requests.sky_folder = "sky", s.sky = std::move(sky);
  return s;
}

TEST_F(Sky, IsTheSameForStructuresThreadsAndInstructionSets) {
  const Scene scene = scene_under(sky(8));
  const Image image = expect_one_picture(scene, all_effects());
  // And different from the one without it, only where rays hit nothing.
  Scene plain = scene;
  plain.sky = nullptr, plain.requests.sky_folder.clear();
  EXPECT_FALSE(same_bytes(picture_of(plain, all_effects()), image));
}

TEST_F(Sky, OfOneColourEqualsThatBackground) {
  const Rgb color = Rgb(51, 102, 153) / 255;
  Scene scene = scene_under(sky(3, [&](CubeFace, int, int) { return color; }));
  const Image under_sky = picture_of(scene, all_effects());
  scene.sky = nullptr, scene.requests.sky_folder.clear();
  scene.background = color;
  EXPECT_TRUE(same_bytes(picture_of(scene, all_effects()), under_sky));
}

TEST_F(Sky, IsAbsentFromViewsAndAlpha) {
  Scene scene = scene_under(sky(4));
  RenderOptions o = all_effects();
  o.view = View::normals;
  const Image normals = picture_of(scene, o);
  const auto nothing = looking({0, 0, 1}, sky(4));
  RenderOptions alpha;
  alpha.channels.add(Channel::alpha);
  EXPECT_EQ(picture_of(nothing, alpha).at(0, 0), Rgb());
  EXPECT_NE(picture_of(nothing, {}).at(0, 0), Rgb());
  scene.sky = nullptr, scene.requests.sky_folder.clear();
  EXPECT_TRUE(same_bytes(picture_of(scene, o), normals));
}

TEST_F(Sky, ExplainedTermsAddUpToThePixel) {
  const Scene scene = scene_under(sky(8));
  RenderOptions o;
  o.width = 60, o.height = 40, o.accel.kind = AccelKind::bvh;
  const Image image = picture_of(scene, o);
  const RenderSettings settings = resolve_options(o, scene);
  const auto accel = build_accel(scene, settings.accel);
  size_t seen_sky = 0;
  for (int y = 0; y < 40; y += 3)
    for (int x = 0; x < 60; x += 3) {
      const auto sample = explain_sample(scene, **accel, settings, x, y, 0);
      ASSERT_TRUE(sample);
      EXPECT_EQ(Rgb(sample->rgb), image.at(x, y)) << x << "," << y;
      for (const ExplainedRay& r : sample->rays)
        if (r.kind != ExplainedRay::Kind::shadow && !r.surface) {
          ++seen_sky;
          expect_near(r.background, seen(r.ray.dir, scene.sky), 1e-4f);
        }
    }
  EXPECT_GT(seen_sky, 50u);
}

class SkyJob : public Sky {
 protected:
  SkyJob() {
    put_sky(file("sky"), 4);
    put_sky(file("other"), 4, [](CubeFace f, int x, int y) { return distinct_texel(f, y, x); });
    put_sky(file("copy"), 4);
  }
  JobRequest request(std::string_view output, std::string_view background = "sky") const {
    JobRequest r;
    r.loaded = std::make_shared<const Scene>(random_scene(30, 3));
    r.options.width = 70, r.options.height = 50, r.options.samples = 4;
    set(r.options, file(background).string());
    r.output = file(output);
    return r;
  }
  static void set(RenderOptions& o, std::string_view text) {
    const auto spec = std::ranges::find(render_option_table(), "background", &OptionSpec::name);
    const auto done = set_option(o, *spec, text);
    ASSERT_TRUE(done) << done.error().text();
    EXPECT_EQ(spec->text(o), text);
  }
  static std::expected<void, Error> done(const JobRequest& r) {
    RenderJob job(r);
    if (auto ready = job.prepare(); !ready) return ready;
    if (auto run = job.run(); !run) return run;
    return job.write();
  }
  Image picture(std::string_view name) const { return read_image(file(name)).value(); }
};

TEST_F(SkyJob, IsNamedAndHashedInThePicture) {
  ASSERT_TRUE(done(request("a.png")));
  const auto settings = read_metadata(file("a.png"));
  ASSERT_TRUE(settings);
  EXPECT_EQ(setting(*settings, "background"), file("sky").string());
  EXPECT_EQ(setting(*settings, "sky"), file("sky").string());
  EXPECT_EQ(setting(*settings, "sky_hash"), hex(sky_of(file("sky"))->hash));
  // Repeated; but not with another sky in its place.
  JobRequest again = request("b.png");
  again.options = {}, again.repeat = file("a.png");
  const auto repeated = done(again);
  ASSERT_TRUE(repeated) << repeated.error().text();
  EXPECT_EQ(get(file("a.png")), get(file("b.png")));
  std::filesystem::remove_all(file("sky"));
  std::filesystem::copy(file("other"), file("sky"));
  const auto refused = done(again);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text(), file("a.png").string() + ": the sky differs");
}

TEST_F(SkyJob, ResumesOnlyWithTheSameSky) {
  ASSERT_TRUE(done(request("whole.png")));
  JobRequest r = request("late.png");
  r.options.samples = 2, r.checkpoint = file("c.raio");
  ASSERT_TRUE(done(r));
  r.options.samples = 4, r.resume = true;
  JobRequest under_other = r;
  set(under_other.options, file("other").string());
  const auto refused = done(under_other);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text(), HasSubstr("the sky differs"));
  under_other.options.background->sky = nullptr;
  EXPECT_FALSE(done(under_other)) << "under a colour";
  set(r.options, file("copy").string());  // the same pictures
  const auto resumed = done(r);
  ASSERT_TRUE(resumed) << resumed.error().text();
  EXPECT_TRUE(same_bytes(picture("late.png"), picture("whole.png")));
}

TEST_F(SkyJob, ShardsMakeTheSamePicture) {
  ASSERT_TRUE(done(request("whole.png")));
  std::vector<NamedPart> parts;
  for (uint32_t shard = 0; shard < 3; ++shard) {
    const std::string name = "part" + std::to_string(shard) + ".raio";
    JobRequest r = request(name, shard == 1 ? "copy" : "sky");
    r.shard = shard, r.shards = 3;
    ASSERT_TRUE(done(r));
    parts.push_back({name, read_part(file(name)).value()});
  }
  // Parts are merged and written where their sky is not.
  std::filesystem::rename(file("sky"), file("gone"));
  EXPECT_TRUE(read_part(file("part0.raio")));
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged) << merged.error().text();
  EXPECT_TRUE(write_result(file("merged.png"), *merged));
  std::filesystem::rename(file("gone"), file("sky"));
  EXPECT_TRUE(same_bytes(picture("merged.png"), picture("whole.png")));
  JobRequest other = request("other.raio", "other");
  other.shard = 1, other.shards = 3;
  ASSERT_TRUE(done(other));
  parts.clear();
  for (const char* name : {"part0.raio", "other.raio"})
    parts.push_back({name, read_part(file(name)).value()});
  const auto refused = merge_parts(parts);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text(), "other.raio: it does not match part0.raio: the sky differs");
}

TEST_F(SkyJob, OptionsReplaceTheScenes) {
  Scene scene = scene_under(sky_of(file("sky")));
  RenderOptions o;
  EXPECT_EQ(resolve_options(o, scene).sky, scene.sky);
  EXPECT_FALSE(options_of(resolve_options(o, scene), scene).background);
  set(o, file("other").string());
  EXPECT_EQ(resolve_options(o, scene).sky, o.background->sky);
  EXPECT_EQ(options_of(resolve_options(o, scene), scene).background->sky, o.background->sky);
  o.background = WrittenColor{.color = scene.background};
  EXPECT_EQ(resolve_options(o, scene).sky, nullptr);
  EXPECT_EQ(options_of(resolve_options(o, scene), scene).background, o.background);
  o = {};
  o.view = View::depth;
  EXPECT_EQ(resolve_options(o, scene).sky, nullptr);
  EXPECT_FALSE(options_of(resolve_options(o, scene), scene).background);
}

TEST_F(SkyJob, IsFoundInTheFilesFolderOrAbove) {
  Scene scene = random_scene(10, 1);
  scene.requests.sky_folder = "sky";
  std::filesystem::create_directories(file("deep/er"));
  const auto path = file("deep/er/scene.raio");
  ASSERT_TRUE(write_scene(scene, path));
  auto read = read_scene(path);
  ASSERT_TRUE(read && read->scene.sky);
  EXPECT_TRUE(read->notices.empty());
  EXPECT_EQ(read->scene.requests.sky_folder, "sky");
  EXPECT_EQ(read->scene.sky->folder, "sky");
  EXPECT_EQ(read->scene.sky->hash, sky_of(file("sky"))->hash);
  EXPECT_EQ(content_hash(read->scene), content_hash(scene));
  EXPECT_NE(content_hash(scene), content_hash(random_scene(10, 1)));
  // The nearest counts.
  std::filesystem::rename(file("other"), file("deep/sky"));
  EXPECT_NE(read_scene(path)->scene.sky->hash, sky_of(file("sky"))->hash);
  // A scene is read without its sky, too, with another background.
  std::filesystem::remove_all(file("deep/sky"));
  std::filesystem::remove_all(file("sky"));
  read = read_scene(path);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->scene.sky, nullptr);
  ASSERT_EQ(read->notices.size(), 1u);
  EXPECT_EQ(
      read->notices[0].message,
      "its sky: found no folder sky next to the file or in a parent folder; the background is "
      "that of the scene (bclr)");
  EXPECT_FALSE(option_conflict({}, &read->scene));
  RenderOptions white;
  set(white, "#ffffff");
  EXPECT_FALSE(option_conflict(white, &read->scene));
}

TEST_F(Sky, FacesMayBeOfAnyType) {
  put_sky(file("sky"), 16, [](CubeFace, int, int) { return Rgb(0.2f, 0.4f, 0.6f); });
  std::string rows;
  for (int i = 0; i < 256; ++i) rows += "\x33\x66\x99";
  for (const auto& [name, progressive] : {std::pair("Left.JPG", false), {"top.jpeg", true}}) {
    put(file("sky") / name, jpeg_of(16, 16, rows, progressive));
    std::filesystem::remove(file("sky") /
                            (name == std::string("Left.JPG") ? "left.png" : "top.png"));
  }
  // Grey.
  put(file("sky/front.jpg"), jpeg_of(16, 16, std::string(256, '\x80'), false, true));
  const auto map = sky_of(file("sky"));
  EXPECT_EQ(map->side, 16);
  // JPEG's own rounding aside.
  const auto expect_color = [](Rgb color) { expect_near(color * 255, Rgb(51, 102, 153), 1.01f); };
  for (const auto face : {CubeFace::left, CubeFace::top}) {
    const uint32_t texel = map->texels[map->index(face, 3, 9)];
    expect_color(Rgb(float(texel & 255), float(texel >> 8 & 255), float(texel >> 16)) / 255);
  }
  expect_color(read_image(file("sky/top.jpeg"))->at(5, 5));
  EXPECT_EQ(map->texels[map->index(CubeFace::front, 3, 9)], 0x808080u) << "not before front.png";
  EXPECT_EQ(map->largest, 0x99);
}

TEST_F(Sky, FaultsOfFacesAreNamed) {
  EXPECT_EQ(error(), "sky: cannot read the folder: No such file or directory");
  std::filesystem::create_directories(file("sky"));
  EXPECT_EQ(error(),
            "sky: missing faces of the sky: right, left, top, bottom, front, back; expected right, "
            "left, top, "
            "bottom, front, back, each as .jpg, .jpeg or .png");
  put_sky(file("sky"), 8);
  EXPECT_EQ(error(), "none");
  std::filesystem::remove(file("sky/top.png"));
  std::filesystem::rename(file("sky/back.png"), file("sky/back.gif"));
  EXPECT_EQ(
      error(),
      "sky: missing faces of the sky: top, back; expected right, left, top, bottom, front, back, "
      "each as .jpg, .jpeg or .png");
  put_sky(file("sky"), 8);
  ASSERT_TRUE(write_image(Image(8, 7), file("sky/top.png")));
  EXPECT_EQ(error(),
            "sky: the face top (sky/top.png) has 8 x 7 pixels; expected as many columns as rows");
  ASSERT_TRUE(write_image(Image(9, 9), file("sky/top.png")));
  EXPECT_EQ(error(),
            "sky: the face top (sky/top.png) has 9 x 9 pixels, but the face right "
            "(sky/right.png) has 8 x 8 pixels; expected faces of one size");
  put(file("sky/top.png"), "GIF89a");
  EXPECT_EQ(error(), "sky: the face top (sky/top.png): expected a PNG or JPEG picture");
  put(file("sky/top.png"), "");
  EXPECT_EQ(error(), "sky: the face top (sky/top.png): the file is empty");
  put_sky(file("sky"), 8);
  const std::string png = get(file("sky/top.png"));
  put(file("sky/top.png"), png.substr(0, png.size() / 2));
  EXPECT_THAT(error(), HasSubstr("sky: the face top (sky/top.png): broken PNG: "));
  std::string rows(size_t(3) * 64 * 64, 'a');
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = char(i * i * 7);
  const std::string jpeg = jpeg_of(64, 64, rows);
  put(file("sky/bottom.jpg"), jpeg.substr(0, jpeg.size() / 2));
  put_sky(file("sky"), 64);
  EXPECT_EQ(error(),
            "sky: the face bottom (sky/bottom.jpg): broken JPEG: Premature end of JPEG file");
  put(file("sky/bottom.jpg"), jpeg.substr(0, 3));
  EXPECT_EQ(error(),
            "sky: the face bottom (sky/bottom.jpg): broken JPEG: Premature end of JPEG file");
  // A few bytes that claim to be many pixels.
  std::string large = jpeg;
  const size_t frame = large.find("\xff\xc0");
  ASSERT_NE(frame, std::string::npos);
  large.replace(frame + 5, 4, "\x3f\xff\x3f\xff");
  put(file("sky/bottom.jpg"), large);
  EXPECT_EQ(error(),
            "sky: the face bottom (sky/bottom.jpg): broken JPEG: too short for 16383 x "
            "16383 pixels");
  std::filesystem::remove(file("sky/bottom.jpg"));
  std::filesystem::remove(file("sky/bottom.png"));
  std::filesystem::create_directories(file("sky/bottom.png"));
  EXPECT_THAT(error(), HasSubstr("the face bottom: "));
}

// Any damage is an error or a picture, never a crash.
TEST_F(Sky, DamagedJpegsDoNoHarm) {
  std::string rows(size_t(3) * 32 * 32, 'a');
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = char(i * i * 13);
  size_t refused = 0;
  for (const bool progressive : {false, true}) {
    const std::string jpeg = jpeg_of(32, 32, rows, progressive);
    for (size_t i = 0; i < jpeg.size(); i += 3) {
      std::string damaged = jpeg;
      damaged[i] = char(damaged[i] ^ (1 << i % 8));
      put(file("a.jpg"), damaged);
      refused += !read_image(file("a.jpg"));
      put(file("a.jpg"), jpeg.substr(0, i));
      EXPECT_FALSE(read_image(file("a.jpg"))) << i;
    }
  }
  EXPECT_GT(refused, 100u);
}

TEST(SkyOption, ErrorsSayWhatIsAccepted) {
  RenderOptions o;
  const auto spec = std::ranges::find(render_option_table(), "background", &OptionSpec::name);
  const auto done = set_option(o, *spec, "no/such folder");
  ASSERT_FALSE(done);
  EXPECT_THAT(done.error().text(), HasSubstr("expected a colour"));
  EXPECT_THAT(done.error().text(),
              HasSubstr("found 'no/such folder'; nor is it sky, a picture of all directions as "
                        ".exr or .hdr, or a folder"));
}

}  // namespace
}  // namespace raio::core
