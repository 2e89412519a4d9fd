// Everything that a picture depends on besides the scene, and the one table of it from which the
// command line and its help are made.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "accel/accel.h"
#include "scene/scene.h"

namespace raio {

/// Where samples go in the pixel, on the lens and on the lights (render/sampler.h): at random in
/// equal cells, as many as there are samples; or by Sobol's sequence, which is even after any
/// number.
enum class SamplerKind { jitter, sobol };

/// Zero, or nothing, where the scene or a rule decides: resolve_options() fills it in.
struct RenderOptions {
  AccelOptions accel;
  int width = 0, height = 0;
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
  bool one_sided = false;
  bool angle_to_centers = false;  // of view: see EyeRays
  int threads = 0;
  uint32_t seed = 0;

  int samples_per_pixel() const { return samples > 0 ? samples : aa * aa * lens_samples; }
};

inline constexpr int kMaxDepth = 32;  // a place in the ray tree has 32 bits (render/sampler.h)
inline constexpr int kMaxSamples = 1 << 24;  // of a pixel; the sampler numbers them in 32 bits

/// Why the options do not go together: one that was given and would have no effect beside the
/// others, or more samples than there can be. One line that says what to do; empty when all is
/// well. Without a scene, what depends on it passes.
std::string option_conflict(const RenderOptions& options, const Scene* scene = nullptr);

/// `options` with every open value replaced by what it means for `scene`: the scene's own wishes
/// (resolution, samples, lens), else the default that the table states.
RenderOptions resolve_options(const RenderOptions& options, const Scene& scene);

/// One option. The value is reached through `value`, or parsed by it where it is not one number.
struct OptionSpec {
  using Parse = std::expected<void, std::string> (*)(RenderOptions&, std::string_view);

  std::string_view name;        // --name on the command line
  std::string_view value_name;  // "N"; empty for a switch
  std::string_view help;        // with the default and the unit
  std::variant<bool& (*)(RenderOptions&), std::optional<bool>& (*)(RenderOptions&),
               int& (*)(RenderOptions&), float& (*)(RenderOptions&), Parse>
      value;
  double least = 0, most = 0;  // of a number

  /// For a value that is parsed: its text, empty where none is given.
  std::string (*text)(const RenderOptions&) = nullptr;

  bool of_picture = true;  // a picture depends on it

  bool is_switch() const { return value_name.empty(); }
};

/// All options, in the order of the help.
std::span<const OptionSpec> render_option_table();

/// Sets one option from text ("true" or "false" for a switch). The error says what was found and
/// what is accepted.
std::expected<void, std::string> set_option(RenderOptions& options, const OptionSpec& spec,
                                            std::string_view text);

/// The value of an option as set_option() takes it; empty where it is not given.
std::string option_text(const RenderOptions& options, const OptionSpec& spec);

/// The names of a structure and of a sampler as on the command line.
std::string_view accel_name(AccelKind kind);
std::string_view sampler_name(SamplerKind kind);

}  // namespace raio
