// Sessions without a window: the newest request wins, pictures get better, and are those of
// render().
#include "render/session.h"

#include <gtest/gtest.h>

#include <cstring>

#include "integrate/views.h"
#include "scenes.h"

namespace raio {
namespace {

// Sees every picture that a session shows.
class Watcher {
 public:
  // Waits until `good` says so of a picture.
  template <class Good>
  std::shared_ptr<const SessionPicture> wait(Good&& good) {
    std::unique_lock lock(mutex_);
    while (true) {
      if (auto picture = session.picture(); picture && good(*picture)) return picture;
      news_.wait_for(lock, std::chrono::milliseconds(20));
    }
  }
  std::shared_ptr<const SessionPicture> whole(uint64_t request, int samples = 1) {
    return wait(
        [&](const SessionPicture& p) { return p.request >= request && p.samples >= samples; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;

 public:
  Session session{[this] { news_.notify_all(); }};
};

std::shared_ptr<const Scene> scene() {
  return std::make_shared<const Scene>(testing::random_scene(30, 7));
}

RenderOptions options(int width = 64, int height = 48) {
  RenderOptions o;
  o.width = width, o.height = height, o.aa = 1;
  return o;
}

RenderOptions soft(int samples = kMaxSamples) {
  RenderOptions o = options();
  o.soft_shadows = true, o.samples = samples;
  return o;
}

Image rendered(const Scene& scene, const RenderOptions& request) {
  const RenderSettings o = resolve_options(request, scene);
  const auto accel = build_accel(scene, o.accel, o.one_sided);
  RenderControl control;
  const auto film = make_film(scene, o);
  EXPECT_TRUE(render(scene, **accel, o, **film, control).finished);
  return picture_of(**film, o.view);
}

bool same_bits(const Image& a, const Image& b) {
  return a.width == b.width && a.height == b.height &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

TEST(Session, ShowsThePictureOfRender) {
  const auto s = scene();
  Watcher w;
  const auto picture = w.whole(w.session.request({s, options()}));
  EXPECT_TRUE(picture->finished);
  EXPECT_EQ(picture->samples, 1);
  EXPECT_EQ(picture->rays.eye, 64u * 48);
  EXPECT_TRUE(same_bits(*picture->image, rendered(*s, options())));
}

TEST(Session, GetsBetterAndEverySampleIsThatOfRender) {
  const auto s = scene();
  Watcher w;
  const uint64_t request = w.session.request({s, soft()});
  for (const int samples : {1, 5, 9}) {
    const auto picture = w.whole(request, samples);
    EXPECT_FALSE(picture->finished);
    EXPECT_TRUE(same_bits(*picture->image, rendered(*s, soft(picture->samples))))
        << picture->samples;
  }
}

TEST(Session, EndsWithTheSamplesOfTheOptions) {
  const auto s = scene();
  Watcher w;
  RenderOptions jitter = options();
  jitter.aa = 2, jitter.lens_samples = 2;
  for (const RenderOptions& o : {soft(7), jitter}) {
    const uint64_t request = w.session.request({s, o});
    const auto picture = w.wait([&](auto& p) { return p.request == request && p.finished; });
    EXPECT_EQ(picture->samples, o.samples > 0 ? 7 : 8);
    EXPECT_TRUE(same_bits(*picture->image, rendered(*s, o)));
  }
}

TEST(Session, TheNewestWishWins) {
  const auto s = scene();
  Watcher w;
  uint64_t request = 0;
  for (int i = 0; i < 50; ++i) {
    RenderOptions o = i % 2 ? soft() : options(300 + i, 200);
    o.from = Vec3d(0.1 * i, -8, 3), o.at = Vec3d(0, 0, 0);
    request = w.session.request({s, o, i % 5 == 4 ? 0.01 : 0});
    EXPECT_EQ(request, uint64_t(i) + 1);
  }
  RenderOptions last = options(31, 17);
  last.accel.kind = AccelKind::grid;
  request = w.session.request({s, last});
  const auto picture = w.wait([&](auto& p) { return p.request == request && p.finished; });
  EXPECT_EQ(picture->baked->info.name, "grid");
  EXPECT_TRUE(same_bits(*picture->image, rendered(*s, last)));
}

TEST(Session, MovementIsShownCoarselyWhenTimeIsShort) {
  const auto s = scene();
  Watcher w;
  const uint64_t request = w.session.request({s, options(512, 512), 1e-9});
  const auto picture = w.wait([&](auto& p) { return p.request == request; });
  EXPECT_EQ(picture->samples, 0);
  EXPECT_LT(picture->image->width, 512 / 8);
  EXPECT_EQ(picture->settings.width, 512);
  // And in full when there is time.
  const uint64_t slow = w.session.request({s, options(40, 30), 1e9});
  EXPECT_EQ(w.wait([&](auto& p) { return p.request == slow; })->image->width, 40);
}

TEST(Session, PausedItShowsOneSampleAndGoesOnAfterwards) {
  const auto s = scene();
  Watcher w;
  w.session.pause(true);
  const uint64_t request = w.session.request({s, soft(4)});
  EXPECT_EQ(w.whole(request)->samples, 1);
  // Another request is served while paused, too.
  const uint64_t other = w.session.request({s, options()});
  EXPECT_TRUE(w.whole(other)->finished);
  const uint64_t again = w.session.request({s, soft(4)});
  EXPECT_EQ(w.whole(again)->samples, 1);
  w.session.pause(false);
  w.wait([&](auto& p) { return p.request == again && p.finished; });
}

TEST(Session, SaysWhyThereIsNoPicture) {
  const auto s = scene();
  Watcher w;
  w.whole(w.session.request({s, options()}));
  const uint64_t request = w.session.request({s, options(1 << 20, 1 << 20)});
  const auto failed = w.wait([&](auto& p) { return p.request == request && p.error.has_value(); });
  EXPECT_EQ(failed->error->kind, ErrorKind::no_resource);
  EXPECT_NE(failed->error->message.find("`size`"), std::string::npos) << failed->error->text();
  EXPECT_EQ(failed->image->width, 64) << "the older picture stays";
  EXPECT_FALSE(w.whole(w.session.request({s, options()}))->error.has_value());
}

TEST(Session, ShowsViewsAndAnotherScene) {
  Watcher w;
  for (const uint32_t seed : {1u, 2u}) {
    const auto s = std::make_shared<const Scene>(testing::random_scene(20, seed));
    for (const View view : {View::normals, View::steps, View::samples}) {
      RenderOptions o = options();
      o.view = view;
      const auto picture = w.whole(w.session.request({s, o}));
      EXPECT_TRUE(same_bits(*picture->image, rendered(*s, o))) << view_name(view);
    }
  }
}

TEST(Session, EndsInTheMiddleOfItsWork) {
  const auto s = scene();
  for (int i = 0; i < 5; ++i) {
    Session session;
    session.request({s, soft()});
    if (i == 3) session.rest();
  }
}

}  // namespace
}  // namespace raio
