#include "integrate/integrators.h"

#include "integrate/ambient.h"
#include "integrate/classic.h"
#include "integrate/views.h"

namespace raio::core {

const Integrator& integrator(IntegratorKind kind) {
  // In the order of IntegratorKind.
  static constexpr std::array<Integrator, kIntegratorNames.size()> kIntegrators = {
      Integrator{classic_bound, make_classic_renderer},
      Integrator{views_bound, make_views_renderer},
      Integrator{ambient_bound, make_ambient_renderer},
  };
  return kIntegrators[size_t(kind)];
}

}  // namespace raio::core
