// Replaces view_program.cpp in builds with RAIO_WINDOW=OFF.
#include "app/output.h"

namespace raio::core::app {

int become_view_program(char**) {
  return bad_input("this build has no window; use one with RAIO_WINDOW=ON");
}

}  // namespace raio::core::app
