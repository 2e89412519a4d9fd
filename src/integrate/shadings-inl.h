// The shadings of all integrators, made by their source files. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_SHADINGS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SHADINGS_INL_H_
#undef RAIO_INTEGRATE_SHADINGS_INL_H_
#else
#define RAIO_INTEGRATE_SHADINGS_INL_H_
#endif

#include <memory>

#include "integrate/wavefront-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

std::unique_ptr<Shading> make_classic_shading(const PreparedScene& scene);
std::unique_ptr<Shading> make_views_shading(const PreparedScene& scene);
std::unique_ptr<Shading> make_ambient_shading(const PreparedScene& scene);
std::unique_ptr<Shading> make_path_shading(const PreparedScene& scene);

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
