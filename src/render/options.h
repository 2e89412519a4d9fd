// The options of a picture, in one table that feeds the command line and its help;
// integrate/settings.h has the resolved values for a scene.
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "integrate/color_text.h"
#include "integrate/settings.h"
#include "integrate/tone.h"
#include "io/fit_camera.h"
#include "render/option.h"

namespace raio::core {

/// The size of the printed picture in millimetres; the height 0 follows from the scene's aspect
/// ratio.
struct PrintSize {
  float width = 0, height = 0;

  friend bool operator==(const PrintSize&, const PrintSize&) = default;
};
inline constexpr float kPrintDpi = 300;
inline constexpr int kMaxSide = 1 << 20;  // pixels

/// Zero or empty values are left to the scene or a rule: resolve_options() fills them in.
struct RenderOptions : PlainOptions {
  std::optional<PrintSize> print;     // instead of pixels; then 0 `dpi` is kPrintDpi
  std::optional<Vec3d> from, at, up;  // of the camera, in the file's coordinates
  std::optional<Side> side;           // instead of `from`
  std::optional<Fit> fit;
  float fov_deg = 0;
  std::optional<Projection> projection;
  std::optional<IntegratorKind> integrator;
  std::optional<WrittenColor> background;
  std::optional<Tone> tone;
  std::optional<bool> dof;
  std::optional<SamplerKind> sampler;
  std::optional<PixelFilter> filter;
  std::optional<ShadingModel> shading;
  std::optional<Fresnel> fresnel;
  std::optional<std::array<float, 2>> shutter;  // opens and closes
  std::optional<FigureStyle> look;
  std::optional<Rgb> sky_light;
  int occlusion_rays = 0;
  float occlusion_distance = 0;
  std::optional<KeyLight> key_light;
  std::optional<float> outline, depth_cue, opacity;
  bool shadow_catcher = false;

  friend bool operator==(const RenderOptions&, const RenderOptions&) = default;
};

/// The scene's camera, modified by the options. A side or `fit` fits it to the scene. A camera
/// fitted to data is fitted again for another up direction and for parallel rays, unless a position
/// is given.
Camera camera_of(const Scene& scene, const RenderOptions& options);

/// Sets the options that turn the scene's camera into a picture's: the differences.
void set_camera(RenderOptions& options, const Camera& camera, const Scene& scene);

/// Leaves the camera to the scene.
void reset_camera(RenderOptions& options);

/// Why the options cannot be combined (bad_option): one would have no effect with the others, or
/// there would be too many samples; nothing if all is well. Without a scene, checks that depend on
/// it pass. `from_file`: the options are from a picture or part, so the integrator may ignore some.
std::optional<Error> option_conflict(const RenderOptions& options, const Scene* scene = nullptr,
                                     bool from_file = false);

/// The first option given that the integrator ignores (bad_option), or nothing.
std::optional<Error> ignored_option(const RenderOptions& options, const Scene* scene);

/// Removes all options that the integrator ignores.
void drop_ignored_options(RenderOptions& options, const Scene& scene);

/// Why a picture with these options cannot be shown in a window (bad_option), or nothing.
std::optional<Error> window_conflict(const RenderOptions& options);

/// The channels requested by name, and alpha for a transparent background.
ChannelSet channels_of(const RenderOptions& options);

/// Resolves the options for `scene`: open values come from the scene's requests (resolution,
/// samples, lens, structure), else from the default of its dialect as stated in the table.
RenderSettings resolve_options(const RenderOptions& options, const Scene& scene);

/// The integrator of the picture.
IntegratorKind integrator_of(const RenderOptions& options, const Scene& scene);

/// The structure requested by the scene's file, or automatic.
AccelKind hinted_accel(const Scene& scene);

/// The options that resolve to these settings and leave only the scene's own camera open.
RenderOptions options_of(const RenderSettings& settings, const Scene& scene);

using OptionSpec = OptionEntry<RenderOptions>;

/// All options, in the order of a command line; the help sorts them by group.
std::span<const OptionSpec> render_option_table();

/// The option of that name, which must exist.
const OptionSpec& option_of(std::string_view name);

/// Sets one option from text ("true" or "false" for a switch). The error (bad_option) says what was
/// found and what is accepted.
std::expected<void, Error> set_option(RenderOptions& options, const OptionSpec& spec,
                                      std::string_view text);

/// The options that cannot be combined with `option`, by OptionEntry::excludes of either.
std::vector<std::string_view> excluded_by(const OptionSpec& option);

/// The command-line arguments for these options: " --aa 4 --soft-shadows", without defaults and
/// quoted for a shell.
std::string option_arguments(const RenderOptions& options);

/// One option as an argument: " --aa 4".
std::string option_argument(std::string_view name, bool is_switch, std::string_view text);

/// `word`, quoted for a shell if necessary.
std::string shell_word(std::string_view word);

/// Names as on the command line.
std::string_view accel_name(AccelKind kind);
std::string_view sampler_name(SamplerKind kind);
std::string_view shading_name(ShadingModel model);
std::string_view fresnel_name(Fresnel fresnel);
std::string_view view_name(View view);
std::string_view integrator_name(IntegratorKind kind);
std::string_view projection_name(Projection projection);

}  // namespace raio::core
