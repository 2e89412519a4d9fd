// Merges parts of a picture.
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "render/noise.h"
#include "render/part.h"

namespace raio::core {

namespace {

uint64_t tile_pixels(const Tile& tile) {
  return uint64_t(tile.x1 - tile.x0) * uint64_t(tile.y1 - tile.y0);
}

}  // namespace

SampleCounts samples_of(const Part& part) {
  const auto& [header, film] = part;
  SampleCounts counts;
  uint64_t all = 0, pixels = 0;
  for (size_t t = header.shard; t < film->tiles(); t += header.shards) {
    const SampleSet samples = film->samples(t);
    const uint32_t count = samples.count();
    if (t == header.shard) counts = {count, count, 0, true, samples};
    counts.fewest = std::min(counts.fewest, count), counts.most = std::max(counts.most, count);
    counts.alike &= samples == counts.samples;
    const uint64_t here = tile_pixels(film->tile(t));
    all += count * here, pixels += here;
  }
  counts.mean = double(all) / double(std::max<uint64_t>(pixels, 1));
  return counts;
}

double share_with(uint32_t samples, const Part& part) {
  const auto& [header, film] = part;
  uint64_t with = 0, pixels = 0;
  for (size_t t = header.shard; t < film->tiles(); t += header.shards) {
    const uint64_t here = tile_pixels(film->tile(t));
    pixels += here;
    if (film->samples(t).count() == samples) with += here;
  }
  return double(with) / double(std::max<uint64_t>(pixels, 1));
}

namespace {

std::string misfit(const NamedPart& first, const NamedPart& p) {
  const Metadata &a = p.part.header.settings, &b = first.part.header.settings;
  if (std::string why = difference(a, b); !why.empty())
    return fmt::format("it does not match {}: {}{}", first.name, why,
                       setting(a, "samples") != setting(b, "samples")
                           ? "; `add-samples` adds missing samples"
                           : "");
  const Film &film = *p.part.film, &whole = *first.part.film;
  if (film.tile_side() != whole.tile_side() || film.bound() != whole.bound())
    return fmt::format("it does not match {}: tile size or bound differs", first.name);
  return {};
}

// Why a film has samples of the part already, which is that of `other`; nothing if it has none.
std::string overlap(const Film& film, const NamedPart& part, std::string_view other) {
  size_t twice = 0;
  SampleSpan both;
  for (size_t t = 0; t < film.tiles(); ++t)
    if (const SampleSet has = part.part.film->samples(t); !has.empty())
      if (const SampleSpan here = film.samples(t).overlap(has); !here.empty())
        if (++twice == 1) both = here;
  if (twice == 0) return {};
  return fmt::format(
      "it and {} both have samples {}:{} in {} of the {} tiles; leave one of them out, or render "
      "parts of one division (`shard`)",
      other, both.first, both.end, twice, film.tiles());
}

}  // namespace

std::expected<void, Error> add_part(NamedPart& whole, const NamedPart& part) {
  Film& film = *whole.part.film;
  std::string why = misfit(whole, part);
  if (why.empty()) why = overlap(film, part, whole.name);
  if (!why.empty()) return std::unexpected(Error{ErrorKind::bad_input, part.name, std::move(why)});
  parallel_for(film.tiles(), [&](size_t t) {
    if (!part.part.film->samples(t).empty()) film.add(t, part.part.film->copy(t));
  });
  return {};
}

std::expected<Part, Error> merge_parts(size_t count, const PartSource& part) {
  const auto first = part(0);
  if (!first) return std::unexpected(first.error());
  NamedPart whole = std::move(**first);
  for (size_t i = 1; i < count; ++i) {
    const auto next = part(i);
    if (!next) return std::unexpected(next.error());
    auto added = add_part(whole, **next);
    if (added) continue;
    // The samples may be those of another than the first.
    const NamedPart misfit = std::move(**next);
    for (size_t j = i; --j > 0;)
      if (const auto other = part(j))
        if (std::string why = overlap(*(*other)->part.film, misfit, (*other)->name); !why.empty())
          return std::unexpected(Error{ErrorKind::bad_input, misfit.name, std::move(why)});
    return std::unexpected(std::move(added.error()));
  }
  // The merged part may have other final values.
  Part& merged = whole.part;
  std::erase_if(merged.header.settings, [](const auto& s) { return s.first == "samples_done"; });
  return Part{{merged.header.settings, 0, 1}, std::move(merged.film)};
}

std::expected<Part, Error> merge_parts(std::span<NamedPart> parts) {
  return merge_parts(parts.size(), [&](size_t i) { return &parts[i]; });
}

namespace {

// Missing samples by tile.
class Missing {
 public:
  explicit Missing(const Part& part)
      : film_(*part.film), options_(options_from(part.header.settings, false)) {}

  SampleSet of(size_t tile) const {
    return film_.samples(tile).missing({0, options_ ? need_of(film_, tile, *options_).end : 1});
  }

 private:
  const Film& film_;
  std::expected<RenderOptions, Error> options_;
};

}  // namespace

std::optional<SampleSet> missing_samples(const Part& part, uint32_t shard, uint32_t shards) {
  const Missing missing_of(part);
  std::optional<SampleSet> missing;
  for (size_t t = shard; t < part.film->tiles(); t += shards) {
    SampleSet here = missing_of.of(t);
    if (missing && *missing != here) return std::nullopt;
    missing = std::move(here);
  }
  return missing ? std::move(missing) : SampleSet();
}

std::string missing_samples(const Part& part, uint32_t shards) {
  const Film& film = *part.film;
  const Missing missing_of(part);
  std::vector<size_t> missing(shards), all(shards);
  size_t tiles = 0, with_gaps = 0;
  SampleSet gaps;  // of the first tile with gaps
  bool alike = true;
  for (size_t t = 0; t < film.tiles(); ++t) {
    ++all[t % shards];
    if (film.samples(t).empty()) {
      ++missing[t % shards], ++tiles;
    } else if (const SampleSet here = missing_of.of(t); !here.empty()) {
      if (++with_gaps == 1) gaps = here;
      alike &= here == gaps;
    }
  }
  std::string text;
  if (tiles > 0) {
    text = fmt::format("{} of {} tiles are missing", tiles, film.tiles());
    std::string_view before = ": ";
    for (uint32_t i = 0; i < shards; ++i)
      if (shards > 1 && missing[i] > 0)
        text += fmt::format("{}{}shard {}/{}", std::exchange(before, ", "),
                            missing[i] == all[i] ? "" : "a part of ", i + 1, shards);
  }
  if (with_gaps > 0)
    text += fmt::format("{}samples {} are missing in {} of {} tiles{}", text.empty() ? "" : "; ",
                        text_of(gaps), alike ? with_gaps : 1, film.tiles(),
                        alike ? "" : fmt::format(", others in {}", with_gaps - 1));
  return text;
}

}  // namespace raio::core
