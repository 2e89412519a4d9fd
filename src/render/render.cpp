#include "render/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "base/memory.h"
#include "integrate/prepared_scene.h"
#include "integrate/views.h"
#include "render/noise.h"

namespace raio::core {

std::optional<Error> picture_problem(int width, int height, const PlainOptions& options,
                                     uint32_t shards) {
  const auto refused = [](const std::string& why) {
    return Error{ErrorKind::no_resource, "", why + "; choose a smaller `size`"};
  };
  const size_t pixels = size_t(width) * size_t(height);
  // The film, of whole tiles, and the float and byte pictures made from it.
  const auto whole = [](int side) {
    return std::min(2.0 * side, std::ceil(double(side) / kMaxTileSide) * kMaxTileSide);
  };
  const FilmLayout layout(options.film_channels());
  const double means = layout.means(), squares = layout.squares(), firsts = layout.firsts();
  double bytes = whole(width) * whole(height) *
                 ((options.noise > 0 ? 2 : 1) * sizeof(PixelSums) + means * sizeof(int64_t) +
                  squares * sizeof(Uint128) + firsts * sizeof(uint32_t)) /
                 shards;
  if (shards == 1)
    bytes += double(pixels) * (sizeof(Rgb) + 6 + double(layout.planes()) * sizeof(float));
  if (const AvailableMemory available = available_memory(); bytes > 0.9 * double(available.bytes))
    return refused(fmt::format("a picture of {}x{} pixels needs {:.1f} GB and {}", width, height,
                               bytes * 1e-9, available.text()));
  // The sampler numbers them.
  if (pixels > std::numeric_limits<uint32_t>::max())
    return refused(fmt::format("a picture of {}x{} has more than {} pixels", width, height,
                               std::numeric_limits<uint32_t>::max()));
  return std::nullopt;
}

std::expected<std::unique_ptr<Film>, Error> make_film(const Scene& scene,
                                                      const RenderSettings& settings,
                                                      uint32_t shards) {
  const int width = settings.frame().width(), height = settings.frame().height();
  if (auto why = picture_problem(width, height, settings, shards))
    return std::unexpected(std::move(*why));
  // Large tiles fill more batches with rays of later levels, as long as there are enough tiles for
  // all threads.
  constexpr int kTiles = 64;
  const auto across = [](int pixels) { return (pixels + kMaxTileSide - 1) / kMaxTileSide; };
  const bool large = double(across(width)) * across(height) >= kTiles;
  const int side = settings.noise > 0 ? kNoiseTileSide : large ? kMaxTileSide : kTileSide;
  return std::make_unique<Film>(width, height, sample_bound(scene, settings), side,
                                settings.film_channels(), shards > 1, settings.rounds());
}

namespace {

/// One call of render().
class Work {
 public:
  Work(const PreparedScene& scene, Film& film, WorkControl& control, const RenderTask& task)
      : film_(film),
        control_(control),
        threads_(scene.settings.threads),
        task_(task),
        options_(scene.settings),
        adapts_(scene.settings.noise > 0 && task.samples == 0),
        wanted_{task.first_sample, task.samples > 0 ? task.samples : scene.sampler.samples},
        renderers_([&scene, &control] { return make_tile_renderer(scene, control); }) {
    uint64_t total = 0;
    for (size_t t = task.shard; t < film.tiles(); t += task.shards)
      if (const uint32_t missing = film.samples(t).missing(wanted_).count(); missing > 0)
        tiles_.push_back(t), total += missing;
    costs_ns_.resize(tiles_.size());
    control.stage = Stage::rendering;
    control.rays_done = 0, control.work_done = 0;
    control.work_total = total;
  }

  double busy_s() const { return 1e-9 * double(busy_ns_); }

  /// Whether everything is done.
  bool run() {
    return adapts_ ? add_as_needed() : task_.seconds > 0 ? run_in_time() : add_up_to(wanted_.end);
  }

 private:
  bool late() const { return task_.seconds > 0 && seconds_since(start_) >= task_.seconds; }
  bool ended() const { return control_.stop || stop_requested() || late(); }

  // Adds the missing samples of a tile in portions, so the film is never far behind; each is of one
  // round. Returns the time taken.
  int64_t add(size_t tile, SampleSpan wanted) {
    const auto start = Clock::now();
    const SampleRounds rounds = film_.rounds();
    for (SampleSpan next;
         !(next = film_.samples(tile).first_missing(wanted)).empty() && !ended();) {
      const uint32_t round_end = rounds.end(rounds.start(next.first));
      next.end = std::min({next.first + kPortion, next.end, round_end});
      renderers_.local()->render(tile, next, film_);
      look_at_clock();
    }
    const int64_t cost_ns = std::chrono::nanoseconds(Clock::now() - start).count();
    busy_ns_ += cost_ns;
    return cost_ns;
  }

  // Returns whether all tiles have the samples before `end` now. Tiles that were expensive last
  // time come first, so that threads finish together.
  bool add_up_to(uint32_t end) {
    std::vector<size_t> order(tiles_.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::ranges::sort(order, [&](size_t a, size_t b) {
      return costs_ns_[a] != costs_ns_[b] ? costs_ns_[a] > costs_ns_[b] : a < b;
    });
    Executor(threads_, nullptr).run([&] {
      deal(tiles_.size(), [&](size_t k) {
        const size_t i = order[k];
        costs_ns_[i] = add(tiles_[i], {wanted_.first, end});
      });
    });
    return reached_by_all().first >= end;
  }

  // Adds the samples that each tile needs, then those that it needs after these, and so on. Returns
  // whether none needs more.
  bool add_as_needed() {
    struct Portion {
      size_t tile;
      SampleSpan samples;
    };
    std::vector<TileNeed> needs(tiles_.size());
    for (std::vector<Portion> portions;; portions.clear()) {
      Executor(threads_, nullptr).run([&] {
        deal(tiles_.size(), [&](size_t i) { needs[i] = need_of(film_, tiles_[i], options_); });
      });
      uint64_t likely = 0;
      for (size_t i = 0; i < tiles_.size(); ++i) {
        const SampleSet has = film_.samples(tiles_[i]), missing = has.missing({0, needs[i].end});
        if (missing.empty()) continue;
        likely += needs[i].likely - has.count();
        // The first samples are summed in the film's memory, by one thread.
        const uint32_t most = has.empty() ? needs[i].end : kPortion;
        for (SampleSpan span : missing.spans())
          for (; !span.empty(); span.first = std::min(span.first + most, span.end))
            portions.push_back({tiles_[i], {span.first, std::min(span.first + most, span.end)}});
      }
      control_.work_total = control_.work_done + likely;
      if (portions.empty()) return true;
      if (ended()) return false;
      Executor(threads_, nullptr).run([&] {
        deal(portions.size(), [&](size_t i) { add(portions[i].tile, portions[i].samples); });
      });
    }
  }

  // Calls `at_interval` when it is due, in one thread at a time.
  void look_at_clock() {
    if (!task_.at_interval) return;
    const std::unique_lock lock(interval_mutex_, std::try_to_lock);
    if (!lock || seconds_since(interval_start_) < task_.interval_s) return;
    run_to_the_end(task_.at_interval);
    interval_start_ = Clock::now();
  }

  // Each pass has half as many samples as all before it; the last has as many as time permits.
  bool run_in_time() {
    auto [whole, most] = reached_by_all();
    uint32_t next = std::max(most, whole + 1);  // completes a partial pass
    std::vector<TileSamples> before;
    for (double a_sample = 0; whole < wanted_.end;) {
      before.clear();
      for (const size_t t : tiles_) before.push_back(film_.copy(t));
      const auto pass_start = Clock::now();
      if (!add_up_to(next)) {
        // Drops the unfinished pass, which only some tiles have.
        if (!control_.stop && !stop_requested() && whole > wanted_.first)
          for (size_t i = 0; i < tiles_.size(); ++i) film_.replace(tiles_[i], before[i]);
        return false;
      }
      a_sample = seconds_since(pass_start) / (next - whole);
      whole = next;
      const double fit = 0.9 * (task_.seconds - seconds_since(start_)) / std::max(a_sample, 1e-9);
      if (fit < 1) break;
      const uint32_t grown =
          std::min(wanted_.end - whole, std::max(1u, (whole - wanted_.first) / 2));
      next = whole + uint32_t(std::min(double(grown), fit));
    }
    return whole >= wanted_.end;
  }

  SampleSpan missing(size_t tile, uint32_t end) const {
    return film_.samples(tile).first_missing({wanted_.first, end});
  }

  // Two ends of samples: of those that all tiles of the task have without gaps, and of those that
  // any tile has.
  std::pair<uint32_t, uint32_t> reached_by_all() const {
    uint32_t whole = wanted_.end, most = wanted_.first;
    for (const size_t t : tiles_) {
      whole = std::min(whole, missing(t, wanted_.end).first);
      most = std::clamp(film_.samples(t).end(), most, wanted_.end);
    }
    return {whole, most};
  }

  Film& film_;
  WorkControl& control_;
  int threads_;
  static constexpr uint32_t kPortion = 64;
  const RenderTask& task_;
  const PlainOptions& options_;
  bool adapts_;  // to the noise of each tile
  SampleSpan wanted_;
  Clock::time_point start_ = Clock::now(), interval_start_ = start_;
  std::mutex interval_mutex_;
  std::vector<size_t> tiles_;      // with missing samples
  std::vector<int64_t> costs_ns_;  // of their last samples
  std::atomic<int64_t> busy_ns_ = 0;
  PerThread<std::unique_ptr<TileRenderer>> renderers_;
};

}  // namespace

RenderResult render(const Scene& scene, const Accel& accel, const RenderSettings& settings,
                    Film& film, WorkControl& control, const RenderTask& task) {
  const auto start = Clock::now();
  const PreparedScene prepared(scene, accel, settings);
  Work work(prepared, film, control, task);
  const bool finished = work.run();
  return {finished, seconds_since(start), work.busy_s()};
}

Image picture_of(const Film& film, View view) {
  if (view != View::samples) return film.resolve();
  Image image(film.width(), film.height());
  for (size_t t = 0; t < film.tiles(); ++t) {
    const Rgb color = heat_color(film.samples(t).count());
    const Tile tile = film.tile(t);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) image.at(x, y) = color;
  }
  return image;
}

}  // namespace raio::core
