// Parts of a picture put together.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "render/part.h"

namespace raio {

SampleRange samples_of(const Part& part) {
  const auto& [header, film] = part;
  SampleRange range{~0u, 0};
  for (size_t t = header.shard; t < film->tiles(); t += header.shards) {
    range.fewest = std::min(range.fewest, film->samples(t));
    range.most = std::max(range.most, film->samples(t));
  }
  return range.fewest > range.most ? SampleRange{} : range;
}

namespace {

// Why the part is not to be merged by itself, or nothing.
std::string unfinished(const NamedPart& p) {
  const auto options = options_from(p.part.header.settings, false);
  const uint32_t wanted = options ? uint32_t(samples_per_pixel(*options)) : 0;
  const auto& [header, film] = p.part;
  // Of what was merged before, whole tiles may be missing.
  const uint32_t fewest = header.shards > 1 ? 0 : 1;
  size_t tiles = 0, lacking = 0;
  for (size_t t = header.shard; t < film->tiles(); t += header.shards) {
    const uint32_t samples = film->samples(t);
    ++tiles, lacking += samples >= fewest && samples < wanted;
  }
  if (lacking == 0) return {};
  return fmt::format(
      "it is not finished: {} of its {} tiles lack samples; `resume` it as `checkpoint` first",
      lacking, tiles);
}

std::string misfit(const NamedPart& first, const NamedPart& p) {
  const Metadata &a = p.part.header.settings, &b = first.part.header.settings;
  if (std::string why = difference(a, b); !why.empty())
    return fmt::format("it does not match {}: {}{}", first.name, why,
                       setting(a, "samples") != setting(b, "samples")
                           ? "; `add-samples` makes up for fewer samples"
                           : "");
  const Film &film = *p.part.film, &whole = *first.part.film;
  if (film.tile_side() != whole.tile_side() || film.bound() != whole.bound())
    return fmt::format("it does not match {}: tile size or bound differs", first.name);
  return {};
}

}  // namespace

std::expected<Part, Error> merge_parts(std::span<NamedPart> parts) {
  const auto refused = [](const NamedPart& part, std::string why) {
    return std::unexpected(Error{ErrorKind::bad_input, part.name, std::move(why)});
  };
  for (const NamedPart& p : parts) {
    if (std::string why = misfit(parts.front(), p); !why.empty()) return refused(p, why);
    if (std::string why = unfinished(p); !why.empty()) return refused(p, why);
  }
  Film& film = *parts.front().part.film;
  std::vector<size_t> owner(film.tiles(), 0);
  for (size_t i = 1; i < parts.size(); ++i) {
    const NamedPart& p = parts[i];
    size_t twice = 0, other = 0;
    for (size_t t = 0; t < film.tiles(); ++t) {
      if (p.part.film->samples(t) == 0) continue;
      if (film.samples(t) > 0) {
        ++twice, other = owner[t];
        continue;
      }
      film.replace(t, p.part.film->copy(t));
      owner[t] = i;
    }
    if (twice > 0)
      return refused(p,
                     fmt::format("it and {} both have {} of the {} tiles; each may be there once",
                                 parts[other].name, twice, film.tiles()));
  }
  return Part{{parts.front().part.header.settings, 0, 1}, std::move(parts.front().part.film)};
}

std::string missing_tiles(const Part& part, uint32_t shards) {
  const Film& film = *part.film;
  std::vector<size_t> missing(shards), all(shards);
  size_t total = 0;
  for (size_t t = 0; t < film.tiles(); ++t) {
    const bool lacks = film.samples(t) == 0;
    ++all[t % shards], missing[t % shards] += lacks, total += lacks;
  }
  if (total == 0) return {};
  std::string named;
  for (uint32_t i = 0; i < shards; ++i)
    if (shards > 1 && missing[i] > 0 && missing[i] == all[i])
      named += fmt::format("{}{}/{}", named.empty() ? ": shard " : ", ", i + 1, shards);
  return fmt::format("{} of {} tiles are missing{}", total, film.tiles(), named);
}

}  // namespace raio
