// The renderer of the other shading models, separate from classic.cpp so that the compiler
// generates the same code for that as without them.
#include "integrate/classic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/models.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/classic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

std::unique_ptr<TileRenderer> make_renderer(const PreparedScene& scene, WorkControl& control) {
  return std::make_unique<Wavefront<ModelShading>>(scene, control);
}

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(make_renderer);

std::unique_ptr<TileRenderer> make_model_renderer(const PreparedScene& scene,
                                                  WorkControl& control) {
  return HWY_DYNAMIC_DISPATCH(make_renderer)(scene, control);
}

}  // namespace raio::core
#endif
