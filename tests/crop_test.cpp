// A part of a picture: the same pixels as in the whole, at the cost of the part.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "one_picture.h"
#include "render/job.h"
#include "render/picture.h"
#include "sanitized.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::random_scene;

constexpr int kWidth = 150, kHeight = 90;
constexpr Crop kCrops[] = {{0, 0, 1, 1},     {37, 21, 110, 85}, {149, 89, 150, 90},
                           {0, 50, 150, 51}, {3, 2, 4, 90},     {64, 32, 128, 64}};

RenderOptions cropped(AccelKind kind, std::optional<Crop> crop = {}) {
  RenderOptions o;
  o.width = kWidth, o.height = kHeight;
  o.accel.kind = kind;
  o.soft_shadows = true, o.dof = true;
  o.crop = crop;
  return o;
}

Picture rendered(const Scene& scene, const RenderOptions& options) {
  const RenderSettings settings = resolve_options(options, scene);
  const auto film = tests::film_of(scene, options);
  const Crop frame = settings.frame();
  const auto pixels = uint64_t(frame.width()) * uint64_t(frame.height());
  EXPECT_EQ(film->rays().eye, pixels * uint64_t(settings.samples_per_pixel()));
  return picture_of(*film, settings);
}

template <class T>
Column<T> cut(const Column<T>& numbers, const Crop& crop) {
  const size_t components = numbers.size() / (size_t(kWidth) * size_t(kHeight));
  Column<T> out;
  for (int y = crop.y0; y < crop.y1; ++y) {
    const auto row = numbers.begin() + ptrdiff_t(size_t(y) * kWidth * components);
    out.insert(out.end(), row + ptrdiff_t(size_t(crop.x0) * components),
               row + ptrdiff_t(size_t(crop.x1) * components));
  }
  return out;
}

// Compares bits, so a NaN equals itself.
template <class T>
bool same(const Column<T>& a, const Column<T>& b) {
  if (a.empty() || b.empty()) return a.empty() == b.empty();  // memcmp() takes no null
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_cut(const Scene& scene, RenderOptions options) {
  const Picture whole = rendered(scene, options);
  for (const Crop& crop : kCrops) {
    SCOPED_TRACE(testing::Message() << crop.x0 << "," << crop.y0);
    options.crop = crop;
    const Picture part = rendered(scene, options);
    EXPECT_EQ(part.color.width, crop.width());
    EXPECT_EQ(part.color.height, crop.height());
    EXPECT_TRUE(same(part.color.pixels, cut(whole.color.pixels, crop)));
    EXPECT_TRUE(same(part.alpha, cut(whole.alpha, crop)));
    ASSERT_EQ(part.layers.size(), whole.layers.size());
    for (size_t i = 0; i < part.layers.size(); ++i)
      std::visit(
          [&](const auto& numbers) {
            using Numbers = std::decay_t<decltype(numbers)>;
            EXPECT_TRUE(same(std::get<Numbers>(part.layers[i].values), cut(numbers, crop)))
                << part.layers[i].name;
          },
          whole.layers[i].values);
  }
}

TEST(Crop, HasThePixelsOfTheWholePicture) {
  const Scene scene = random_scene(tests::if_sanitized(20, 60), 4);
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh}) {
    RenderOptions jittered = cropped(kind);
    jittered.aa = 2, jittered.lens_samples = 2;
    expect_cut(scene, jittered);
    RenderOptions sobol = cropped(kind);
    sobol.samples = 5, sobol.angle_to_centers = true;
    expect_cut(scene, sobol);
  }
}

TEST(Crop, HasTheChannelsAndViewsOfTheWholePicture) {
  const Scene scene = random_scene(60, 5);
  RenderOptions o = cropped(AccelKind::grid);
  o.aa = 2;
  for (const ChannelSpec& spec : kChannels) o.channels.add(spec.channel);
  expect_cut(scene, o);
  for (int view = 1; view < kViews; ++view) {
    RenderOptions shown = cropped(AccelKind::bvh);
    shown.view = View(view);
    expect_cut(scene, shown);
  }
}

// The position of each pixel's first eye ray in the pixel, from 0 to 1 along an axis: x is 0, y is
// 1.
std::vector<double> places_in_pixels(size_t axis, const RenderOptions& options,
                                     const Scene& scene) {
  const Picture picture = rendered(scene, options);
  const double pixel =
      2 * std::tan(double(scene.camera.fov_deg) / 360 * std::numbers::pi) / options.height;
  std::vector<double> out;
  for (const auto& layer : picture.layers)
    if (layer.name == "position") {
      const auto& numbers = std::get<Column<float>>(layer.values);
      for (size_t i = axis; i < numbers.size(); i += 3)
        out.push_back(double(numbers[i]) / pixel - std::floor(double(numbers[i]) / pixel));
    }
  return out;
}

// They are not those of the pixels 65536 further, whose numbers would be the same with 16 bits for
// a column: to the right and one row up, or below.
TEST(Crop, OfAVeryLargePictureHasItsOwnSamples) {
  constexpr int kSide = 64, kFar = 65536;
  Scene scene;
  scene.materials.emplace_back();
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}}, scene.plane_materials = {0};
  scene.camera.from = {0, 0, 1}, scene.camera.at = {0, 0, 0};
  scene.camera.projection = Projection::orthographic;
  for (const SamplerKind kind : {SamplerKind::jitter, SamplerKind::sobol})
    for (const bool tall : {false, true}) {
      RenderOptions o;
      o.width = tall ? kSide : 2 * kFar, o.height = tall ? 2 * kFar : kSide;
      o.aa = 2, o.sampler = kind;
      o.channels.add(Channel::position);
      o.crop = Crop{0, 0, kSide, kSide};
      const auto near = places_in_pixels(tall ? 0 : 1, o, scene);
      o.crop = tall ? Crop{0, kFar, kSide, kFar + kSide} : Crop{kFar, 0, kFar + kSide, kSide};
      const auto far = places_in_pixels(tall ? 0 : 1, o, scene);
      ASSERT_EQ(near.size(), size_t(kSide * kSide));
      ASSERT_EQ(far.size(), near.size());
      size_t equal = 0;
      for (size_t i = tall ? 0 : kSide; i < near.size(); ++i)
        equal += std::abs(near[i] - far[tall ? i : i - kSide]) < 0.01;
      EXPECT_LT(equal, near.size() / 20) << tall;
    }
}

TEST(Crop, OfTheWholePictureIsNone) {
  const Scene scene = random_scene(10, 1);
  const RenderOptions all = cropped(AccelKind::bvh, Crop{0, 0, kWidth, kHeight});
  EXPECT_EQ(resolve_options(all, scene), resolve_options(cropped(AccelKind::bvh), scene));
}

TEST(Crop, IsInsideThePicture) {
  const auto spec = std::ranges::find(render_option_table(), "crop", &OptionSpec::name);
  RenderOptions o;
  for (const char* text : {"", "1", "1,2,3", "1,2,3,4,", "1,2,3,4,5", "-1,0,3,4", "5,0,5,9",
                           "5,0,4,9", "0,9,3,9", "a,0,3,4", "0,0,1.5,2", "0, 0,1,1"}) {
    const auto set = set_option(o, *spec, text);
    ASSERT_FALSE(set) << text;
    EXPECT_THAT(set.error().message, HasSubstr("X0,Y0,X1,Y1"));
    EXPECT_THAT(set.error().message, HasSubstr("found '" + std::string(text) + "'"));
  }
  ASSERT_TRUE(set_option(o, *spec, "3,4,20,30"));
  EXPECT_EQ(o.crop, (Crop{3, 4, 20, 30}));
  EXPECT_EQ(spec->text(o), "3,4,20,30");

  Scene scene = random_scene(10, 1);
  EXPECT_FALSE(option_conflict(o, &scene));
  scene.camera.width = 20, scene.camera.height = 29;
  const auto why = option_conflict(o, &scene);
  ASSERT_TRUE(why);
  EXPECT_EQ(why->subject, "crop");
  EXPECT_THAT(why->message, HasSubstr("20x29 pixels"));
  EXPECT_FALSE(option_conflict(o));  // its size is not known yet
  o.width = 19, o.height = 40;
  EXPECT_TRUE(option_conflict(o));
  EXPECT_TRUE(window_conflict(o));
}

class CropJob : public TemporaryFolder {
 protected:
  JobRequest request(std::string_view output, std::optional<Crop> crop = Crop{20, 10, 115, 75}) {
    JobRequest r;
    r.loaded = scene_;
    r.options = cropped(AccelKind::bvh, crop);
    r.options.samples = 4;
    r.output = file(output);
    return r;
  }
  static std::expected<void, Error> done(const JobRequest& r) {
    RenderJob job(r);
    if (auto ready = job.prepare(); !ready) return ready;
    if (auto run = job.run(); !run) return run;
    return job.write();
  }
  static std::string bytes(const JobRequest& r) {
    const auto all = done(r);
    EXPECT_TRUE(all) << all.error().text();
    return get(r.output);
  }

  std::shared_ptr<const Scene> scene_ = std::make_shared<const Scene>(random_scene(40, 3));
};

TEST_F(CropJob, IsCheckpointedResumedSplitAndRepeated) {
  const std::string once = bytes(request("once.png"));
  EXPECT_THAT(once, HasSubstr(std::string("raio.crop\0", 10) + "20,10,115,75"));

  JobRequest few = request("few.png");
  few.options.samples = 1, few.checkpoint = file("c.raio");
  bytes(few);
  JobRequest on = request("on.png");
  on.checkpoint = few.checkpoint, on.resume = true;
  EXPECT_TRUE(bytes(on) == once);
  for (const std::optional<Crop>& other :
       {std::optional<Crop>(), std::optional(Crop{20, 10, 115, 74}),
        std::optional(Crop{21, 10, 116, 75})}) {
    on.options.crop = other;
    const auto refused = done(on);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("`crop` 20,10,115,75, not "));
  }

  std::vector<NamedPart> parts;
  for (const uint32_t shard : {2u, 0u, 1u}) {
    JobRequest r = request("part.raio");
    r.shard = shard, r.shards = 3;
    bytes(r);
    parts.push_back({"part", *read_part(r.output)});
  }
  const auto merged = merge_parts(parts);
  ASSERT_TRUE(merged) << merged.error().text();
  ASSERT_TRUE(write_result(file("merged.png"), *merged));
  EXPECT_TRUE(get(file("merged.png")) == once);

  JobRequest again = request("again.png");
  again.options = {}, again.repeat = file("once.png");
  EXPECT_TRUE(bytes(again) == once);
}

// A part file is not trusted: its film has the size in its settings.
TEST_F(CropJob, PartsHoldTheFilmOfTheirCrop) {
  bytes(request("part.raio"));
  Part part = *read_part(file("part.raio"));
  const auto reread = [&](std::string_view key, std::string text) {
    Part changed{part.header, std::make_unique<Film>(95, 65, part.film->bound())};
    std::erase_if(changed.header.settings, [&](const auto& s) { return s.first == key; });
    if (!text.empty()) changed.header.settings.emplace_back(key, std::move(text));
    return decode_part(encode_part(changed.header, *changed.film));
  };
  EXPECT_TRUE(reread("crop", "0,0,95,65"));
  EXPECT_FALSE(reread("crop", "0,0,95,66"));
  EXPECT_FALSE(reread("crop", "100,0,195,65"));
  EXPECT_FALSE(reread("crop", ""));
  EXPECT_FALSE(reread("size", ""));
}

}  // namespace
}  // namespace raio::core
