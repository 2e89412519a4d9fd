#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <expected>
#include <ranges>
#include <span>
#include <string_view>
#include <vector>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/file.h"
#include "io/image/image.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "render/regions.h"

namespace raio::core::app {

namespace {

std::string decibels(double psnr_db) {
  return std::isinf(psnr_db) ? "infinite (equal pictures)" : fmt::format("{:.2f} dB", psnr_db);
}

std::string figures(const ImageDifference& d) {
  return fmt::format(
      "PSNR                {}\n"
      "RMSE                {:.4g} of 255\n"
      "largest difference  {} of 255\n"
      "pixels above 8      {:.4g} %\n",
      decibels(d.psnr_db), d.rmse, d.largest, 100 * d.above_8);
}

// Likely causes if pictures of a scene differ in a region.
constexpr std::array<std::string_view, kRegionNames.size()> kCauses = {
    "objects there, the background's colour, or the camera",
    "antialiasing, the lens, or the camera by a fraction of a pixel; whole objects: geometry",
    "reflected and refracted rays: their weights, depth, and clamping",
    "normals, highlights, clamping, and reflected rays",
    "positions and sizes of lights, or the number of samples",
    "shadow rays that start inside the object or end beyond the light; ambient light",
    "the diffuse part; if B is much darker, shadow rays that start inside the object or end beyond "
    "the light",
};

struct RegionSum {
  size_t pixels = 0, apart = 0;
  double change = 0;  // B minus A, summed over pixels above 8
};

// Recommends the region in which most pixels differ. Reflections also show what is wrong elsewhere,
// so mirrors and shiny surfaces count only if matt ones hardly differ.
Region suspect(std::span<const RegionSum> sums) {
  const auto apart = [&](Region r) { return sums[size_t(r)].apart; };
  const size_t matt = apart(Region::shadow_border) + apart(Region::shadow) + apart(Region::lit);
  const size_t reflecting = apart(Region::mirror) + apart(Region::shiny);
  std::vector<Region> candidates = {Region::background, Region::edge, Region::shadow_border,
                                    Region::shadow, Region::lit};
  if (10 * matt < reflecting) candidates.insert(candidates.end(), {Region::mirror, Region::shiny});
  return std::ranges::max(candidates, {}, apart);
}

std::string explained(const Image& a, const Image& b, const std::vector<Region>& regions) {
  std::array<RegionSum, kRegionNames.size()> sums;
  size_t apart = 0;
  for (size_t i = 0; i < regions.size(); ++i) {
    RegionSum& sum = sums[size_t(regions[i])];
    ++sum.pixels;
    const auto x = display_bytes(a.pixels[i]), y = display_bytes(b.pixels[i]);
    int most = 0, change = 0;
    for (size_t c = 0; c < 3; ++c)
      most = std::max(most, std::abs(x[c] - y[c])), change += y[c] - x[c];
    if (most <= 8) continue;
    ++sum.apart, ++apart;
    sum.change += change / 3.0;
  }
  std::string text = fmt::format("\n{:<20}{:>10}{:>10}{:>10}{:>12}\n", "of pixels above 8",
                                 "pixels", "above 8", "of these", "B minus A");
  const auto percent = [](size_t part, size_t whole) {
    return fmt::format("{:.4g} %", 100 * double(part) / double(std::max<size_t>(whole, 1)));
  };
  for (size_t r = 0; r < sums.size(); ++r) {
    const RegionSum& s = sums[r];
    if (s.pixels == 0) continue;
    text += fmt::format("{:<20}{:>10}{:>10}{:>10}{:>12}\n", kRegionNames[r],
                        percent(s.pixels, regions.size()), percent(s.apart, s.pixels),
                        percent(s.apart, apart),
                        s.apart > 0 ? fmt::format("{:+.1f}", s.change / double(s.apart)) : "");
  }
  if (apart == 0) return text;
  const size_t first = size_t(suspect(sums));
  return text + fmt::format("look first at the {}: {}\n", kRegionNames[first], kCauses[first]);
}

std::expected<std::string, int> explained(const CompareCommand& command, const Image& a,
                                          const Image& b, const WorkControl& control) {
  const auto scene = load_scene(command.explain);
  if (!scene) return std::unexpected(scene.error());
  RenderOptions options = command.options;
  options.width = a.width, options.height = a.height;
  if (const auto why = option_conflict(options, &*scene)) return std::unexpected(fail(*why));
  const RenderSettings settings = resolve_options(options, *scene);
  const auto accel = build_accel(*scene, settings.accel);
  if (!accel) return std::unexpected(fail(accel.error()));
  const std::vector<Region> regions = regions_of(*scene, **accel, settings, control);
  check_stop();
  return explained(a, b, regions);
}

// As displayed: an EXR holds light, with the tone curve and exposure of its render in its settings.
std::expected<Image, Error> displayed(const std::string& path) {
  auto picture = read_picture(path);
  if (!picture) return std::unexpected(std::move(picture.error()));
  if (lower_suffix(path) == ".exr")
    if (const auto settings = read_metadata(path))
      if (const auto o = options_from(*settings, false))  // not for other programs' pictures
        tone_map(picture->color, picture->alpha, o->tone.value_or(Tone::none), o->exposure);
  return std::move(picture->color);
}

int run(const CompareCommand& command, const WorkControl& control) {
  if (!command.diff.empty()) {
    if (const auto format = image_format(command.diff); !format) return fail(format.error());
    if (const auto writable = check_writable(command.diff); !writable)
      return fail(writable.error());
  }
  const auto a = displayed(command.a);
  if (!a) return fail(a.error());
  const auto b = displayed(command.b);
  if (!b) return fail(b.error());
  if (a->width != b->width || a->height != b->height) {
    return bad_input(
        fmt::format("{} is {}x{} and {} is {}x{}; expected two pictures of the same size",
                    command.a, a->width, a->height, command.b, b->width, b->height));
  }

  const ImageDifference difference = compare(*a, *b);
  std::string text = figures(difference);
  if (!command.explain.empty()) {
    const auto where = explained(command, *a, *b, control);
    if (!where) return where.error();
    text += *where;
  }
  if (command.diff == "-") {
    // Standard output has the picture.
    for (const auto line : std::views::split(text.substr(0, text.size() - 1), '\n'))
      print_line(std::string_view(line.begin(), line.end()));
  } else if (const int status = deliver("-", text)) {
    return status;
  }
  if (!command.diff.empty()) {
    const auto written = write_image(difference_image(*a, *b), command.diff);
    if (!written) return fail(written.error());
  }
  if (command.min_psnr_db >= 0 && !(difference.psnr_db >= command.min_psnr_db)) {
    print_error(fmt::format("the PSNR is {}, below the required {:g} dB",
                            decibels(difference.psnr_db), command.min_psnr_db));
    return kCheckFailed;
  }
  return kDone;
}

}  // namespace

int run(const CompareCommand& command) {
  WorkControl control;
  const StopOnSignal stop(&control);
  return Executor(0, &control).run([&] { return run(command, control); });
}

}  // namespace raio::core::app
