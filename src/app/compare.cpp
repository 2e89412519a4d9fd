#include <fmt/format.h>

#include <cmath>
#include <ranges>
#include <string_view>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/image/image.h"

namespace raio::app {

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

}  // namespace

int run(const CompareCommand& command) {
  const StopOnSignal stop;
  if (!command.diff.empty()) {
    if (const auto format = image_format(command.diff); !format) return fail(format.error());
    if (const auto writable = check_writable(command.diff); !writable)
      return fail(writable.error());
  }
  const auto a = read_image(command.a);
  if (!a) return fail(a.error());
  const auto b = read_image(command.b);
  if (!b) return fail(b.error());
  if (a->width != b->width || a->height != b->height) {
    return bad_input(fmt::format("{} is {}x{} and {} is {}x{}: only pictures of one size compare",
                                 command.a, a->width, a->height, command.b, b->width, b->height));
  }

  const ImageDifference difference = compare(*a, *b);
  const std::string text = figures(difference);
  if (command.diff == "-") {
    // Standard output belongs to the picture.
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
    print_error(fmt::format("the PSNR is {}, below the {:g} dB asked for",
                            decibels(difference.psnr_db), command.min_psnr_db));
    return kCheckFailed;
  }
  return kDone;
}

}  // namespace raio::app
