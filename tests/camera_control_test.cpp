// Interactive cameras, and focus.
#include "view/camera_control.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "integrate/camera.h"
#include "view/gestures.h"
#include "view/stage.h"
#include "view/state.h"
#include "view_scenes.h"

namespace raio::core::view {
namespace {

double distance(Vec3d a, Vec3f b) { return length(a - Vec3d(b)); }

// A point's position in the picture: right of and above its centre in half heights, and its depth.
Vec3d seen(const Camera& c, Vec3d point) {
  const CameraAxes axes(c);
  const Vec3d to = point - Vec3d(c.from);
  const double depth = dot(to, axes.forward);
  const double from = c.is_parallel() ? length(Vec3d(c.at) - Vec3d(c.from)) : depth;
  const double half = from * std::tan(double(c.fov_deg) * std::numbers::pi / 360);
  return {dot(to, axes.right) / half, dot(to, axes.up) / half, depth};
}

Camera parallel_camera() {
  Camera c = camera();
  c.projection = core::Projection::orthographic;
  return c;
}

void expect_near(Vec3d a, Vec3d b, double error = 1e-4) {
  EXPECT_LE(length(a - b), error) << a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y
                                  << ' ' << b.z;
}

TEST(CameraControl, OrbitsAboutAFixedPoint) {
  const Vec3d pivot(0.3, -0.5, 0.8);
  const Camera before = camera();
  for (const auto& [right, up] : {std::pair(0.4, 0.0), {0.0, 0.3}, {-1.0, -0.2}, {3.0, 0.1}}) {
    const Camera after = orbited(before, pivot, right, up);
    EXPECT_NEAR(distance(pivot, after.from), distance(pivot, before.from), 1e-4);
    expect_near(seen(after, pivot), seen(before, pivot));
    EXPECT_EQ(after.up, before.up);
  }
  // To the right and upwards, as requested.
  const CameraAxes axes(before);
  EXPECT_GT(dot(Vec3d(orbited(before, pivot, 0.2, 0).from) - Vec3d(before.from), axes.right), 0.1);
  EXPECT_GT(dot(Vec3d(orbited(before, pivot, 0, 0.2).from) - Vec3d(before.from), axes.up), 0.1);
}

TEST(CameraControl, StopsShortOfThePoles) {
  Camera c = camera();
  for (int i = 0; i < 100; ++i) c = orbited(c, Vec3d(c.at), 0.1, 0.3);
  EXPECT_EQ(camera_problem(c), "");
  EXPECT_LT(CameraAxes(c).forward.z, -0.99);
  for (int i = 0; i < 100; ++i) c = looked(c, 0.1, 0.3);
  EXPECT_EQ(camera_problem(c), "");
  EXPECT_GT(CameraAxes(c).forward.z, 0.99);
}

TEST(CameraControl, PansPointsAtTheDepthWithTheCursor) {
  for (const Camera& before : {camera(), parallel_camera()}) {
    const Vec3d point(0.5, 0, 1);
    const Vec3d at = seen(before, point);
    const Camera after = panned(before, at.z, 0.25, 0.1);
    expect_near(seen(after, point), at + Vec3d(0.5, 0.2, 0));
  }
}

TEST(CameraControl, DolliesTowardsThePointUnderTheCursor) {
  const Camera before = camera();
  const Vec3d target(0.8, -1, 1.2);
  const Vec3d at = seen(before, target);
  for (const double factor : {0.5, 0.9, 1.3}) {
    const Vec3d now = seen(dollied(before, target, factor), target);
    expect_near(now, {at.x, at.y, at.z * factor});
  }
  EXPECT_EQ(camera_problem(dollied(before, target, 1e-3)), "");
}

// Approaching would not change the size.
TEST(CameraControl, ParallelRaysAreZoomed) {
  const Camera before = parallel_camera();
  const Vec3d target(0.8, -1, 1.2), other(0.1, 2, 0.4);
  const Vec3d at = seen(before, target), there = seen(before, other);
  for (const double factor : {0.5, 0.9, 1.3}) {
    const Camera after = dollied(before, target, factor);
    expect_near(seen(after, target), at);
    const Vec3d apart = (there - at) * (1 / factor);
    expect_near(seen(after, other), {at.x + apart.x, at.y + apart.y, there.z});
  }
  Camera far = before, near = before;
  for (int i = 0; i < 1000; ++i) far = dollied(far, target, 1.2), near = dollied(near, target, 0.8);
  for (const Camera& c : {far, near}) {
    EXPECT_TRUE(c.fov_deg > 0 && c.fov_deg < 180);
    expect_near(seen(c, target), at, 1e-2);
  }
}

TEST(CameraControl, WalksAlongItsOwnAxes) {
  const Camera before = camera();
  const CameraAxes axes(before);
  const Camera after = walked(before, 1, 2, 3);
  const Vec3d move = axes.right + axes.up * 2 + axes.forward * 3;
  expect_near(Vec3d(after.from) - Vec3d(before.from), move);
  expect_near(Vec3d(after.at) - Vec3d(before.at), move);
}

TEST(CameraControl, FitsTheWholeBox) {
  Box3f box;
  box.extend(Vec3f(-3, 1, 0)), box.extend(Vec3f(5, 2, 9));
  for (const double aspect : {0.5, 1.0, 2.0, -0.5, -1.0, -2.0}) {
    const Camera after = fitted(aspect > 0 ? camera() : parallel_camera(), box, std::abs(aspect));
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3d at =
          seen(after, {corner & 1 ? -3.0 : 5.0, corner & 2 ? 1.0 : 2.0, corner & 4 ? 0.0 : 9.0});
      EXPECT_GT(at.z, 0);
      EXPECT_LE(std::abs(at.x), std::abs(aspect));
      EXPECT_LE(std::abs(at.y), 1);
    }
  }
  EXPECT_EQ(fitted(camera(), {}, 1).from, camera().from);
}

// The point under the cursor is the one that the picture shows there.
TEST(CameraControl, PicksHitsOfParallelRays) {
  Scene s = *scene();
  s.camera = parallel_camera();
  const auto accel = build_accel(s, {});
  ASSERT_TRUE(accel);
  const int width = 48, height = 36;
  const EyeRays rays(s.camera, width, height);
  int hits = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double across = (x + 0.5) / width, down = (y + 0.5) / height;
      const Pick found = pick(**accel, s.camera, across, down, double(width) / height);
      RayBatch one;
      one.push(rays.pinhole(float(x) + 0.5f, float(y) + 0.5f));
      HitBatch hit;
      hit.reset(1);
      TraceContext context;
      (*accel)->closest(one, hit, context);
      if (!hit[0].found() || !found.hit.found()) continue;
      ++hits;
      const Vec3d at = seen(s.camera, found.point);
      EXPECT_NEAR(at.x, (2 * across - 1) * width / height, 1e-5);
      EXPECT_NEAR(at.y, 1 - 2 * down, 1e-5);
      EXPECT_NEAR(at.z, found.depth, 1e-5);
      if (found.hit.primitive == hit[0].primitive) {
        EXPECT_NEAR(found.depth, double(hit[0].t), 1e-3);
      }
    }
  EXPECT_GT(hits, 400);
}

TEST(Focus, FollowsThePointWhenTheCameraMoves) {
  ViewState state("some.nff", scene(), {});
  const Vec3d point(0.3, 0.2, 0.4);
  state.focus_on(point);
  EXPECT_TRUE(state.is_on(Command::depth_of_field));
  for (const double factor : {0.8, 0.5, 1.7}) {
    state.camera = dollied(state.camera, point, factor);
    state.follow_focus();
    EXPECT_NEAR(state.options.focus, seen(state.camera, point).z, 1e-4);
  }
  state.camera = orbited(state.camera, {1, 1, 1}, 0.3, 0.1);
  state.follow_focus();
  EXPECT_NEAR(state.options.focus, seen(state.camera, point).z, 1e-4);
  // Someone types another one: it stays.
  state.options.focus = 2.5f;
  state.camera = dollied(state.camera, point, 0.9);
  state.follow_focus();
  EXPECT_EQ(state.options.focus, 2.5f);
  EXPECT_FALSE(state.focus_point);
}

// Dragging ground at the horizon.
TEST(Gestures, DraggingNeverFlingsTheSceneAway) {
  for (const double times : {0.3, 1.0, 2.0, 30.0, 1e6})
    for (const auto button : {Gestures::Button::left, Gestures::Button::middle}) {
      ViewState state("some.nff", scene(), {});
      const Stage stage({0, 0, 512, 512}, 1, 512, 512);
      const Camera before = state.camera;
      const double distance = length(Vec3d(before.at) - Vec3d(before.from));
      Vec3d held;
      Gestures hand(state, stage, [&](double x, double y) {
        const CameraAxes axes(before);
        const double half = std::tan(double(before.fov_deg) * std::numbers::pi / 360);
        Pick pick;
        pick.hit = {}, pick.hit.primitive = 1, pick.hit.t = 1;
        pick.depth = times * distance;
        pick.point = Vec3d(before.from) + (axes.forward + axes.right * ((x / 256 - 1) * half) +
                                           axes.up * ((1 - y / 256) * half)) *
                                              pick.depth;
        held = pick.point;
        return pick;
      });
      hand.move(200, 300);
      hand.press(button, false);
      for (int i = 1; i <= 10; ++i) hand.move(200 + 10 * i, 300 + 2 * i);
      (void)hand.release(button);
      EXPECT_FALSE(state.camera == before);
      // Near points are dragged themselves; far ones move the point looked at.
      const Vec3d at = seen(state.camera, times < 1 ? held : Vec3d(before.at));
      EXPECT_GT(at.z, 0) << times;
      EXPECT_LE(std::abs(at.x), 1) << times;
      EXPECT_LE(std::abs(at.y), 1) << times;
      EXPECT_NEAR(at.z, std::min(times, 1.0) * distance, 0.5 * distance) << times;
    }
}

}  // namespace
}  // namespace raio::core::view
