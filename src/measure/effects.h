// What a picture can be rendered with and without: what is on by the options, and the options that
// switch it. Their costs are measured by effect_costs.h and benchmark.h.
#pragma once

#include <array>
#include <cstdint>

#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

/// What can be switched on and off. The structure is off where brute force takes its place, gloss
/// and translucency where no mirrored or refracted ray spreads, motion where the shutter closes as
/// it opens.
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

/// The roughness of gloss and translucency that are switched on where no material has one.
inline constexpr float kUsualRoughness = 0.1f;

bool is_on(Effect effect, const RenderOptions& options, const Scene& scene);

/// The same options with the effect on or off; what is on already stays as it is. The samples are
/// those of the benchmark; the structure that is on is the tree; the roughness is that of the
/// materials, or kUsualRoughness where all are smooth; the shutter is open for the whole movement.
RenderOptions with_effect(RenderOptions options, Effect effect, bool on, const Scene& scene);

/// Can the effect change any picture of the scene? Refraction and translucency want a surface that
/// lets light through, reflection and gloss one that mirrors (glass, too, where `fresnel` divides
/// its light), soft shadows a light, motion what moves, all of them something to hit.
bool is_in_scene(Effect effect, const Scene& scene, Fresnel fresnel);

}  // namespace raio
