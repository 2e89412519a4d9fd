// The effects of a picture: which are on by the options, and the options that switch them.
// effect_costs.h and benchmark.h measure their costs.
#pragma once

#include <array>
#include <cstdint>

#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core {

/// Effects that can be switched. The structure is off if brute force replaces it, gloss and
/// translucency if no mirrored or refracted ray spreads, motion if the shutter closes when it
/// opens.
enum class Effect : uint8_t {
  antialiasing,
  soft_shadows,
  depth_of_field,
  reflection,
  refraction,
  gloss,
  translucency,
  motion,
  structure,
};
inline constexpr auto kEffects = std::to_array<Effect>(
    {Effect::antialiasing, Effect::soft_shadows, Effect::depth_of_field, Effect::reflection,
     Effect::refraction, Effect::gloss, Effect::translucency, Effect::motion, Effect::structure});

/// The roughness for gloss and translucency if no material has one.
inline constexpr float kUsualRoughness = 0.1f;

bool is_on(Effect effect, const RenderOptions& options, const Scene& scene);

/// The options with the effect on or off; if already so, they are unchanged. Samples are those of
/// the benchmark; the structure is the tree; the roughness is that of the materials, or
/// kUsualRoughness if all are smooth; the shutter is open for the whole movement.
RenderOptions with_effect(RenderOptions options, Effect effect, bool on, const Scene& scene);

/// Whether the effect can change any picture of the scene. Refraction and translucency need a
/// transmitting surface, reflection and gloss a mirror (or glass, if `fresnel` splits its light),
/// soft shadows a light, motion a moving primitive, and all need something to hit.
bool is_in_scene(Effect effect, const Scene& scene, Fresnel fresnel);

}  // namespace raio::core
