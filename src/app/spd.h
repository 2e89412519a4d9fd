// Raio's counts in the standard scenes beside those that others have published: `raio spd verify`.
// Measuring is in spd.cpp, judging here and in spd_judge.cpp, with the forms of the result.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/spd_published.h"
#include "integrate/film.h"

namespace raio::app {

enum class SpdVerdict { ok, known, off };

/// A count of Raio's beside what was published, where it was.
struct SpdRow {
  std::string_view what;
  double ours = 0;
  std::optional<double> haines, havran;
  double allowed = 0;  // as a part of the published count
  double known = 0;    // the departure from Havran's count that docs/verify.md explains

  /// Off when it is further than `allowed` from one of the two; known when it is where a known
  /// departure puts it.
  SpdVerdict verdict() const;
};

/// What Raio's uniform grid of a certain resolution counted.
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

/// Rows for all counts that were published and are not zero. How far they may be apart follows from
/// how far the two authors are.
SpdScene beside_published(const PublishedScene& published, const RayCounts& rays,
                          std::span<const SpdGridCounts> grids);

bool any_off(std::span<const SpdScene> scenes);

std::string spd_text(std::span<const SpdScene> scenes);
std::string spd_json(std::span<const SpdScene> scenes);

}  // namespace raio::app
