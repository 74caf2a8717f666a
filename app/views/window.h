#pragma once

#include "app/session/window_options.h"

namespace lumifield {

/// Runs the window until it is closed and returns the program's exit code. Without a display it says so and fails.
int run_window(int argc, char** argv, const WindowOptions& options);

}  // namespace lumifield
