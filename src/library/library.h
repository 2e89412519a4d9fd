// Shared by the sources of the public interface: conversion of values and failures, and the data
// behind its classes.
#pragma once

#include <raio/raio.h>

#include <array>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "base/error.h"
#include "base/executor.h"
#include "base/vec.h"
#include "render/job.h"
#include "render/part.h"
#include "scene/scene.h"

// Not in raio::v1, where every name is exported.
namespace raio::core::library {

inline Vec3d vec(const v1::Triple& t) { return {t[0], t[1], t[2]}; }
inline v1::Triple triple(Vec3d v) { return {v.x, v.y, v.z}; }
inline Rgb rgb(const v1::Triple& t) { return Rgb(vec(t)); }

[[noreturn]] void refuse(const std::string& message);
[[noreturn]] void fail(const Error& error);

// Converts running out of memory and being stopped to an Error.
template <class F>
auto guarded(F&& f) try {
  return f();
} catch (const std::bad_alloc&) {
  throw v1::Error(v1::ErrorKind::no_resource, "out of memory");
} catch (const Stopped&) {
  fail(stopped_error());
}

// The same for long work, on this many threads; 0: those of the caller's executor.
template <class F>
auto guarded_work(int threads, const F& f, WorkControl* control = nullptr) {
  return guarded([&] { return Executor(threads, control).run(f); });
}

// A copy of the film, also while other threads add to it.
std::unique_ptr<Film> copy_of(const Film& film);

std::optional<std::array<v1::Triple, 2>> bounds_of(const Scene& scene);

}  // namespace raio::core::library

namespace raio::inline v1 {

struct Scene::Data {
  core::Scene scene;
  std::vector<std::string> warnings;
  bool has_background = false;                  // was set; data files have none
  core::ReadOptions read = core::kForPictures;  // of its file
  // The meaning of colours and lengths, as the reader found it.
  std::optional<core::ColorScale> colors = {};
  std::vector<core::LegendEntry> legend = {};
  std::string unit = {};
};

// Members that were not set have their defaults.
struct Settings::Data : core::JobRequest {};

struct Film::Data {
  core::Part part;
  uint32_t shards = 1;         // of the picture
  int threads = 0;             // of the job
  std::string name = {};       // of its file; empty: none
  double pixels_per_unit = 0;  // 0: unknown
  Annotations annotations = {};
};

struct Accel::Data {
  core::Scene scene;
  bool has_background = false;  // as in the Scene
  core::ReadOptions read = {};  // of the scene's file
  core::RenderOptions options;  // as resolved; only those of the structure matter
  std::unique_ptr<core::Accel> accel;

  /// The scene's content_hash(). Thread-safe.
  const std::string& hash() const;

 private:
  mutable std::once_flag is_hashed_;
  mutable std::string hash_;
};

}  // namespace raio::inline v1
