#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <expected>
#include <ranges>
#include <string_view>
#include <vector>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/file.h"
#include "io/image/image.h"
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

std::string explained(const Image& a, const Image& b, const std::vector<Region>& regions) {
  const RegionDifferences found = differences(a, b, regions);
  std::string text = fmt::format("\n{:<20}{:>10}{:>10}{:>10}{:>12}\n", "of pixels above 8",
                                 "pixels", "above 8", "of these", "B minus A");
  size_t apart = 0;
  for (const RegionDifference& d : found) apart += d.apart;
  const auto percent = [](size_t part, size_t whole) {
    return fmt::format("{:.4g} %", 100 * double(part) / double(std::max<size_t>(whole, 1)));
  };
  for (size_t r = 0; r < found.size(); ++r) {
    const RegionDifference& d = found[r];
    if (d.pixels == 0) continue;
    text += fmt::format("{:<20}{:>10}{:>10}{:>10}{:>12}\n", kRegionNames[r],
                        percent(d.pixels, regions.size()), percent(d.apart, d.pixels),
                        percent(d.apart, apart), d.apart > 0 ? fmt::format("{:+.1f}", d.mean) : "");
  }
  const auto first = suspect(found);
  if (!first) return text;
  return text + fmt::format("look first at the {}: {}\n", kRegionNames[size_t(*first)],
                            likely_cause(*first));
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

int run(const CompareCommand& command, const WorkControl& control) {
  if (!command.diff.empty()) {
    if (const auto format = image_format(command.diff); !format) return fail(format.error());
    if (const auto writable = check_writable(command.diff); !writable)
      return fail(writable.error());
  }
  const auto a = read_displayed(command.a);
  if (!a) return fail(a.error());
  const auto b = read_displayed(command.b);
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
