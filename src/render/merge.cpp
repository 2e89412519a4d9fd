// Merges parts of a picture.
#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "render/part.h"

namespace raio::core {

SampleCounts samples_of(const Part& part) {
  const auto& [header, film] = part;
  SampleCounts counts;
  for (size_t t = header.shard; t < film->tiles(); t += header.shards) {
    const SampleSet samples = film->samples(t);
    const uint32_t count = samples.count();
    if (t == header.shard) {
      counts = {count, count, true, samples};
      continue;
    }
    counts.fewest = std::min(counts.fewest, count), counts.most = std::max(counts.most, count);
    counts.alike &= samples == counts.samples;
  }
  return counts;
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

// Adds the part after those `before` it to the film; returns an error or nothing.
std::string add_part(Film& film, const NamedPart& p, std::span<const NamedPart> before) {
  size_t twice = 0;
  SampleSpan both;
  std::string_view other;
  for (size_t t = 0; t < film.tiles(); ++t) {
    const SampleSet samples = p.part.film->samples(t);
    const SampleSpan here = film.samples(t).overlap(samples);
    if (here.empty()) {
      film.add(t, p.part.film->copy(t));
      continue;
    }
    if (++twice > 1) continue;
    both = here;
    // The first part's film already has the samples of the others.
    other = before.front().name;
    for (const NamedPart& b : before.subspan(1))
      if (const SampleSpan shared = b.part.film->samples(t).overlap(samples); !shared.empty())
        other = b.name, both = shared;
  }
  if (twice == 0) return {};
  return fmt::format(
      "it and {} both have samples {}:{} in {} of the {} tiles; leave one of them out", other,
      both.first, both.end, twice, film.tiles());
}

}  // namespace

std::expected<Part, Error> merge_parts(std::span<NamedPart> parts) {
  Part& first = parts.front().part;
  for (size_t i = 1; i < parts.size(); ++i) {
    std::string why = misfit(parts.front(), parts[i]);
    if (why.empty()) why = add_part(*first.film, parts[i], parts.first(i));
    if (!why.empty())
      return std::unexpected(Error{ErrorKind::bad_input, parts[i].name, std::move(why)});
  }
  // The merged part may have other final values.
  std::erase_if(first.header.settings, [](const auto& s) { return s.first == "samples_done"; });
  return Part{{first.header.settings, 0, 1}, std::move(first.film)};
}

std::string missing_samples(const Part& part, uint32_t shards) {
  const Film& film = *part.film;
  const auto options = options_from(part.header.settings, false);
  const SampleSpan wanted{0, options ? uint32_t(options->samples_per_pixel()) : 1};
  std::vector<size_t> missing(shards), all(shards);
  size_t tiles = 0, with_gaps = 0;
  SampleSet gaps;  // of the first tile with gaps
  bool alike = true;
  for (size_t t = 0; t < film.tiles(); ++t) {
    const SampleSet samples = film.samples(t);
    ++all[t % shards];
    if (samples.empty()) {
      ++missing[t % shards], ++tiles;
    } else if (const SampleSet here = samples.missing(wanted); !here.empty()) {
      if (++with_gaps == 1) gaps = here;
      alike &= here == gaps;
    }
  }
  std::string text;
  if (tiles > 0) {
    text = fmt::format("{} of {} tiles are missing", tiles, film.tiles());
    std::string_view before = ": ";
    for (uint32_t i = 0; i < shards; ++i)
      if (shards > 1 && missing[i] > 0 && missing[i] == all[i])
        text += fmt::format("{}shard {}/{}", std::exchange(before, ", "), i + 1, shards);
  }
  if (with_gaps > 0)
    text += fmt::format("{}samples {} are missing in {} of {} tiles{}", text.empty() ? "" : "; ",
                        text_of(gaps), alike ? with_gaps : 1, film.tiles(),
                        alike ? "" : fmt::format(", others in {}", with_gaps - 1));
  return text;
}

}  // namespace raio::core
