#include "integrate/integrators.h"

#include "integrate/ambient.h"
#include "integrate/classic.h"
#include "integrate/path.h"
#include "integrate/views.h"

namespace raio::core {

double sample_bound(const Scene& scene, const RenderSettings& settings) {
  // In the order of IntegratorKind.
  static constexpr auto kBounds =
      std::to_array({classic_bound, views_bound, ambient_bound, path_bound});
  static_assert(kBounds.size() == kIntegratorNames.size());
  return kBounds[size_t(settings.integrator)](scene, settings);
}

}  // namespace raio::core
