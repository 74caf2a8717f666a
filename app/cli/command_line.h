#pragma once

#include "app/session/window_options.h"

namespace lumifield {

/// Opens the window and runs it; returns the program's exit code.
using RunWindow = int (*)(int argc, char** argv, const WindowOptions& options);

/// Parses the command line and runs the sub-command; without one, the window. Results go to stdout (one JSON object
/// with --json), progress and errors to stderr. Returns 0 done, 1 failed with a reason, 2 wrong use, 3 stopped by or
/// waiting for the operator.
int run_command_line(int argc, char** argv, RunWindow window);

}  // namespace lumifield
