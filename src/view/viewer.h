// The window's program: what hands do becomes a state, the state becomes requests, and the pictures
// that sessions make of them are shown.
#pragma once

#include "app/commands.h"

namespace raio::view {

/// Opens the window of `raio view` and returns the exit status when it is closed.
int open_window(const app::ViewCommand& command);

}  // namespace raio::view
