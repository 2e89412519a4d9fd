#include "render/options.h"

#include <fmt/core.h>
#include <tbb/task_arena.h>

#include <array>
#include <charconv>
#include <cmath>

namespace raio {
namespace {

constexpr std::array<std::string_view, 5> kAccelNames = {"auto", "none", "grid", "bvh", "embree"};
constexpr std::array<std::string_view, 2> kSamplerNames = {"jitter", "sobol"};
constexpr int kMaxSide = 1 << 20;

template <class T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// "512x512x8" into as many whole numbers as `out` holds.
bool parse_extents(std::string_view text, std::span<int> out, int most) {
  for (size_t i = 0; i < out.size(); ++i) {
    const size_t end = i + 1 < out.size() ? text.find('x') : text.size();
    if (end == std::string_view::npos) return false;
    const auto value = parse_number<int>(text.substr(0, end));
    if (!value || *value < 1 || *value > most) return false;
    out[i] = *value;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return text.empty();
}

std::expected<void, std::string> parse_size(RenderOptions& o, std::string_view text) {
  std::array<int, 2> size{};
  if (!parse_extents(text, size, kMaxSide))
    return std::unexpected(fmt::format(
        "expected a size as WIDTHxHEIGHT in pixels, each 1 to {}, as in 640x480, found '{}'",
        kMaxSide, text));
  o.width = size[0], o.height = size[1];
  return {};
}

std::expected<void, std::string> parse_accel(RenderOptions& o, std::string_view text) {
  for (size_t i = 0; i < kAccelNames.size(); ++i)
    if (kAccelNames[i] == text)
      return o.accel.kind = AccelKind(i), std::expected<void, std::string>();
  return std::unexpected(fmt::format("expected auto, none, grid, bvh or embree, found '{}'", text));
}

std::expected<void, std::string> parse_sampler(RenderOptions& o, std::string_view text) {
  for (size_t i = 0; i < kSamplerNames.size(); ++i)
    if (kSamplerNames[i] == text)
      return o.sampler = SamplerKind(i), std::expected<void, std::string>();
  return std::unexpected(fmt::format("expected jitter or sobol, found '{}'", text));
}

std::expected<void, std::string> parse_resolution(RenderOptions& o, std::string_view text) {
  std::array<int, 3> n{};
  if (!parse_extents(text, n, kMaxSide))
    return std::unexpected(fmt::format(
        "expected cells as XxYxZ, each 1 to {}, as in 64x64x16, found '{}'", kMaxSide, text));
  o.accel.grid_resolution = n;
  return {};
}

std::expected<void, std::string> parse_seed(RenderOptions& o, std::string_view text) {
  const auto seed = parse_number<uint32_t>(text);
  if (!seed)
    return std::unexpected(
        fmt::format("expected a whole number from 0 to 4294967295, found '{}'", text));
  o.seed = *seed;
  return {};
}

// The texts of what the functions above parse.
std::string size_text(const RenderOptions& o) {
  return o.width > 0 ? fmt::format("{}x{}", o.width, o.height) : "";
}
std::string accel_text(const RenderOptions& o) { return std::string(accel_name(o.accel.kind)); }
std::string sampler_text(const RenderOptions& o) {
  return o.sampler ? std::string(sampler_name(*o.sampler)) : "";
}
std::string resolution_text(const RenderOptions& o) {
  const auto& n = o.accel.grid_resolution;
  return n[0] > 0 ? fmt::format("{}x{}x{}", n[0], n[1], n[2]) : "";
}
std::string seed_text(const RenderOptions& o) { return fmt::format("{}", o.seed); }

using Options = RenderOptions;
constexpr auto kTable = std::to_array<OptionSpec>({
    {"size", "WxH", "Pixels of the picture (default: the scene's resolution, else 512x512)",
     parse_size, 0, 0, size_text},
    {"accel", "NAME",
     "Structure that finds the hits: auto, none, grid, bvh or embree (default: auto)", parse_accel,
     0, 0, accel_text},
    {"grid-factor", "M",
     "Fineness of the uniform grid: its cells a side are M times the cube root of the number of "
     "primitives (default: 2)",
     +[](Options& o) -> float& { return o.accel.grid_factor; }, 0.01, 100},
    {"grid-resolution", "XxYxZ",
     "Exact number of cells of the uniform grid, instead of --grid-factor", parse_resolution, 0, 0,
     resolution_text},
    {"aa", "N",
     "Antialiasing: N x N jittered cells a pixel; 1 is one ray through the centre "
     "(default: the scene's wish, else 1)",
     +[](Options& o) -> int& { return o.aa; }, 1, 256},
    {"soft-shadows", "", "Lights are squares that face the point looked at, not points",
     +[](Options& o) -> bool& { return o.soft_shadows; }},
    {"light-size", "S",
     "Side of the squares of --soft-shadows, in scene units (default: a tenth of the light's "
     "distance to the point looked at)",
     +[](Options& o) -> float& { return o.light_size; }, 1e-30, 1e30},
    {"dof", "",
     "Depth of field: a thin lens instead of a pinhole (default: if the scene has a lens)",
     +[](Options& o) -> std::optional<bool>& { return o.dof; }},
    {"aperture", "R",
     "Radius of the lens of --dof, in scene units (default: the scene's, else a fiftieth of the "
     "focus distance)",
     +[](Options& o) -> float& { return o.aperture; }, 1e-30, 1e30},
    {"focus", "D",
     "Distance of the plane in focus with --dof, in scene units (default: the scene's, else that "
     "of the point looked at)",
     +[](Options& o) -> float& { return o.focus; }, 1e-30, 1e30},
    {"lens-samples", "K",
     "Rays for each cell of a pixel, which share out the lens and the lights (default: 1)",
     +[](Options& o) -> int& { return o.lens_samples; }, 1, 65536},
    {"samples", "N",
     "Samples a pixel, any number, over all of it (or its centre with --aa 1); with --sampler "
     "sobol, instead of --aa and --lens-samples",
     +[](Options& o) -> int& { return o.samples; }, 1, kMaxSamples},
    {"sampler", "NAME",
     "Where the samples go: jitter, random points in equal cells, or sobol, a scrambled Sobol "
     "sequence, even after any number of samples (default: jitter; sobol with --samples)",
     parse_sampler, 0, 0, sampler_text},
    {"depth", "N", "Levels of rays; the eye ray is level 1 (default: 5)",
     +[](Options& o) -> int& { return o.depth; }, 1, kMaxDepth},
    {"one-sided", "", "Opaque surfaces are seen from outside only, as the NFF text has it",
     +[](Options& o) -> bool& { return o.one_sided; }},
    {"angle-to-centers", "",
     "The angle of view lies between the centres of the outermost pixels, as the NFF text has it, "
     "not between their edges",
     +[](Options& o) -> bool& { return o.angle_to_centers; }},
    {"threads", "N", "Threads; the picture is the same for any number (default: one a core)",
     +[](Options& o) -> int& { return o.threads; }, 1, 4096, nullptr, false},
    {"seed", "N", "Chooses the random points of all effects (default: 0)", parse_seed, 0, 0,
     seed_text},
    {"counters", "", "Count tests and steps for --stats; costs some time",
     +[](Options& o) -> bool& { return o.accel.counters; }, 0, 0, nullptr, false},
});

template <class T>
std::expected<void, std::string> set_number(T& out, const OptionSpec& spec, std::string_view text) {
  const auto value = parse_number<T>(text);
  if (!value || !(*value >= T(spec.least) && *value <= T(spec.most)))
    return std::unexpected(fmt::format("expected a {} from {} to {}, found '{}'",
                                       std::is_integral_v<T> ? "whole number" : "number",
                                       spec.least, spec.most, text));
  out = *value;
  return {};
}

}  // namespace

std::span<const OptionSpec> render_option_table() { return kTable; }

std::string_view accel_name(AccelKind kind) { return kAccelNames[size_t(kind)]; }
std::string_view sampler_name(SamplerKind kind) { return kSamplerNames[size_t(kind)]; }

std::expected<void, std::string> set_option(RenderOptions& options, const OptionSpec& spec,
                                            std::string_view text) {
  struct Set {
    RenderOptions& options;
    const OptionSpec& spec;
    std::string_view text;
    using Result = std::expected<void, std::string>;

    Result operator()(bool& (*value)(RenderOptions&)) {
      return value(options) = text == "true", Result();
    }
    Result operator()(std::optional<bool>& (*value)(RenderOptions&)) {
      return value(options) = text == "true", Result();
    }
    Result operator()(int& (*value)(RenderOptions&)) {
      return set_number(value(options), spec, text);
    }
    Result operator()(float& (*value)(RenderOptions&)) {
      return set_number(value(options), spec, text);
    }
    Result operator()(OptionSpec::Parse parse) { return parse(options, text); }
  };
  return std::visit(Set{options, spec, text}, spec.value);
}

std::string option_text(const RenderOptions& options, const OptionSpec& spec) {
  RenderOptions o = options;  // which the table's functions may change
  struct Text {
    RenderOptions& o;
    const OptionSpec& spec;

    std::string operator()(bool& (*value)(RenderOptions&)) { return value(o) ? "true" : ""; }
    std::string operator()(std::optional<bool>& (*value)(RenderOptions&)) {
      return value(o) ? *value(o) ? "true" : "false" : "";
    }
    std::string operator()(int& (*value)(RenderOptions&)) {
      return value(o) == 0 ? "" : fmt::format("{}", value(o));
    }
    // With as many digits as read back to the same number.
    std::string operator()(float& (*value)(RenderOptions&)) {
      return value(o) == 0 ? "" : fmt::format("{}", value(o));
    }
    std::string operator()(OptionSpec::Parse) const { return spec.text(o); }
  };
  return std::visit(Text{o, spec}, spec.value);
}

std::string option_conflict(const RenderOptions& options, const Scene* scene) {
  const AccelOptions& accel = options.accel;
  const bool resolution = accel.grid_resolution[0] > 0, factor = accel.grid_factor > 0;
  const bool grid = accel.kind == AccelKind::automatic || accel.kind == AccelKind::grid;
  if (resolution && factor)
    return "--grid-factor has no effect beside --grid-resolution; give one of them";
  if ((resolution || factor) && !grid)
    return fmt::format("--{} has no effect with --accel {}; leave one of them out",
                       resolution ? "grid-resolution" : "grid-factor", accel_name(accel.kind));
  if (accel.counters && accel.kind == AccelKind::embree)
    return "Embree does not count tests and steps; leave out --counters or --accel embree";

  const auto without = [](std::string_view option, std::string_view other) {
    return fmt::format("{0} has no effect without {1}; add {1} or leave {0} out", option, other);
  };
  if (options.samples > 0) {
    const std::string_view beside = options.aa > 1             ? "aa"
                                    : options.lens_samples > 0 ? "lens-samples"
                                                               : "";
    if (!beside.empty())
      return fmt::format("--{} has no effect beside --samples; give one of them", beside);
    if (options.sampler == SamplerKind::jitter)
      return "--sampler jitter takes --aa and --lens-samples, which say its cells; leave out "
             "--samples or --sampler jitter";
  }
  if (options.light_size > 0 && !options.soft_shadows)
    return without("--light-size", "--soft-shadows");
  if (!scene && !options.dof) return {};
  const RenderOptions o = scene ? resolve_options(options, *scene) : options;
  if (!*o.dof && options.aperture > 0) return without("--aperture", "--dof");
  if (!*o.dof && options.focus > 0) return without("--focus", "--dof");
  if (!scene) return {};
  if (o.samples > 1 && !*o.dof && !o.soft_shadows && o.aa == 1)
    return "--samples has no effect with --aa 1 alone; add --dof or --soft-shadows, or leave one "
           "of them out";
  if (o.lens_samples > 1 && !*o.dof && !o.soft_shadows && o.aa == 1)
    return "--lens-samples has no effect without --dof, --soft-shadows or --aa; add one of them or "
           "leave --lens-samples out";
  if (const double samples = double(o.aa) * o.aa * o.lens_samples; samples > kMaxSamples)
    return fmt::format("{:.0f} samples a pixel are too many, {} the most; choose a smaller --aa{}",
                       samples, kMaxSamples, o.lens_samples > 1 ? " or --lens-samples" : "");
  return {};
}

RenderOptions resolve_options(const RenderOptions& options, const Scene& scene) {
  const Camera& camera = scene.camera;
  RenderOptions o = options;
  const bool asks_for_grid = o.accel.grid_factor > 0 || o.accel.grid_resolution[0] > 0;
  if (o.accel.kind == AccelKind::automatic && asks_for_grid) o.accel.kind = AccelKind::grid;
  if (o.width == 0) {
    o.width = camera.width > 0 ? camera.width : 512;
    o.height = camera.height > 0 ? camera.height : 512;
  }
  if (o.samples > 0) o.sampler = SamplerKind::sobol;
  if (!o.sampler) o.sampler = SamplerKind::jitter;
  if (o.aa == 0 && o.samples == 0)
    o.aa = std::max(1, int(std::lround(std::sqrt(double(scene.samples_per_pixel)))));
  if (o.lens_samples == 0 && o.samples == 0) o.lens_samples = 1;
  if (!o.dof) o.dof = camera.lens_radius.value_or(0) > 0;
  if (o.focus == 0) o.focus = camera.focus_distance.value_or(length(camera.at - camera.from));
  if (o.aperture == 0) o.aperture = camera.lens_radius.value_or(o.focus / 50);
  if (o.threads == 0) o.threads = tbb::this_task_arena::max_concurrency();
  return o;
}

}  // namespace raio
