// What users may ask of a picture, and the one table of it from which the command line and its help
// are made; what it comes to for a scene is integrate/settings.h.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "base/error.h"
#include "integrate/color_text.h"
#include "integrate/settings.h"
#include "integrate/tone.h"
#include "io/fit_camera.h"

namespace raio {

/// A picture as large as it is printed, in millimetres; the height 0 follows from the scene's
/// shape.
struct PrintSize {
  float width = 0, height = 0;

  friend bool operator==(const PrintSize&, const PrintSize&) = default;
};
inline constexpr float kPrintDpi = 300;
inline constexpr int kMaxSide = 1 << 20;  // pixels

/// Zero, or nothing, where the scene or a rule decides: resolve_options() fills it in.
struct RenderOptions {
  AccelOptions accel;
  int width = 0, height = 0;
  std::optional<PrintSize> print;  // instead of pixels
  float dpi = 0;                   // pixels per inch; with `print` 0 is kPrintDpi
  std::optional<Crop> crop;
  std::optional<Vec3d> from, at, up;  // of the camera, in the coordinates of the file
  std::optional<Side> side;           // instead of `from`
  std::optional<Fit> fit;
  float fov_deg = 0;
  std::optional<Projection> projection;
  std::optional<IntegratorKind> integrator;
  View view = View::picture;
  ChannelSet channels;
  std::optional<WrittenColor> background;
  float exposure = 0;  // stops
  std::optional<Tone> tone;
  int aa = 0;  // cells along a side of the pixel; 1: its centre; resolved to 0: all of it
  bool soft_shadows = false;
  float light_size = 0;
  std::optional<bool> dof;
  float aperture = 0;
  float focus = 0;
  int lens_samples = 0;
  int samples = 0;  // of a pixel in all, instead of aa x aa x lens_samples
  std::optional<SamplerKind> sampler;
  int depth = 5;
  bool no_reflection = false, no_refraction = false;
  std::optional<ShadingModel> shading;
  std::optional<Fresnel> fresnel;
  std::optional<float> gloss, translucency;
  std::optional<std::array<float, 2>> shutter;  // opens and closes
  std::optional<FigureStyle> look;
  int occlusion_rays = 0;
  float occlusion_distance = 0;
  std::optional<bool> key_light;
  std::optional<float> outline, depth_cue, opacity;
  bool shadow_catcher = false;
  bool one_sided = false;
  bool angle_to_centers = false;  // of view: see EyeRays
  int threads = 0;
  uint32_t seed = 0;

  friend bool operator==(const RenderOptions&, const RenderOptions&) = default;
};

/// The scene's camera with what the options say of it. It is fitted to the scene where a side or
/// `fit` is given. One that was fitted to data is fitted anew for another direction up and for
/// parallel rays, unless a place is given.
Camera camera_of(const Scene& scene, const RenderOptions& options);

/// The options that make a camera of the scene that of a picture: what differs from the scene's.
void set_camera(RenderOptions& options, const Camera& camera, const Scene& scene);

/// Leaves the camera to the scene.
void reset_camera(RenderOptions& options);

/// Why the options do not go together (bad_option): one that was given and would have no effect
/// beside the others, or more samples than there can be; nothing when all is well. Without a scene,
/// what depends on it passes.
std::optional<Error> option_conflict(const RenderOptions& options, const Scene* scene = nullptr);

/// Why a picture with these options cannot be watched in a window (bad_option), or nothing.
std::optional<Error> window_conflict(const RenderOptions& options);

/// The channels that are asked for by name, and alpha for a transparent background.
ChannelSet channels_of(const RenderOptions& options);

/// What the options come to for `scene`: where they leave something open, the scene's own requests
/// (resolution, samples, lens, structure), else the default of its dialect that the table states.
RenderSettings resolve_options(const RenderOptions& options, const Scene& scene);

/// What makes the picture.
IntegratorKind integrator_of(const RenderOptions& options, const Scene& scene);

/// The structure that the scene's file asks for, or automatic.
AccelKind hinted_accel(const Scene& scene);

/// The options that resolve to these settings and leave nothing open but the scene's own camera.
RenderOptions options_of(const RenderSettings& settings, const Scene& scene);

/// Of options that leave nothing open about samples, such as those of options_of().
int samples_per_pixel(const RenderOptions& options);

/// The sections of the help, in its order.
enum class OptionGroup : uint8_t {
  input,
  output,
  camera,
  sampling,
  effects,
  figures,
  long_renders,
  diagnostics,
};
inline constexpr auto kOptionGroups =
    std::to_array<std::string_view>({"Input", "Output", "Camera", "Sampling", "Effects", "Figures",
                                     "Long renders", "Speed and diagnostics"});

/// One option. `value` reaches its number or switch, or parses anything else.
struct OptionSpec {
  using Parse = std::expected<void, std::string> (*)(RenderOptions&, std::string_view);

  OptionGroup group;
  std::string_view name;        // --name on the command line
  std::string_view value_name;  // "N"; empty for a switch
  std::string_view help;        // with the default and the unit; settings as in Error::message
  std::variant<bool& (*)(RenderOptions&), std::optional<bool>& (*)(RenderOptions&),
               int& (*)(RenderOptions&), float& (*)(RenderOptions&), Parse>
      value;
  double least = 0, most = 0;  // of a number

  /// For a value that is parsed: its text, empty where none is given, and the words that it may be.
  std::string (*text)(const RenderOptions&) = nullptr;
  std::span<const std::string_view> words = {};  // NOLINT(readability-redundant-member-init)

  bool of_picture = true;  // a picture depends on it
  bool of_window = true;   // pictures that are watched as they grow have it, too

  bool is_switch() const { return value_name.empty(); }
};

/// All options, in the order of a command line; the help sorts them by group.
std::span<const OptionSpec> render_option_table();

/// Sets one option from text ("true" or "false" for a switch). The error (bad_option) says what was
/// found and what is accepted.
std::expected<void, Error> set_option(RenderOptions& options, const OptionSpec& spec,
                                      std::string_view text);

/// The value of an option as set_option() takes it; empty where it is not given.
std::string option_text(const RenderOptions& options, const OptionSpec& spec);

/// What the command line needs to have these options: " --aa 4 --soft-shadows", without those that
/// are as always and as a shell wants it.
std::string option_arguments(const RenderOptions& options);

/// An option as part of these: " --aa 4".
std::string option_argument(std::string_view name, bool is_switch, std::string_view text);

/// `word` as a shell wants it.
std::string shell_word(std::string_view word);

/// Names as on the command line.
std::string_view accel_name(AccelKind kind);
std::string_view sampler_name(SamplerKind kind);
std::string_view shading_name(ShadingModel model);
std::string_view fresnel_name(Fresnel fresnel);
std::string_view view_name(View view);
std::string_view projection_name(Projection projection);

}  // namespace raio
