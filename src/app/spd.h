// `raio spd verify`: Raio's counts in the standard scenes next to published ones. spd.cpp counts;
// spd_judge.cpp judges and formats.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/spd_published.h"
#include "integrate/film.h"

namespace raio::core::app {

enum class SpdVerdict { ok, known, off };

/// One of Raio's counts, with the published ones if there are any.
struct SpdRow {
  std::string_view what;
  double ours = 0;
  std::optional<double> haines, havran;
  double allowed = 0;  // relative to the published count
  double known = 0;    // the deviation from Havran's count that docs/verify.md explains

  /// Off if it deviates by more than `allowed` from a published count; known if a known deviation
  /// explains that.
  SpdVerdict verdict() const;
};

/// The counts of Raio's uniform grid at some resolution.
struct SpdGridCounts {
  uint64_t references = 0;
  double tests = 0, steps = 0;  // per ray
};

struct SpdGrid {
  std::array<int, 3> resolution;
  std::vector<SpdRow> rows;  // references, tests and steps per ray
};

struct SpdScene {
  std::string_view name;
  std::vector<SpdRow> rays;
  std::vector<SpdGrid> grids;
};

/// The published scene of that name, or null.
const PublishedScene* find_published(std::string_view name);

/// Rows for all published nonzero counts. The allowed deviation depends on that between the two
/// authors.
SpdScene beside_published(const PublishedScene& published, const RayCounts& rays,
                          std::span<const SpdGridCounts> grids);

bool any_off(std::span<const SpdScene> scenes);

std::string spd_text(std::span<const SpdScene> scenes);
std::string spd_json(std::span<const SpdScene> scenes);

}  // namespace raio::core::app
