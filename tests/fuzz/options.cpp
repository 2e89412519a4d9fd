// Values of the command line: lines "NAME VALUE", as --NAME VALUE. Accepted values are within the
// table's limits, and accepted combinations can be resolved.
#include "render/options.h"

#include <string_view>

#include "require.h"

namespace raio::core::fuzz {
namespace {

void set(RenderOptions& options, std::string_view line) {
  const size_t space = std::min(line.find(' '), line.size());
  const std::string_view name = line.substr(0, space);
  line.remove_prefix(std::min(space + 1, line.size()));
  for (const OptionSpec& spec : render_option_table())
    if (spec.name == name) {
      const auto done = set_option(options, spec, spec.is_switch() ? "true" : line);
      require(done || !done.error().message.empty(), "an error has a reason");
    }
}

bool within(double value, double least, double most) {
  return value == 0 || (value >= least && value <= most);
}

}  // namespace
}  // namespace raio::core::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raio::core;
  using fuzz::within;
  std::string_view text(reinterpret_cast<const char*>(data), size);
  RenderOptions options;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    fuzz::set(options, text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  const Scene scene;
  (void)option_conflict(options);
  if (option_conflict(options, &scene)) return 0;
  const RenderSettings o = resolve_options(options, scene);
  fuzz::require(o.width > 0 && o.height > 0 && o.samples_per_pixel() > 0 && o.threads > 0 &&
                    o.focus > 0 && o.aperture > 0 && o.depth > 0 && o.depth <= kMaxDepth,
                "what is resolved can be rendered");
  const Crop frame = o.frame();
  fuzz::require(frame.x0 >= 0 && frame.y0 >= 0 && frame.width() > 0 && frame.height() > 0 &&
                    frame.x1 <= o.width && frame.y1 <= o.height,
                "what is rendered lies in the picture");
  fuzz::require(double(o.aa) * o.aa * o.lens_samples <= kMaxSamples, "the samples can be numbered");
  fuzz::require(within(o.accel.grid_factor, 0.01, 100) && within(o.light_size, 1e-31, 1e31),
                "numbers lie where the table says");
  return 0;
}
