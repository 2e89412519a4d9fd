#include "render/options.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>

#include "base/parallel.h"
#include "integrate/classic.h"
#include "render/figure_options.h"
#include "render/option_text.h"
#include "render/picture_options.h"

namespace raio::core {
namespace {

constexpr std::array<std::string_view, 5> kAccelNames = {"auto", "none", "grid", "bvh", "embree"};
constexpr std::array<std::string_view, 2> kSamplerNames = {"jitter", "sobol"};
constexpr std::array<std::string_view, kViews> kViewNames = {
    "picture", "normals", "depth", "ids", "materials", "steps", "tests", "focus", "samples"};
constexpr std::array<std::string_view, 3> kToneNames = {"none", "srgb", "agx"};
constexpr std::array<std::string_view, 3> kShadingNames = {"nff", "phong", "blinn-phong"};
constexpr std::array<std::string_view, 2> kProjectionNames = {"perspective", "orthographic"};
constexpr std::array<std::string_view, 7> kSideNames = {"front", "back",   "left", "right",
                                                        "top",   "bottom", "iso"};
constexpr std::array<std::string_view, 2> kFitNames = {"all", "most"};
constexpr std::array<std::string_view, 3> kFresnelNames = {"none", "exact", "schlick"};

// Parses "512x512x8" into as many integers as `out` has.
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

// Parses "88mm" or, with a height, "88x66mm"; nothing if it is no length.
std::optional<PrintSize> parse_print(std::string_view text, bool with_height) {
  struct Unit {
    std::string_view name;
    float mm;
  };
  static constexpr Unit kUnits[] = {{"mm", 1}, {"cm", 10}, {"in", 25.4f}, {"pt", 25.4f / 72}};
  constexpr float kMost = 10'000;
  const auto unit =
      std::ranges::find_if(kUnits, [&](const Unit& u) { return text.ends_with(u.name); });
  if (unit == std::end(kUnits)) return std::nullopt;
  text.remove_suffix(unit->name.size());
  const size_t end = std::min(text.find('x'), text.size());
  if (with_height != (end < text.size())) return std::nullopt;
  const auto side = [&](std::string_view number) {
    const float mm = parse_number<float>(number).value_or(-1) * unit->mm;
    return mm >= 0.1f && mm <= kMost ? mm : 0;
  };
  PrintSize print{.width = side(text.substr(0, end))};
  if (with_height) print.height = side(text.substr(end + 1));
  if (print.width == 0 || (with_height && print.height == 0)) return std::nullopt;
  return print;
}

std::expected<void, std::string> parse_size(RenderOptions& o, std::string_view text) {
  if (const auto print = parse_print(text, true))
    return o.print = *print, o.width = o.height = 0, std::expected<void, std::string>();
  std::array<int, 2> size{};
  if (!parse_extents(text, size, kMaxSide))
    return std::unexpected(
        fmt::format("expected a size as WIDTHxHEIGHT in pixels, each 1 to {}, as in 640x480, or in "
                    "print, as in 88x66mm, found '{}'",
                    kMaxSide, text));
  o.width = size[0], o.height = size[1], o.print.reset();
  return {};
}

std::expected<void, std::string> parse_width(RenderOptions& o, std::string_view text) {
  const auto print = parse_print(text, false);
  if (!print)
    return std::unexpected(fmt::format(
        "expected the printed width in mm, cm, in or pt, as in 88mm, found '{}'", text));
  o.print = *print;
  return {};
}

std::expected<void, std::string> parse_accel(RenderOptions& o, std::string_view text) {
  return parse_word<AccelKind>(kAccelNames, text, o.accel.kind);
}

std::expected<void, std::string> parse_sampler(RenderOptions& o, std::string_view text) {
  return parse_word<SamplerKind>(kSamplerNames, text, o.sampler);
}

std::expected<void, std::string> parse_integrator(RenderOptions& o, std::string_view text) {
  return parse_word<IntegratorKind>(kIntegratorNames, text, o.integrator);
}

std::expected<void, std::string> parse_tone(RenderOptions& o, std::string_view text) {
  return parse_word<Tone>(kToneNames, text, o.tone);
}

std::expected<void, std::string> parse_shading(RenderOptions& o, std::string_view text) {
  return parse_word<ShadingModel>(kShadingNames, text, o.shading);
}

std::expected<void, std::string> parse_projection(RenderOptions& o, std::string_view text) {
  return parse_word<Projection>(kProjectionNames, text, o.projection);
}

std::expected<void, std::string> parse_fit(RenderOptions& o, std::string_view text) {
  return parse_word<Fit>(kFitNames, text, o.fit);
}

std::expected<void, std::string> parse_fresnel(RenderOptions& o, std::string_view text) {
  return parse_word<Fresnel>(kFresnelNames, text, o.fresnel);
}

// Zero is a valid value: it switches off the materials' roughness.
template <std::optional<float> RenderOptions::* kNumber>
std::expected<void, std::string> parse_roughness(RenderOptions& o, std::string_view text) {
  constexpr float kMost = 1000;
  const auto value = parse_number<float>(text);
  if (!value || !(*value >= 0 && *value <= kMost))
    return std::unexpected(fmt::format("expected a number from 0 to {}, found '{}'", kMost, text));
  o.*kNumber = value;
  return {};
}

// Parses "0,0.5".
std::expected<void, std::string> parse_shutter(RenderOptions& o, std::string_view text) {
  constexpr float kMost = 1e30f, kNone = std::numeric_limits<float>::quiet_NaN();
  const size_t comma = std::min(text.find(','), text.size());
  const float open = parse_number<float>(text.substr(0, comma)).value_or(kNone);
  const float close =
      parse_number<float>(text.substr(std::min(comma + 1, text.size()))).value_or(kNone);
  if (!(-kMost <= open && open <= close && close <= kMost))
    return std::unexpected(fmt::format(
        "expected two times as T0,T1, the first not after the second, found '{}'", text));
  o.shutter = {open, close};
  return {};
}

// Parses "depth,normal".
std::expected<void, std::string> parse_channels(RenderOptions& o, std::string_view text) {
  ChannelSet channels;
  while (true) {
    const std::string_view name = text.substr(0, text.find(','));
    const auto spec = std::ranges::find(kChannels, name, &ChannelSpec::name);
    if (spec == kChannels.end()) {
      std::string names;
      for (const ChannelSpec& known : kChannels)
        names += fmt::format("{}{}", names.empty() ? "" : ",", known.name);
      return std::unexpected(
          fmt::format("expected some of {}, with commas between them, found '{}'", names, name));
    }
    channels.add(spec->channel);
    if (name.size() == text.size()) break;
    text.remove_prefix(name.size() + 1);
  }
  o.channels = channels;
  return {};
}

std::expected<void, std::string> parse_view(RenderOptions& o, std::string_view text) {
  return parse_word<View>(kViewNames, text, o.view);
}

// Parses "1,2.5,-3".
template <std::optional<Vec3d> RenderOptions::* kVector>
std::expected<void, std::string> parse_vector(RenderOptions& o, std::string_view text) {
  Vec3d v;
  std::string_view rest = text;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t end = axis < 2 ? rest.find(',') : rest.size();
    const auto value = parse_number<double>(rest.substr(0, end));
    if (end == std::string_view::npos || !value || !(std::abs(*value) <= 1e30))
      return std::unexpected(
          fmt::format("expected three numbers as X,Y,Z, as in 2.1,1.3,-1.7, found '{}'", text));
    v[axis] = *value;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  o.*kVector = v;
  return {};
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

// The texts of values parsed above; numbers have the shortest decimals that read back the same.
std::string size_text(const RenderOptions& o) {
  if (o.print && o.print->height > 0)
    return fmt::format("{}x{}mm", o.print->width, o.print->height);
  return o.width > 0 ? fmt::format("{}x{}", o.width, o.height) : "";
}
std::string width_text(const RenderOptions& o) {
  return o.print && o.print->height == 0 ? fmt::format("{}mm", o.print->width) : "";
}
std::string accel_text(const RenderOptions& o) { return std::string(accel_name(o.accel.kind)); }
std::string sampler_text(const RenderOptions& o) {
  return o.sampler ? std::string(sampler_name(*o.sampler)) : "";
}
std::string integrator_text(const RenderOptions& o) {
  return o.integrator ? std::string(kIntegratorNames[size_t(*o.integrator)]) : "";
}
std::string tone_text(const RenderOptions& o) {
  return o.tone ? std::string(kToneNames[size_t(*o.tone)]) : "";
}
std::string shading_text(const RenderOptions& o) {
  return o.shading ? std::string(shading_name(*o.shading)) : "";
}
std::string shutter_text(const RenderOptions& o) {
  return o.shutter ? fmt::format("{},{}", (*o.shutter)[0], (*o.shutter)[1]) : "";
}
std::string projection_text(const RenderOptions& o) {
  return o.projection ? std::string(projection_name(*o.projection)) : "";
}
std::string fit_text(const RenderOptions& o) {
  return o.fit ? std::string(kFitNames[size_t(*o.fit)]) : "";
}
std::string fresnel_text(const RenderOptions& o) {
  return o.fresnel ? std::string(fresnel_name(*o.fresnel)) : "";
}
template <std::optional<float> RenderOptions::* kNumber>
std::string roughness_text(const RenderOptions& o) {
  return o.*kNumber ? fmt::format("{}", *(o.*kNumber)) : "";
}
std::string channels_text(const RenderOptions& o) {
  std::string text;
  for (const ChannelSpec& spec : kChannels)
    if (o.channels.has(spec.channel))
      text += fmt::format("{}{}", text.empty() ? "" : ",", spec.name);
  return text;
}
std::string view_text(const RenderOptions& o) {
  return o.view == View::picture ? "" : std::string(view_name(o.view));
}
std::string resolution_text(const RenderOptions& o) {
  const auto& n = o.accel.grid_resolution;
  return n[0] > 0 ? fmt::format("{}x{}x{}", n[0], n[1], n[2]) : "";
}
std::string seed_text(const RenderOptions& o) { return fmt::format("{}", o.seed); }
template <std::optional<Vec3d> RenderOptions::* kVector>
std::string vector_text(const RenderOptions& o) {
  const auto& v = o.*kVector;
  return v ? fmt::format("{},{},{}", v->x, v->y, v->z) : "";
}

std::expected<void, std::string> parse_from(RenderOptions& o, std::string_view text) {
  const auto side = std::ranges::find(kSideNames, text);
  if (side != kSideNames.end()) {
    o.side = Side(side - kSideNames.begin()), o.from.reset();
    return {};
  }
  const auto parsed = parse_vector<&RenderOptions::from>(o, text);
  if (!parsed)
    return std::unexpected(fmt::format(
        "expected three numbers as X,Y,Z, or front, back, left, right, top, bottom or iso, "
        "found '{}'",
        text));
  o.side.reset();
  return {};
}
std::string from_text(const RenderOptions& o) {
  return o.side ? std::string(kSideNames[size_t(*o.side)]) : vector_text<&RenderOptions::from>(o);
}

std::expected<void, std::string> parse_up(RenderOptions& o, std::string_view text) {
  const bool is_negative = text.starts_with('-');
  const std::string_view axis = text.substr(is_negative || text.starts_with('+') ? 1 : 0);
  if (axis == "x" || axis == "y" || axis == "z") {
    Vec3d up;
    up[axis[0] - 'x'] = is_negative ? -1 : 1;
    o.up = up;
    return {};
  }
  if (!parse_vector<&RenderOptions::up>(o, text))
    return std::unexpected(
        fmt::format("expected x, -x, y, -y, z, -z or three numbers as X,Y,Z, found '{}'", text));
  return {};
}

using Options = RenderOptions;
using enum OptionGroup;
constexpr auto kTable = std::to_array<OptionSpec>({
    {output, "size", "WxH",
     "Width and height in pixels; or in print, as in 88x66mm, at `dpi` (default: the scene's, else "
     "512x512)",
     parse_size, 0, 0, size_text},
    {output,
     "width",
     "LENGTH",
     "Width of the printed picture, as in 88mm, 8.8cm, 3.5in or 250pt, at `dpi`; the height "
     "follows from the scene's aspect ratio",
     parse_width,
     0,
     0,
     width_text,
     {},
     true,
     false},
    {output,
     "dpi",
     "N",
     "Pixels per inch in print, stored in .png and .exr; outlines and text keep the printed size "
     "that they have at 96 (default: 300 with `width` or a printed `size`)",
     +[](Options& o) -> float& { return o.dpi; },
     10,
     10000,
     nullptr,
     {},
     true,
     false},
    {output,
     "crop",
     "X0,Y0,X1,Y1",
     "Render only columns X0 to X1-1 and rows Y0 to Y1-1, counted from the upper left; the pixels "
     "equal those of the whole picture (default: all)",
     parse_crop,
     0,
     0,
     crop_text,
     {},
     true,
     false},
    {camera, "from", "PLACE",
     "Camera position X,Y,Z in the file's coordinates; or a side that shows the whole scene: "
     "front, back, left, right, top, bottom or iso (default: the scene's)",
     parse_from, 0, 0, from_text},
    {camera, "at", "X,Y,Z", "Point the camera looks at (default: the scene's)",
     parse_vector<&Options::at>, 0, 0, vector_text<&Options::at>},
    {camera, "up", "AXIS",
     "Up direction of the camera: X,Y,Z or x, -x, y, -y, z or -z; a camera fitted to data is "
     "fitted again unless `from` or `at` gives a point (default: the scene's; with a side, the "
     "axis nearest to it)",
     parse_up, 0, 0, vector_text<&Options::up>},
    {camera, "fit", "NAME",
     "Move the camera without turning it: all shows the whole scene, most ignores ground planes "
     "and stray atoms (default: the scene's camera; all for data without one)",
     parse_fit, 0, 0, fit_text, kFitNames},
    {camera, "fov", "DEG", "Vertical field of view in degrees (default: the scene's)",
     +[](Options& o) -> float& { return o.fov_deg; }, 0.001, 179},
    {camera, "projection", "NAME",
     "Eye rays from one point (perspective) or parallel (orthographic); both show the same size at "
     "the distance of the point looked at (default: the scene's)",
     parse_projection, 0, 0, projection_text, kProjectionNames},
    {effects, "integrator", "NAME", kIntegratorHelp, parse_integrator, 0, 0, integrator_text,
     kIntegratorNames},
    {diagnostics, "view", "NAME",
     "Show normals, depth, ids, materials, traversal steps, intersection tests, focus or samples "
     "instead of the picture (default: picture)",
     parse_view, 0, 0, view_text, kViewNames},
    {output, "channels", "LIST",
     "Also store these channels (AOVs): alpha, depth, position, normal, albedo, id, object, "
     "samples, variance, steps, tests; .exr and .npz store all, .png only alpha",
     parse_channels, 0, 0, channels_text},
    {output, "background", "COLOR|FOLDER",
     "Colour behind the scene: a name such as white, '#rrggbb' or R,G,B with 1 for white; or "
     "transparent, which stores alpha; or a folder with the six pictures of a sky: right, left, "
     "top, bottom, front and back as .jpg or .png (default: the scene's; for figures the look's)",
     parse_background, 0, 0, background_text},
    {output, "exposure", "EV",
     "Multiply the colours of .png and .ppm by 2 to the power of EV; other formats keep the "
     "computed values (default: 0)",
     +[](Options& o) -> float& { return o.exposure; }, -100, 100},
    {output, "tone", "NAME",
     "Tone curve of .png and .ppm: none keeps the values, srgb encodes for displays, agx also "
     "compresses highlights (default: none; srgb for figures)",
     parse_tone, 0, 0, tone_text, kToneNames},
    {diagnostics, "accel", "NAME",
     "Acceleration structure: none (brute force), grid, bvh, embree, or auto, which is the "
     "scene's, else bvh (default: auto)",
     parse_accel, 0, 0, accel_text, kAccelNames},
    {diagnostics, "grid-factor", "M",
     "Resolution of the uniform grid: M times the cube root of the number of primitives, in cells "
     "per side (default: 0.3; one cell for up to 32 primitives)",
     +[](Options& o) -> float& { return o.accel.grid_factor; }, 0.01, 100},
    {diagnostics, "grid-resolution", "XxYxZ",
     "Exact number of cells of the uniform grid; replaces `grid-factor`", parse_resolution, 0, 0,
     resolution_text},
    {sampling, "aa", "N",
     "Antialiasing with N x N jittered samples per pixel; 1 is one ray through the centre "
     "(default: the scene's, else 1; figures have 64 samples)",
     +[](Options& o) -> int& { return o.aa; }, 1, 256},
    {effects, "soft-shadows", "",
     "Soft shadows; lights become squares that face the point looked at",
     +[](Options& o) -> bool& { return o.soft_shadows; }},
    {effects, "light-size", "S",
     "Side of the square lights of `soft-shadows`, in scene units (default: a tenth of the light's "
     "distance to the point looked at)",
     +[](Options& o) -> float& { return o.light_size; }, 1e-30, 1e30},
    {effects, "dof", "",
     "Depth of field; a thin lens replaces the pinhole (default: on if the scene has a lens)",
     +[](Options& o) -> std::optional<bool>& { return o.dof; }},
    {effects, "aperture", "R",
     "Lens radius for `dof`, in scene units (default: the scene's, else a fiftieth of the focus "
     "distance)",
     +[](Options& o) -> float& { return o.aperture; }, 1e-30, 1e30},
    {effects, "focus", "D",
     "Distance to the plane in focus for `dof`, in scene units (default: the scene's, else the "
     "distance to the point looked at)",
     +[](Options& o) -> float& { return o.focus; }, 1e-30, 1e30},
    {sampling, "lens-samples", "K",
     "Rays per cell of a pixel, stratified over the lens and the lights (default: 1)",
     +[](Options& o) -> int& { return o.lens_samples; }, 1, 65536},
    {sampling, "samples", "N",
     "N samples per pixel over its whole area (through its centre with `aa` 1); implies `sampler` "
     "sobol, replaces `aa` and `lens-samples`",
     +[](Options& o) -> int& { return o.samples; }, 1, kMaxSamples},
    {sampling, "sampler", "NAME",
     "Sampling pattern: jitter, random points in equal cells; or sobol, a scrambled Sobol "
     "sequence, well distributed after any number of samples (default: jitter; sobol with "
     "`samples`)",
     parse_sampler, 0, 0, sampler_text, kSamplerNames},
    {effects, "depth", "N", "Maximum ray depth; the eye ray is level 1 (default: 5)",
     +[](Options& o) -> int& { return o.depth; }, 1, kMaxDepth},
    {effects, "no-reflection", "", "Trace no reflected rays; highlights of the lights stay",
     +[](Options& o) -> bool& { return o.no_reflection; }},
    {effects, "no-refraction", "", "Trace no refracted rays; transparent surfaces become opaque",
     +[](Options& o) -> bool& { return o.no_refraction; }},
    {effects, "shading", "NAME",
     "Shading model: nff; or phong or blinn-phong, which have no ambient light (default: nff; "
     "blinn-phong for P3F scenes)",
     parse_shading, 0, 0, shading_text, kShadingNames},
    {effects, "fresnel", "NAME",
     "Split of light between reflection and refraction where T is above 0: none uses Ks and T, "
     "exact Fresnel's equations, schlick Schlick's approximation (default: none; schlick for P3F "
     "scenes)",
     parse_fresnel, 0, 0, fresnel_text, kFresnelNames},
    {effects, "gloss", "R",
     "Roughness of mirrors: 0 is perfect, 0.1 brushed metal (default: each material's)",
     parse_roughness<&Options::gloss>, 0, 0, roughness_text<&Options::gloss>},
    {effects, "translucency", "R",
     "Roughness of refraction: 0 is clear glass (default: each material's)",
     parse_roughness<&Options::translucency>, 0, 0, roughness_text<&Options::translucency>},
    {effects, "shutter", "T0,T1",
     "Motion blur: the shutter is open from time T0 to T1; equal times show one moment (default: "
     "the whole movement)",
     parse_shutter, 0, 0, shutter_text},
    {figures, "opacity", "A",
     "Opacity of everything without its own: 0 is invisible, 1 opaque (default: 1)", parse_opacity,
     0, 0, opacity_text},
    {figures, "look", "NAME",
     "Look of figures: paper, soft light on white; dark; flat, outlines without a key light; or "
     "matte; a number fixes the version, as in paper-1 (default: paper)",
     parse_look, 0, 0, look_text, kLooks},
    {figures, "occlusion-rays", "N",
     "Rays to the sky from each surface point, with `integrator` ambient (default: 2)",
     +[](Options& o) -> int& { return o.occlusion_rays; }, 1, 4096},
    {figures, "occlusion-distance", "D",
     "Surfaces farther away than D scene units hide no sky, with `integrator` ambient (default: "
     "any distance)",
     +[](Options& o) -> float& { return o.occlusion_distance; }, 1e-30, 1e30},
    {figures, "key-light", "on|off",
     "Light over the viewer's left shoulder, with soft shadows, with `integrator` ambient "
     "(default: on)",
     parse_key_light, 0, 0, key_light_text, kOnOff},
    {figures, "outline", "W",
     "Outlines W pixels wide where depth jumps, faces meet or objects end, with `integrator` "
     "ambient; 0 for none (default: the look's)",
     parse_outline, 0, 0, outline_text},
    {figures, "depth-cue", "X",
     "Fade into the background with distance, with `integrator` ambient: the farthest point fades "
     "by X, from 0 to 1 (default: the look's)",
     parse_depth_cue, 0, 0, depth_cue_text},
    {figures, "shadow-catcher", "",
     "Cast shadows on the background, as on a floor, with `integrator` ambient",
     +[](Options& o) -> bool& { return o.shadow_catcher; }},
    {effects, "one-sided", "", "Cull back faces of opaque surfaces, as the NFF specification says",
     +[](Options& o) -> bool& { return o.one_sided; }},
    {camera, "angle-to-centers", "",
     "Measure the field of view between the centres of the outermost pixels, as the NFF "
     "specification says, not between their edges",
     +[](Options& o) -> bool& { return o.angle_to_centers; }},
    {diagnostics,
     "threads",
     "N",
     "Number of threads, from reading to writing; the picture does not depend on it (default: "
     "one per core that the machine or its container grants)",
     +[](Options& o) -> int& { return o.threads; },
     1,
     4096,
     nullptr,
     {},
     false},
    {sampling, "seed", "N", "Seed of the random numbers (default: 0)", parse_seed, 0, 0, seed_text},
    {diagnostics,
     "counters",
     "",
     "Count intersection tests and traversal steps for the statistics; costs some time",
     +[](Options& o) -> bool& { return o.accel.counters; },
     0,
     0,
     nullptr,
     {},
     false},
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

std::string shell_word(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+,=:@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos)
    return std::string(word);
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::span<const OptionSpec> render_option_table() { return kTable; }

std::string_view accel_name(AccelKind kind) { return kAccelNames[size_t(kind)]; }
std::string_view sampler_name(SamplerKind kind) { return kSamplerNames[size_t(kind)]; }
std::string_view shading_name(ShadingModel model) { return kShadingNames[size_t(model)]; }
std::string_view fresnel_name(Fresnel fresnel) { return kFresnelNames[size_t(fresnel)]; }
std::string_view view_name(View view) { return kViewNames[size_t(view)]; }
std::string_view projection_name(Projection projection) {
  return kProjectionNames[size_t(projection)];
}

std::expected<void, Error> set_option(RenderOptions& options, const OptionSpec& spec,
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
  if (auto set = std::visit(Set{options, spec, text}, spec.value); !set)
    return std::unexpected(bad_option(spec.name, std::move(set.error())));
  return {};
}

std::string option_text(const RenderOptions& options, const OptionSpec& spec) {
  RenderOptions o = options;  // a copy that the table's functions may change
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
    // With the shortest decimals that read back the same.
    std::string operator()(float& (*value)(RenderOptions&)) {
      return value(o) == 0 ? "" : fmt::format("{}", value(o));
    }
    std::string operator()(OptionSpec::Parse) const { return spec.text(o); }
  };
  return std::visit(Text{o, spec}, spec.value);
}

std::string option_argument(std::string_view name, bool is_switch, std::string_view text) {
  return is_switch ? fmt::format(" --{}{}", text == "false" ? "no-" : "", name)
                   : fmt::format(" --{} {}", name, shell_word(text));
}

std::string option_arguments(const RenderOptions& options) {
  const RenderOptions usual;
  std::string out;
  for (const OptionSpec& spec : kTable) {
    const std::string text = option_text(options, spec);
    if (text == option_text(usual, spec)) continue;
    out += option_argument(spec.name, spec.is_switch(), text);
  }
  return out;
}

}  // namespace raio::core
