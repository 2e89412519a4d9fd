// The surfaces that rays hit, shared by all shadings: points, normals and materials. Included once
// per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_SURFACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SURFACES_INL_H_
#undef RAIO_INTEGRATE_SURFACES_INL_H_
#else
#define RAIO_INTEGRATE_SURFACES_INL_H_
#endif

#include <cstddef>
#include <memory>
#include <vector>

#include "accel/geometry.h"
#include "integrate/tile-inl.h"
#include "shape/offset.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// shape/offset.h.
HWY_INLINE V3 offset_point(const V3& point, const V3& geometric, V scale, bool along_normal) {
  const float k = offset_length(1);
  return point + geometric * hn::Mul(hn::Set(d, along_normal ? k : -k), scale);
}

// Columns gathered for the surfaces that rays hit, by kind: each kind names the shared columns
// differently, and in each lane only the numbers of its ray's kind are valid.
struct TriangleColumns {
  Floats3 corner[3];
};
struct SphereColumns {
  Floats3 center;
  Floats radius;
};
struct ConeColumns {  // as BakedCone
  Floats3 base, axis;
  Floats height, base_radius, slope;
};
struct PointColumns {  // for other kinds, evaluated one by one
  Floats3 point;
  Floats extent;
};
union Gathered {
  TriangleColumns triangle;
  SphereColumns sphere;
  ConeColumns cone;
  PointColumns other;
};

// The hits being shaded.
struct SurfacePoints {
  Gathered gathered;
  // `outside`: offset off the surface. After find_surfaces(), normals face the ray; before, as
  // gathered, they face outward, with `normal` only in scenes with smooth triangles.
  Floats3 point, outside, normal, geometric;
  Floats scale;  // of shape/offset.h
  alignas(64) MaterialId material[kChunk + 16];
  // For the primitives hit: the kind, and the index within the kind.
  alignas(64) uint32_t kind[kChunk + 16], index[kChunk + 16];
  Floats3 color;
  Floats kd, ks, shine, transmission, ior;
  Floats eta;        // for refraction
  Floats side;       // 1: the ray hits the outside, -1: the inside
  Floats3 radiance;  // towards the ray, so far
  // For other shading models than NFF's, which gather them.
  Floats3 specular;  // the colour of highlight and mirror
  Floats roughness;

  struct Instanced;
  std::unique_ptr<Instanced> instanced;  // in scenes with instances
};

// Rays and hits in the space of an object, and the surfaces there.
struct SurfacePoints::Instanced {
  RayBatch rays;
  HitBatch hits;
  std::vector<uint32_t> lanes;
  std::vector<const Geometry*> objects;  // by lane; null: the scene's own
  std::vector<uint32_t> indices;         // of the instances
  SurfacePoints points;
};

// The surfaces at the hits of n rays: points, normals towards the ray, and everything that does not
// depend on lights. Materials and textures are those of `scene`, which is rendered and may be a
// later version of the one that the structure was built from.
void find_surfaces(const Geometry& geometry, const Scene& scene, const RayBatch& rays,
                   const HitBatch& hits, size_t n, SurfacePoints& v);

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
