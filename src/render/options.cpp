#include "render/options.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>

#include "render/figure_options.h"
#include "render/picture_options.h"

namespace raio::core {
namespace {

using Options = RenderOptions;
using Set = std::expected<void, std::string>;

constexpr std::array<std::string_view, 5> kAccelNames = {"auto", "none", "grid", "bvh", "embree"};
constexpr std::array<std::string_view, 2> kSamplerNames = {"jitter", "sobol"};
constexpr std::array<std::string_view, 2> kFilterNames = {"box", "blackman-harris"};
constexpr std::array<std::string_view, kViews> kViewNames = {
    "picture", "normals", "depth", "ids", "materials", "steps", "tests", "focus", "samples"};
constexpr std::array<std::string_view, 4> kToneNames = {"none", "srgb", "agx", "neutral"};
constexpr std::array<std::string_view, 4> kDenoiserNames = {"none", "auto", "oidn", "raio"};
constexpr std::array<std::string_view, 1> kExposureNames = {"auto"};
constexpr std::array<std::string_view, 3> kShadingNames = {"nff", "phong", "blinn-phong"};
constexpr std::array<std::string_view, 3> kProjectionNames = {"perspective", "orthographic",
                                                              "omnidirectional"};
constexpr std::array<std::string_view, 7> kSideNames = {"front", "back",   "left", "right",
                                                        "top",   "bottom", "iso"};
constexpr std::array<std::string_view, 2> kFitNames = {"all", "most"};
constexpr std::array<std::string_view, 3> kFresnelNames = {"none", "exact", "schlick"};

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

Set set_size(Options& o, const OptionSpec&, std::string_view text) {
  const bool has_width = o.print && o.print->height == 0;  // by `width`, which excludes pixels
  if (const auto print = parse_print(text, true))
    return o.print = *print, o.width = o.height = 0, Set();
  std::array<int, 2> size{};
  if (!parse_list(text, 'x', size) || std::ranges::min(size) < 1 ||
      std::ranges::max(size) > kMaxSide)
    return expected_but(
        fmt::format("a size as WIDTHxHEIGHT in pixels, each 1 to {}, as in 640x480, or in print, "
                    "as in 88x66mm",
                    kMaxSide),
        text);
  o.width = size[0], o.height = size[1];
  if (!has_width) o.print.reset();
  return {};
}

std::string size_text(const Options& o, const OptionSpec&) {
  if (o.print && o.print->height > 0)
    return fmt::format("{}x{}mm", o.print->width, o.print->height);
  return o.width > 0 ? fmt::format("{}x{}", o.width, o.height) : "";
}

Set set_width(Options& o, const OptionSpec&, std::string_view text) {
  const auto print = parse_print(text, false);
  if (!print) return expected_but("the printed width in mm, cm, in or pt, as in 88mm", text);
  o.print = *print;
  return {};
}

std::string width_text(const Options& o, const OptionSpec&) {
  return o.print && o.print->height == 0 ? fmt::format("{}mm", o.print->width) : "";
}

constexpr OptionValue<Options> kShutter = kMember<Options, &Options::shutter>;

Set set_shutter(Options& o, const OptionSpec& spec, std::string_view text) {
  Options asked;
  if (!kShutter.set(asked, spec, text) || (*asked.shutter)[0] > (*asked.shutter)[1])
    return expected_but("two times as T0,T1, the first not after the second", text);
  o.shutter = asked.shutter;
  return {};
}

// Parses "depth,normal".
Set set_channels(Options& o, const OptionSpec&, std::string_view text) {
  ChannelSet channels;
  while (true) {
    const std::string_view name = text.substr(0, text.find(','));
    const auto spec = std::ranges::find(kChannels, name, &ChannelSpec::name);
    if (spec == kChannels.end()) {
      std::string names;
      for (const ChannelSpec& known : kChannels)
        names += fmt::format("{}{}", names.empty() ? "" : ",", known.name);
      return expected_but(fmt::format("some of {}, with commas between them", names), name);
    }
    channels.add(spec->channel);
    if (name.size() == text.size()) break;
    text.remove_prefix(name.size() + 1);
  }
  o.channels = channels;
  return {};
}

std::string channels_text(const Options& o, const OptionSpec&) {
  std::string text;
  for (const ChannelSpec& spec : kChannels)
    if (o.channels.has(spec.channel))
      text += fmt::format("{}{}", text.empty() ? "" : ",", spec.name);
  return text;
}

constexpr OptionValue<Options> kFrom = kMember<Options, &Options::from>,
                               kUp = kMember<Options, &Options::up>;

Set set_from(Options& o, const OptionSpec& spec, std::string_view text) {
  const auto side = std::ranges::find(kSideNames, text);
  if (side != kSideNames.end()) {
    o.side = Side(side - kSideNames.begin()), o.from.reset();
    return {};
  }
  if (!kFrom.set(o, spec, text))
    return expected_but("three numbers as X,Y,Z, or front, back, left, right, top, bottom or iso",
                        text);
  o.side.reset();
  return {};
}

std::string from_text(const Options& o, const OptionSpec& spec) {
  return o.side ? std::string(kSideNames[size_t(*o.side)]) : kFrom.text(o, spec);
}

Set set_up(Options& o, const OptionSpec& spec, std::string_view text) {
  const bool is_negative = text.starts_with('-');
  const std::string_view axis = text.substr(is_negative || text.starts_with('+') ? 1 : 0);
  if (axis == "x" || axis == "y" || axis == "z") {
    Vec3d up;
    up[axis[0] - 'x'] = is_negative ? -1 : 1;
    o.up = up;
    return {};
  }
  if (!kUp.set(o, spec, text))
    return expected_but("x, -x, y, -y, z, -z or three numbers as X,Y,Z", text);
  return {};
}

constexpr auto kEv = kMember<Options, &Options::exposure, &Exposure::ev>;

Set set_exposure(Options& o, const OptionSpec& spec, std::string_view text) {
  if (text == kExposureNames[0]) return o.exposure = {.automatic = true}, Set();
  if (!kEv.set(o, spec, text)) return expected_but("a number from -100 to 100 EV, or auto", text);
  o.exposure.automatic = false;
  return {};
}

std::string exposure_text(const Options& o, const OptionSpec& spec) {
  return o.exposure.automatic ? std::string(kExposureNames[0]) : kEv.text(o, spec);
}

template <auto... path>
constexpr OptionValue<Options> kValue = kMember<Options, path...>;

using table::alone, table::only_with, table::range;
constexpr auto kOfClassic = only_with(IntegratorKind::classic);
constexpr auto kOfFigures = only_with(IntegratorKind::ambient);
constexpr auto kOfLight =
    only_with(IntegratorKind::classic, IntegratorKind::ambient, IntegratorKind::path);
constexpr auto kOfRayTrees = only_with(IntegratorKind::classic, IntegratorKind::path);
constexpr auto kOfSkies = only_with(IntegratorKind::ambient, IntegratorKind::path);
constexpr auto kLength = range(1e-30, 1e30, "scene units"), kCoordinate = range(-1e30, 1e30);
constexpr OptionValue<Options> kLook = {OptionType::words, set_look, look_text,
                                        [](Options& o) { o.look.reset(); }, true};
constexpr OptionValue<Options> kSkyLight = {OptionType::color, set_sky_light, sky_light_text,
                                            [](Options& o) { o.sky_light.reset(); }, true};

using enum OptionGroup;
using table::kAlwaysStored, table::kNotOfPicture, table::kNotOfWindow;
using table::option, table::usual, table::unit, table::one_of, table::excludes;

constexpr auto kTable = std::to_array<OptionSpec>({
    option(output, "size", "WxH",
           "Width and height in pixels; or in print, as in 88x66mm, at `dpi`",
           OptionValue<Options>{OptionType::size, set_size, size_text},
           usual("the scene's, else 512x512"), unit("pixels")),
    option(output, "width", "LENGTH",
           "Width of the printed picture, as in 88mm, 8.8cm, 3.5in or 250pt, at `dpi`; the "
           "height follows from the scene's aspect ratio",
           OptionValue<Options>{OptionType::size, set_width, width_text}, excludes("size"),
           kNotOfWindow),
    option(output, "dpi", "N",
           "Resolution in print; stored in .png and .exr; outlines and text keep the printed "
           "size that they have at 96",
           kValue<&Options::dpi>, usual("300 with `width` or a printed `size`"),
           range(10, 10000, "pixels per inch"), kNotOfWindow),
    option(output, "crop", "X0,Y0,X1,Y1",
           "Render only columns X0 to X1-1 and rows Y0 to Y1-1, counted from the upper left; the "
           "pixels equal those of the whole picture",
           OptionValue<Options>{OptionType::list, set_crop, crop_text}, usual("all"),
           unit("pixels"), kNotOfWindow),
    option(camera, "from", "PLACE",
           "Camera position X,Y,Z in the file's coordinates; or a side that shows the whole "
           "scene: front, back, left, right, top, bottom or iso",
           OptionValue<Options>{OptionType::vector, set_from, from_text}, usual("the scene's"),
           kCoordinate, one_of(kSideNames)),
    option(camera, "at", "X,Y,Z", "Point the camera looks at", kValue<&Options::at>,
           usual("the scene's"), kCoordinate),
    option(camera, "up", "AXIS",
           "Up direction of the camera: X,Y,Z or x, -x, y, -y, z or -z; a camera fitted to data "
           "is fitted again unless `from` or `at` gives a point",
           OptionValue<Options>{OptionType::vector, set_up, kUp.text},
           usual("the scene's; with a side, the axis nearest to it"), kCoordinate),
    option(camera, "fit", "NAME",
           "Move the camera without turning it: all shows the whole scene, most ignores ground "
           "planes and stray atoms",
           kValue<&Options::fit>, usual("the scene's camera; all for data without one"),
           one_of(kFitNames)),
    option(camera, "fov", "DEG", "Vertical field of view", kValue<&Options::fov_deg>,
           usual("the scene's"), range(0.001, 179, "degrees")),
    option(
        camera, "projection", "NAME",
        "Eye rays from one point (perspective) or parallel (orthographic); both show the same "
        "size at the distance of the point looked at; or in all directions (omnidirectional), as "
        "an equirectangular picture with that point in the middle",
        kValue<&Options::projection>, usual("the scene's"), one_of(kProjectionNames)),
    option(effects, "integrator", "NAME", kIntegratorHelp, kValue<&Options::integrator>,
           usual("classic; path for materials of glTF; ambient for atoms, points, other meshes and "
                 "physical light; views with `view`"),
           one_of(kIntegratorNames)),
    option(diagnostics, "view", "NAME",
           "Show normals, depth, ids, materials, traversal steps, intersection tests, focus or "
           "samples instead of the picture",
           kValue<&Options::view>, usual("picture"), one_of(kViewNames)),
    option(output, "channels", "LIST",
           "Also store these channels (AOVs): alpha, depth, position, normal, albedo, id, "
           "object, samples, variance, steps, tests; with the integrator path also lamps, emission "
           "and surroundings; .exr and .npz store all, .png only alpha",
           OptionValue<Options>{OptionType::list, set_channels, channels_text}),
    option(output, "background", "COLOR|sky|FILE|FOLDER",
           "Colour behind the scene: a name such as white, '#rrggbb' or R,G,B with 1 for white; "
           "or transparent, which stores alpha; or a folder with the six pictures of a sky: "
           "right, left, top, bottom, front and back as .jpg or .png. These also light the scene: "
           "sky, which is `sky` 3,45,0 unless `sky` is given, and an .exr or .hdr as `environment`",
           OptionValue<Options>{OptionType::color, set_background, background_text},
           usual("the scene's; for figures the look's")),
    option(output, "exposure", "EV",
           "Multiply the colours of .png and .ppm by 2 to the power of EV; auto chooses it from "
           "the picture, so that the mean brightness becomes middle grey; other formats keep the "
           "computed values",
           OptionValue<Options>{OptionType::number, set_exposure, exposure_text,
                                [](Options& o) { o.exposure = {}; }},
           usual("0"), range(-100, 100, "EV"), one_of(kExposureNames), kOfLight),
    option(output, "tone", "NAME",
           "Tone curve of .png and .ppm: none keeps the values, srgb encodes for displays; agx and "
           "neutral also compress highlights",
           kValue<&Options::tone>, usual("none; srgb for figures and paths"), one_of(kToneNames),
           kOfLight),
    option(output, "denoise", "NAME",
           "Filter the noise of few samples out of pictures: raio, with the same bytes on every "
           "machine; oidn, Open Image Denoise; or auto, oidn where it is installed, else raio; "
           "part files keep the samples",
           kValue<&Options::denoise>, usual("none"), alone("auto"), one_of(kDenoiserNames),
           kOfLight, kNotOfWindow),
    option(diagnostics, "accel", "NAME",
           "Acceleration structure: none (brute force), grid, bvh, embree, or auto, which is the "
           "scene's, else bvh",
           kValue<&Options::accel, &AccelOptions::kind>, one_of(kAccelNames), kAlwaysStored),
    option(diagnostics, "grid-factor", "M",
           "Resolution of the uniform grid: M times the cube root of the number of primitives, "
           "in cells per side",
           kValue<&Options::accel, &AccelOptions::grid_factor>,
           usual("0.3; one cell for up to 32 primitives"), range(0.01, 100),
           excludes("grid-resolution")),
    option(diagnostics, "grid-resolution", "XxYxZ",
           "Exact number of cells of the uniform grid; replaces `grid-factor`",
           kValue<&Options::accel, &AccelOptions::grid_resolution>, range(1, kMaxSide)),
    option(sampling, "aa", "N",
           "Antialiasing with N x N jittered samples per pixel; 1 is one ray through the centre",
           kValue<&Options::aa>, usual("the scene's, else 1; figures and paths have 64 samples"),
           range(1, 256)),
    option(effects, "soft-shadows", "",
           "Soft shadows; lights become squares that face the point looked at",
           kValue<&Options::soft_shadows>, kOfRayTrees),
    option(effects, "light-size", "S", "Side of the square lights of `soft-shadows`",
           kValue<&Options::light_size>,
           usual("a tenth of the light's distance to the point looked at"), kLength, kOfRayTrees),
    option(effects, "dof", "", "Depth of field; a thin lens replaces the pinhole",
           kValue<&Options::dof>, usual("on if the scene has a lens")),
    option(effects, "aperture", "R", "Lens radius for `dof`", kValue<&Options::aperture>,
           usual("the scene's, else a fiftieth of the focus distance"), kLength),
    option(effects, "focus", "D", "Distance to the plane in focus for `dof`",
           kValue<&Options::focus>, usual("the scene's, else the distance to the point looked at"),
           kLength),
    option(sampling, "lens-samples", "K",
           "Rays per cell of a pixel, stratified over the lens and the lights",
           kValue<&Options::lens_samples>, usual("1"), range(1, 65536), excludes("samples")),
    option(sampling, "samples", "N",
           "N samples per pixel over its whole area (through its centre with `aa` 1); implies "
           "`sampler` sobol, replaces `aa` and `lens-samples`",
           kValue<&Options::samples>, range(1, kMaxSamples)),
    option(
        sampling, "noise", "E",
        "Give each tile of 16 x 16 pixels as many samples as it needs for a standard error below "
        "E times its brightness, as in 0.02; implies `sampler` sobol, replaces `samples`",
        kValue<&Options::noise>, range(0.0001, 1), excludes("samples"), kOfLight, kNotOfWindow),
    option(sampling, "min-samples", "N", "The fewest samples per pixel with `noise`",
           kValue<&Options::min_samples>, usual("16"), range(2, kMaxSamples), kOfLight,
           kNotOfWindow),
    option(sampling, "max-samples", "N", "The most samples per pixel with `noise`",
           kValue<&Options::max_samples>, usual("4096"), range(2, kMaxSamples), kOfLight,
           kNotOfWindow),
    option(sampling, "sampler", "NAME",
           "Sampling pattern: jitter, random points in equal cells; or sobol, a scrambled Sobol "
           "sequence, well distributed after any number of samples",
           kValue<&Options::sampler>, usual("jitter; sobol with `samples`"), one_of(kSamplerNames)),
    option(
        sampling, "filter", "NAME",
        "Pixel filter: box, the pixel's square; or blackman-harris, a smooth one of 3 x 3 pixels",
        kValue<&Options::filter>, usual("blackman-harris for paths, else box"),
        one_of(kFilterNames), kOfLight),
    option(effects, "depth", "N", "Maximum ray depth; the eye ray is level 1",
           kValue<&Options::depth>, usual("5; 16 for paths"), range(1, kMaxDepth), kOfRayTrees),
    option(effects, "no-reflection", "", "Trace no reflected rays; highlights of the lights stay",
           kValue<&Options::no_reflection>, kOfClassic),
    option(effects, "no-refraction", "",
           "Trace no refracted rays; transparent surfaces become opaque",
           kValue<&Options::no_refraction>, kOfClassic),
    option(effects, "shading", "NAME",
           "Shading model: nff; or phong or blinn-phong, which have no ambient light",
           kValue<&Options::shading>, usual("nff; blinn-phong for P3F scenes"),
           one_of(kShadingNames), kOfClassic),
    option(effects, "fresnel", "NAME",
           "Split of light between reflection and refraction where T is above 0: none uses Ks "
           "and T, exact Fresnel's equations, schlick Schlick's approximation",
           kValue<&Options::fresnel>, usual("none; schlick for P3F scenes"), one_of(kFresnelNames),
           kOfClassic),
    option(effects, "gloss", "R", "Roughness of mirrors: 0 is perfect, 0.1 brushed metal",
           kValue<&Options::gloss>, usual("each material's"), range(0, 1000), kOfClassic),
    option(effects, "translucency", "R", "Roughness of refraction: 0 is clear glass",
           kValue<&Options::translucency>, usual("each material's"), range(0, 1000), kOfClassic),
    option(effects, "shutter", "T0,T1",
           "Motion blur: the shutter is open from time T0 to T1; equal times show one moment",
           OptionValue<Options>{OptionType::list, set_shutter, kShutter.text},
           usual("the whole movement"), kCoordinate),
    option(figures, "opacity", "A",
           "Opacity of everything without its own: 0 is invisible, 1 opaque",
           kValue<&Options::opacity>, usual("1"), range(0, 1)),
    option(figures, "look", "NAME",
           "Look of figures: paper, soft light on white; dark; flat, outlines without a key "
           "light; or matte; a number fixes the version, as in paper-1",
           kLook, usual("paper"), one_of(kLooks), kOfSkies),
    option(
        figures, "sky-light", "COLOR",
        "Radiance of the sky: a number or a colour, with 1 for a sky in which white surfaces are "
        "white; 0 for no sky",
        kSkyLight,
        usual("the look's; 1 for a scene with an environment; 0 for paths in scenes with lights"),
        range(0, 1e6), kOfSkies),
    option(figures, "occlusion-rays", "N", "Rays to the sky from each surface point",
           kValue<&Options::occlusion_rays>, usual("2"), range(1, 4096), kOfFigures),
    option(figures, "occlusion-distance", "D",
           "Surfaces farther away than D scene units hide no sky",
           kValue<&Options::occlusion_distance>, usual("any distance"), kLength, kOfFigures),
    option(figures, "key-light", "NAME",
           "Light over the viewer's left shoulder, with soft shadows: on or off; or scene, the "
           "scene's lights in physical units",
           kValue<&Options::key_light>,
           usual("on; scene if it has physical lights, or, for paths, any light"),
           one_of(kKeyLights), kOfSkies),
    option(figures, "outline", "W",
           "Outlines W pixels wide where depth jumps, faces meet or objects end; 0 for none",
           kValue<&Options::outline>, usual("the look's"), range(0, 64, "pixels"), kOfFigures),
    option(figures, "depth-cue", "X",
           "Fade into the background with distance: the farthest point fades by X, from 0 to 1",
           kValue<&Options::depth_cue>, usual("the look's"), range(0, 1), kOfFigures),
    option(figures, "shadow-catcher", "", "Cast shadows on the background, as on a floor",
           kValue<&Options::shadow_catcher>, kOfFigures),
    option(effects, "one-sided", "",
           "Cull back faces of opaque surfaces, as the NFF specification says",
           kValue<&Options::one_sided>),
    option(camera, "angle-to-centers", "",
           "Measure the field of view between the centres of the outermost pixels, as the NFF "
           "specification says, not between their edges",
           kValue<&Options::angle_to_centers>),
    option(diagnostics, "threads", "N",
           "Number of threads, from reading to writing; the picture does not depend on it",
           kValue<&Options::threads>, usual("one per core, within the limit of a container"),
           range(1, 4096), kNotOfPicture),
    option(sampling, "seed", "N", "Seed of the random numbers", kValue<&Options::seed>,
           range(0, std::numeric_limits<uint32_t>::max()), kAlwaysStored),
    option(diagnostics, "counters", "",
           "Count intersection tests and traversal steps for the statistics; costs some time",
           kValue<&Options::accel, &AccelOptions::counters>, kNotOfPicture),
});

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

const OptionSpec& option_of(std::string_view name) {
  return *std::ranges::find(kTable, name, &OptionSpec::name);
}

std::string_view accel_name(AccelKind kind) { return kAccelNames[size_t(kind)]; }
std::string_view sampler_name(SamplerKind kind) { return kSamplerNames[size_t(kind)]; }
std::string_view shading_name(ShadingModel model) { return kShadingNames[size_t(model)]; }
std::string_view fresnel_name(Fresnel fresnel) { return kFresnelNames[size_t(fresnel)]; }
std::string_view view_name(View view) { return kViewNames[size_t(view)]; }
std::string_view integrator_name(IntegratorKind kind) { return kIntegratorNames[size_t(kind)]; }
std::string_view projection_name(Projection projection) {
  return kProjectionNames[size_t(projection)];
}

std::expected<void, Error> set_option(RenderOptions& options, const OptionSpec& spec,
                                      std::string_view text) {
  if (auto set = spec.set(options, text); !set)
    return std::unexpected(bad_option(spec.name, std::move(set.error())));
  return {};
}

std::vector<std::string_view> excluded_by(const OptionSpec& option) {
  std::vector<std::string_view> names;
  if (!option.excludes.empty()) names.push_back(option.excludes);
  for (const OptionSpec& other : kTable)
    if (other.excludes == option.name) names.push_back(other.name);
  return names;
}

std::string option_argument(std::string_view name, bool is_switch, std::string_view text) {
  return is_switch ? fmt::format(" --{}{}", text == "false" ? "no-" : "", name)
                   : fmt::format(" --{} {}", name, shell_word(text));
}

std::string option_arguments(const RenderOptions& options) {
  std::string out;
  for (const OptionSpec& spec : kTable)
    if (spec.is_given(options))
      out += option_argument(spec.name, spec.is_switch(), spec.text(options));
  return out;
}

}  // namespace raio::core
