// Sessions without a window: the newest request wins, pictures get better, and are those of
// render().
#include "render/session.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <thread>
#include <type_traits>
#include <vector>

#include "integrate/views.h"
#include "rich_scene.h"
#include "sanitized.h"
#include "scene/columns.h"
#include "scenes.h"

namespace raio::core {
namespace {

// Sees every picture that a session shows.
class Watcher {
 public:
  // Waits until `good` accepts the picture.
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
  return std::make_shared<const Scene>(tests::random_scene(30, 7));
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
  WorkControl control;
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

TEST(Session, RefinesWithTheSamplesOfRender) {
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

TEST(Session, TheNewestRequestWins) {
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

TEST(Session, ShowsOneSampleWhilePausedThenResumes) {
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

TEST(Session, ReportsWhyThereIsNoPicture) {
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
    const auto s = std::make_shared<const Scene>(tests::random_scene(20, seed));
    for (const View view : {View::normals, View::steps, View::samples}) {
      RenderOptions o = options();
      o.view = view;
      const auto picture = w.whole(w.session.request({s, o}));
      EXPECT_TRUE(same_bits(*picture->image, rendered(*s, o))) << view_name(view);
    }
  }
}

// Another version of a scene, which shares all arrays that `change` does not write to.
std::shared_ptr<const Scene> version(const std::shared_ptr<const Scene>& scene,
                                     const std::function<void(Scene&)>& change) {
  auto next = std::make_shared<Scene>(*scene);
  change(*next);
  return next;
}

TEST(Session, KeepsTheStructureIfShapesAreUnchanged) {
  const auto owner = std::make_shared<const Scene>(tests::random_scene(30, 7));
  const auto first = version(owner, [](Scene&) {});
  const auto matt = version(first, [](Scene& s) {
    for (size_t m = 0; m < s.materials.size(); ++m) {
      Material& material = s.materials[m];
      material.color = {0.1f, 0.9f, 0.3f}, material.ks = 0, material.transmission = 0;
    }
  });
  const auto lit = version(matt, [](Scene& s) { s.lights.push_back({{0, -9, 9}, Rgb(1, 0, 0)}); });
  const auto blue = version(lit, [](Scene& s) { s.background = {0, 0, 1}; });
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::grid, AccelKind::embree}) {
    RenderOptions o = options();
    o.accel.kind = kind;
    Watcher w;
    const auto before = w.whole(w.session.request({first, o}));
    auto last = before;
    for (const auto& s : {matt, lit, blue, first}) {
      const auto p = w.whole(w.session.request({s, o}));
      EXPECT_EQ(p->baked->accel, before->baked->accel) << "another structure was built";
      EXPECT_EQ(p->baked->scene, s);
      EXPECT_TRUE(same_bits(*p->image, rendered(*s, o)));
      EXPECT_FALSE(same_bits(*p->image, *last->image));
      last = p;
    }
    // Other shapes, or the same with other materials or opacities, need another structure.
    const auto moved = version(first, [](Scene& s) { s.spheres[0].center.x += 0.5f; });
    const auto painted = version(first, [](Scene& s) {
      s.sphere_materials[0] = (s.sphere_materials[0] + 1) % uint32_t(s.materials.size());
    });
    const auto clear = version(
        first, [](Scene& s) { s.material_opacity = std::vector<float>(s.materials.size(), 0.5f); });
    for (const auto& s : {moved, painted, clear}) {
      const auto p = w.whole(w.session.request({s, o}));
      EXPECT_NE(p->baked->accel, last->baked->accel);
      EXPECT_TRUE(same_bits(*p->image, rendered(*s, o)));
      last = p;
    }
  }
}

// Only opaque surfaces are one-sided.
// As when a file is read again with other options: all arrays are new.
TEST(Session, SharesTreesIfOnlyColoursChange) {
  const auto scene_with = [](const std::function<void(Scene&)>& change) {
    Scene s = tests::rich_scene(3);
    Object ball;
    ball.spheres = {{{0, 0, 0}, 0.3f}}, ball.sphere_materials = {0};
    s.prototypes = {ball};
    s.instances = {{0, {1, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1, 1}}};
    change(s);
    return std::make_shared<const Scene>(std::move(s));
  };
  const auto recolor = [](Scene& s) {
    for (Rgb& color : s.sphere_colors) color = Rgb(1, 1, 1) - color;
    for (Material& material : s.materials) material.color = material.color * 0.5f;
    const MaterialId added = s.add_material(s.materials[s.prototypes[0].sphere_materials[0]]);
    s.prototypes[0].sphere_materials = {added};
    s.materials[added].color = Rgb(1, 0, 0);
  };
  Watcher w;
  const auto first = scene_with([](Scene&) {});
  const auto before = w.whole(w.session.request({first, options()}));
  const auto shown = [&](const std::function<void(Scene&)>& change) {
    const auto s = scene_with(change);
    auto picture = w.whole(w.session.request({s, options()}));
    EXPECT_TRUE(same_bits(*picture->image, rendered(*s, options())));
    return picture;
  };
  const auto structures = [](const SessionPicture& picture) {
    const Accel& accel = *picture.baked->accel;
    return std::pair(accel.structure(), accel.prototype(0)->structure());
  };
  const auto other = shown(recolor);
  EXPECT_NE(other->baked->accel, before->baked->accel);
  EXPECT_EQ(structures(*other), structures(*before));
  EXPECT_EQ(other->baked->build_s, before->baked->build_s) << "the time that it took to build it";
  const auto moved = shown([](Scene& s) { s.spheres[0].radius *= 1.5f; });
  EXPECT_NE(structures(*moved).first, structures(*before).first);
  EXPECT_EQ(structures(*moved).second, structures(*before).second) << "the prototype is the same";
  const auto clearer = shown([](Scene& s) { s.sphere_opacity[0] *= 0.5f; });
  EXPECT_NE(structures(*clearer).first, structures(*before).first);
}

TEST(Session, RebuildsWhenGlassTurnsOpaqueOnOneSide) {
  const auto owner = std::make_shared<const Scene>(tests::random_scene(30, 7));
  RenderOptions o = options();
  o.one_sided = true;
  const auto glass = version(owner, [](Scene& s) {
    for (size_t m = 0; m < s.materials.size(); ++m) s.materials[m].transmission = 0.5f;
  });
  Watcher w;
  const auto opaque = w.whole(w.session.request({owner, o}));
  const auto clear = w.whole(w.session.request({glass, o}));
  EXPECT_NE(clear->baked->accel, opaque->baked->accel);
  EXPECT_TRUE(same_bits(*clear->image, rendered(*glass, o)));
}

// A newer request stops a render anywhere, also between transparent layers of a ray.
TEST(Session, EndsAmongTransparentLayers) {
  const auto owner = std::make_shared<const Scene>(tests::random_scene(200, 7));
  const auto clear = version(
      owner, [](Scene& s) { s.material_opacity = std::vector<float>(s.materials.size(), 0.3f); });
  RenderOptions o = options(128, 96);
  o.samples = 4;
  Watcher w;
  for (int i = 0; i < tests::if_sanitized(100, 300); ++i) {
    o.seed = uint32_t(i);
    w.session.request({clear, o});
    std::this_thread::sleep_for(std::chrono::microseconds(997 * i % 20000));
  }
  o.seed = 1;
  EXPECT_TRUE(same_bits(*w.whole(w.session.request({clear, o}), 4)->image, rendered(*clear, o)));
}

// Enough spheres to make brute force slow.
std::shared_ptr<const Scene> slow_scene() {
  return std::make_shared<const Scene>(tests::random_scene(tests::if_sanitized(100, 400), 5));
}
RenderOptions slow() {
  RenderOptions o = options(128, 96);
  o.accel.kind = AccelKind::none, o.soft_shadows = true, o.samples = 2;
  return o;
}

TEST(Session, FiguresBelongToWholeSamples) {
  std::mutex mutex;
  std::vector<std::shared_ptr<const SessionPicture>> all;
  Session* shown = nullptr;
  Session session([&] {
    const std::lock_guard lock(mutex);
    if (shown) all.push_back(shown->picture());
  });
  {
    const std::lock_guard lock(mutex);
    shown = &session;
  }
  session.request({slow_scene(), slow()});
  const auto is_finished = [&] {
    const std::lock_guard lock(mutex);
    return !all.empty() && all.back()->finished;
  };
  while (!is_finished()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const std::lock_guard lock(mutex);
  int previews = 0;
  for (const auto& p : all) {
    if (p->samples > 0) {
      EXPECT_EQ(p->rays.eye, uint64_t(p->samples) * 128 * 96);
      EXPECT_GT(p->render_s, 0);
      continue;
    }
    ++previews;
    EXPECT_EQ(p->rays, RayCounts());
    EXPECT_EQ(p->render_s, 0);
    EXPECT_EQ(p->sample_s.median, 0);
  }
  EXPECT_GT(previews, 1);
  EXPECT_GT(all.back()->sample_s.median, 0);
  EXPECT_LE(all.back()->sample_s.low, all.back()->sample_s.median);
  EXPECT_LE(all.back()->sample_s.median, all.back()->sample_s.high);
}

TEST(Session, ReportsProgress) {
  Watcher w;
  const auto s = slow_scene();
  EXPECT_FALSE(w.session.progress());
  const uint64_t request = w.session.request({s, slow()});
  double least = 1, most = 0;
  int seen = 0;
  const auto is_whole = [&] {
    const auto p = w.session.picture();
    return p && p->request == request && p->samples > 0;
  };
  while (!is_whole()) {
    const auto now = w.session.progress();
    if (!now || now->stage != SessionProgress::sample) continue;
    least = std::min(least, now->share), most = std::max(most, now->share), ++seen;
    EXPECT_GE(now->left_s, 0);
  }
  EXPECT_GT(seen, 0);
  EXPECT_LT(least, most);
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 1);
  EXPECT_FALSE(w.session.progress()) << "there is a whole sample";
}

// Waits until a session is idle, which is not announced.
void wait_until_idle(const Session& session) {
  while (!session.is_idle()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(Session, IsIdleWhenAllIsDoneOrPaused) {
  const auto s = scene();
  Watcher w;
  wait_until_idle(w.session);
  const uint64_t request = w.session.request({s, soft(3)});
  w.wait([&](auto& p) { return p.request == request && p.finished; });
  wait_until_idle(w.session);

  w.session.pause(true);
  const uint64_t endless = w.session.request({s, soft()});
  wait_until_idle(w.session);
  EXPECT_EQ(w.session.picture()->request, endless);
  EXPECT_EQ(w.session.picture()->samples, 1);
  EXPECT_GT(w.session.picture()->sample_s.median, 0) << "timed before it rested";
  w.session.pause(false);
  w.whole(endless, 2);
  EXPECT_FALSE(w.session.is_idle());
  w.session.pause(true);
  wait_until_idle(w.session);
  const auto then = w.session.picture();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(w.session.picture(), then) << "no refining while it is idle";
}

TEST(Session, PreviewsOfTheFocusJudgeByThePicturesPixels) {
  const auto s = scene();
  Watcher w;
  RenderOptions o = options(512, 384);
  o.view = View::focus, o.dof = true, o.aperture = 0.02f;
  const auto share_in_focus = [&](double frame_s) {
    const uint64_t request = w.session.request({s, o, frame_s});
    const auto p = w.wait(
        [&](auto& now) { return now.request == request && (frame_s > 0 || now.samples > 0); });
    EXPECT_EQ(p->image->width < 64, frame_s > 0);
    double green = 0, seen = 0;
    for (const Rgb& c : p->image->pixels) {
      if (c.x + c.y + c.z == 0) continue;
      ++seen, green += c.y > 2 * c.x && c.y > 2 * c.z;
    }
    return green / seen;
  };
  const double whole = share_in_focus(0);
  EXPECT_LT(whole, 0.6);
  EXPECT_GT(whole, 0);
  EXPECT_NEAR(share_in_focus(1e-9), whole, 0.15);
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
}  // namespace raio::core
