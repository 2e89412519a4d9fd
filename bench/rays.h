// The rays that a picture asks for, recorded kind by kind, so that structures can be timed and held
// against each other on the very same rays without the shading around them.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::bench {

enum class RayKind { eye, shadow, reflection, random };
inline constexpr std::array kRayKinds = {RayKind::eye, RayKind::shadow, RayKind::reflection,
                                         RayKind::random};
inline constexpr std::array<std::string_view, 4> kRayKindNames = {"eye", "shadow", "reflection",
                                                                  "random"};

/// As the renderer makes them: tiles of 32 x 32 pixels in blocks of 4 x 2, a batch of each kind a
/// tile, of shadow rays one a light. Eye rays go through pixel centres; from each of their hits a
/// shadow ray to every light that it faces, a mirror reflection whatever the material, and a random
/// ray, distributed by the cosine.
struct Recording {
  std::array<std::vector<RayBatch>, 4> batches;  // by RayKind

  const std::vector<RayBatch>& of(RayKind kind) const { return batches[size_t(kind)]; }
  size_t count(RayKind kind) const;
};

/// For a picture of the options' size, or the scene's.
Recording record_rays(const Scene& scene, const Accel& accel, const RenderOptions& options);

/// Structures keep together what is coherent.
inline bool is_coherent(RayKind kind) { return kind != RayKind::random; }

/// Traces a batch as the renderer does and says how many of its rays hit. Of shadow rays only the
/// item means something: kNoPrimitive, or another.
size_t trace_batch(const Accel& accel, const RayBatch& rays, RayKind kind, HitBatch& hits);

/// Holds a structure against `none`: what a sample of the recorded rays hit, and a small picture.
/// Raio's own must agree to the last bit, Embree but for a few that graze an edge. Ends the program
/// with status 1 when they do not.
void check_structure(const Scene& scene, const Accel& accel, const Recording& rays, int threads);

}  // namespace raio::bench
