#pragma once

#include "app/commands.h"

namespace raio::core::view {

/// Opens the window of `raio view` and returns the exit status when it is closed.
int open_window(const app::ViewCommand& command);

}  // namespace raio::core::view
