// Checks that all structures, any number of threads and all instruction sets give the same picture.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "render/options.h"
#include "render/render.h"

namespace raio::core::tests {

inline std::unique_ptr<Film> film_of(const Scene& scene, const RenderOptions& options) {
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  EXPECT_TRUE(accel) << accel.error().text();
  WorkControl control;
  auto film = make_film(scene, settings);
  EXPECT_TRUE(film) << film.error().text();
  EXPECT_TRUE(render(scene, **accel, settings, **film, control).finished);
  return std::move(*film);
}
inline Image picture_of(const Scene& scene, const RenderOptions& options) {
  return film_of(scene, options)->resolve();
}

inline bool same_bytes(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Rgb)) == 0;
}

/// The picture, checked to be finite, rendered with every structure, on one thread and on three,
/// with each instruction set of this machine.
inline Image expect_one_picture(const Scene& scene, RenderOptions options) {
  options.accel.kind = AccelKind::none;
  const Image none = picture_of(scene, options);
  EXPECT_TRUE(std::ranges::all_of(none.pixels, [](const Rgb& c) { return is_finite(c); }));
  for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh}) {
    options.accel.kind = kind;
    for (const int threads : {1, 3}) {
      options.threads = threads;
      EXPECT_TRUE(same_bytes(none, picture_of(scene, options)))
          << accel_name(kind) << " on " << threads << " threads";
    }
  }
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_TRUE(same_bytes(none, picture_of(scene, options))) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  return none;
}

}  // namespace raio::core::tests
