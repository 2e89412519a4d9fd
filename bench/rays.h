// The rays of a picture, recorded by kind, so that structures can be timed and compared with
// exactly the same rays, without shading.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core::bench {

enum class RayKind { eye, shadow, reflection, random };
inline constexpr std::array kRayKinds = {RayKind::eye, RayKind::shadow, RayKind::reflection,
                                         RayKind::random};
inline constexpr std::array<std::string_view, 4> kRayKindNames = {"eye", "shadow", "reflection",
                                                                  "random"};

/// As in the renderer: tiles of 32 x 32 pixels in blocks of 4 x 2, a batch of each kind per tile,
/// and one per light for shadow rays. Eye rays go through pixel centres; from each of their hits a
/// shadow ray to every light that it faces, a mirror reflection whatever the material, and a random
/// ray with a cosine-weighted distribution.
struct Recording {
  std::array<std::vector<RayBatch>, 4> batches;  // by RayKind

  const std::vector<RayBatch>& of(RayKind kind) const { return batches[size_t(kind)]; }
  size_t count(RayKind kind) const;
};

/// For a picture of the options' size, or the scene's.
Recording record_rays(const Scene& scene, const Accel& accel, const RenderOptions& options);

/// Coherent rays, which structures trace together.
inline bool is_coherent(RayKind kind) { return kind != RayKind::random; }

/// Traces a batch as the renderer does and returns the number of rays that hit. For shadow rays,
/// only whether the primitive is kNoPrimitive is meaningful.
size_t trace_batch(const Accel& accel, const RayBatch& rays, RayKind kind, HitBatch& hits);

/// Compares a structure with `none`: the hits of a sample of the recorded rays, and a small
/// picture. Raio's own must agree exactly, Embree except for a few rays that graze an edge.
/// Otherwise ends the program with status 1.
void check_structure(const Scene& scene, const Accel& accel, const Recording& rays, int threads);

}  // namespace raio::core::bench
