#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/json.h"
#include "app/spd.h"

namespace raio::core::app {
namespace {

// The two authors deviate by less than this in most scenes. Where they deviate more, their
// deviation is the limit.
constexpr double kEyeHits = 0.005, kSecondary = 0.04, kShadow = 0.02, kGrid = 0.1;
constexpr double kBeyond = 0.005;

double apart(double ours, double published) {
  return published != 0 ? ours / published - 1 : ours != 0 ? 1 : 0;
}

SpdRow row(std::string_view what, uint64_t ours, std::optional<uint64_t> haines,
           std::optional<uint64_t> havran, double allowed, double known = 0) {
  if (haines && havran) {
    const auto [less, more] = std::minmax({double(*haines), double(*havran)});
    allowed = std::max(allowed, apart(more, less) + kBeyond);
  }
  SpdRow r{what, double(ours), {}, {}, allowed, known};
  if (haines) r.haines = double(*haines);
  if (havran) r.havran = double(*havran);
  return r;
}

std::string percent(std::optional<double> published, double ours) {
  return published ? fmt::format("{:+.1f} %", 100 * apart(ours, *published)) : "";
}

std::string_view name_of(SpdVerdict verdict) {
  constexpr std::array<std::string_view, 3> kNames = {"ok", "known", "off"};
  return kNames[size_t(verdict)];
}

std::string number(std::optional<double> value, bool whole) {
  if (!value) return "-";
  return whole ? fmt::format("{:.0f}", *value) : fmt::format("{:.2f}", *value);
}

std::string rays_text(std::span<const SpdScene> scenes) {
  constexpr std::string_view kLine = "{:<8} {:<17} {:>9} {:>9} {:>8} {:>9} {:>9} {:>8}  {}\n";
  std::string out = fmt::format(kLine, "scene", "rays", "Raio", "Haines", "apart", "Havran",
                                "apart", "allowed", "verdict");
  for (const SpdScene& scene : scenes) {
    out += "\n";
    for (const SpdRow& r : scene.rays)
      out += fmt::format(kLine, &r == &scene.rays.front() ? scene.name : "", r.what,
                         number(r.ours, true), number(r.haines, true), percent(r.haines, r.ours),
                         number(r.havran, true), percent(r.havran, r.ours),
                         fmt::format("{:.1f} %", 100 * r.allowed), name_of(r.verdict()));
  }
  return out;
}

std::string grids_text(std::span<const SpdScene> scenes) {
  constexpr std::string_view kLine = "{:<8} {:<11} {:>7}  {:<14} {:>9} {:>9} {:>9} {:>8}  {}\n";
  std::string out = fmt::format(kLine, "scene", "grid", "cells", "", "Raio", "Havran", "apart",
                                "allowed", "verdict");
  for (const SpdScene& scene : scenes)
    for (const SpdGrid& grid : scene.grids) {
      out += "\n";
      const auto [x, y, z] = grid.resolution;
      for (const SpdRow& r : grid.rows) {
        const bool first = &r == &grid.rows.front();
        out += fmt::format(kLine, first ? scene.name : "",
                           first ? fmt::format("{}x{}x{}", x, y, z) : "",
                           first ? fmt::format("{}", x * y * z) : "", r.what, number(r.ours, first),
                           number(r.havran, first), percent(r.havran, r.ours),
                           fmt::format("{:.1f} %", 100 * r.allowed), name_of(r.verdict()));
      }
    }
  return out;
}

std::array<int, 3> count_verdicts(std::span<const SpdScene> scenes) {
  std::array<int, 3> counts{};
  for (const SpdScene& scene : scenes) {
    for (const SpdRow& r : scene.rays) ++counts[size_t(r.verdict())];
    for (const SpdGrid& grid : scene.grids)
      for (const SpdRow& r : grid.rows) ++counts[size_t(r.verdict())];
  }
  return counts;
}

Json json_of(const SpdRow& r) {
  const auto optional = [](std::optional<double> v) { return v ? Json(*v) : Json(nullptr); };
  return {{"what", r.what},
          {"raio", r.ours},
          {"haines", optional(r.haines)},
          {"havran", optional(r.havran)},
          {"allowed", r.allowed},
          {"known", r.known},
          {"verdict", name_of(r.verdict())}};
}

}  // namespace

SpdVerdict SpdRow::verdict() const {
  const auto within = [&](std::optional<double> published, double departure) {
    return !published || std::abs(apart(ours, *published) - departure) <= allowed;
  };
  if (within(haines, 0) && within(havran, 0)) return SpdVerdict::ok;
  return known != 0 && within(haines, 0) && within(havran, known) ? SpdVerdict::known
                                                                  : SpdVerdict::off;
}

const PublishedScene* find_published(std::string_view name) {
  const auto found = std::ranges::find(kPublished, name, &PublishedScene::name);
  return found == kPublished.end() ? nullptr : &*found;
}

SpdScene beside_published(const PublishedScene& published, const RayCounts& rays,
                          std::span<const SpdGridCounts> grids) {
  const std::optional<HainesCounts>& haines = published.haines;
  const HavranCounts& havran = published.havran;
  const auto by_haines = [&](uint64_t HainesCounts::* count) {
    return haines ? std::optional((*haines).*count) : std::nullopt;
  };
  SpdScene out{published.name, {}, {}};
  const auto add = [&](const SpdRow& r) {
    if (r.ours != 0 || r.haines.value_or(0) != 0 || r.havran.value_or(0) != 0)
      out.rays.push_back(r);
  };
  add(row("eye, that hit", rays.eye_hits, by_haines(&HainesCounts::eye_hits), havran.eye_hits,
          kEyeHits));
  // Havran gives only the sum of both.
  const bool glass = haines && haines->refraction > 0;
  const auto reflection = by_haines(&HainesCounts::reflection);
  if (glass) {
    add(row("reflected", rays.reflection, reflection, {}, kSecondary));
    add(row("refracted", rays.refraction, haines->refraction, {}, kSecondary));
    add(row("both", rays.reflection + rays.refraction, *reflection + haines->refraction,
            havran.secondary, kSecondary));
  } else {
    add(row("reflected", rays.reflection + rays.refraction, reflection, havran.secondary,
            kSecondary));
  }
  add(row("to lights", rays.shadow, by_haines(&HainesCounts::shadow), havran.shadow, kShadow));
  add(row("to lights, hidden", rays.shadow_hits, {}, havran.blocked, kShadow,
          published.known.blocked));

  for (size_t i = 0; i < grids.size(); ++i) {
    const SpdGridCounts& ours = grids[i];
    const HavranGrid& his = published.grids[i];
    const Departures::Grid& known = published.known.grids[i];
    out.grids.push_back(
        {his.resolution,
         {row("references", ours.references, {}, his.references, kGrid, known.references),
          {"tests per ray", ours.tests, {}, his.tests, kGrid, known.tests},
          {"steps per ray", ours.steps, {}, his.steps, kGrid, known.steps}}});
  }
  return out;
}

bool any_off(std::span<const SpdScene> scenes) {
  return count_verdicts(scenes)[size_t(SpdVerdict::off)] > 0;
}

std::string spd_text(std::span<const SpdScene> scenes) {
  std::string out =
      "513x513 rays through the corners of 512x512 pixels, depth 5\n"
      "apart: Raio's count relative to the published one. known: a deviation larger than\nallowed, "
      "within what docs/verify.md explains.\n\n";
  out += rays_text(scenes);
  if (std::ranges::any_of(scenes, [](const SpdScene& s) { return !s.grids.empty(); }))
    out += "\nThe plain uniform grid, without mailbox, at Havran's resolutions\n\n" +
           grids_text(scenes);
  const auto counts = count_verdicts(scenes);
  return out + fmt::format("\n{} ok, {} known, {} off\n", counts[0], counts[1], counts[2]);
}

std::string spd_json(std::span<const SpdScene> scenes) {
  Json json{{"version", RAIO_VERSION}, {"rays_a_side", 513}, {"depth", 5}};
  const auto rows = [](std::span<const SpdRow> all) {
    Json out = Json::array();
    for (const SpdRow& r : all) out.push_back(json_of(r));
    return out;
  };
  json["scenes"] = Json::array();
  for (const SpdScene& scene : scenes) {
    Json grids = Json::array();
    for (const SpdGrid& grid : scene.grids)
      grids.push_back({{"resolution", grid.resolution}, {"rows", rows(grid.rows)}});
    json["scenes"].push_back(
        {{"scene", scene.name}, {"rays", rows(scene.rays)}, {"grids", std::move(grids)}});
  }
  const auto counts = count_verdicts(scenes);
  for (const SpdVerdict v : {SpdVerdict::ok, SpdVerdict::known, SpdVerdict::off})
    json[std::string(name_of(v))] = counts[size_t(v)];
  return json_text(json);
}

}  // namespace raio::core::app
