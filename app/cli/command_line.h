#pragma once

#include <filesystem>

#include "app/session/window_options.h"
#include "luminaire/error.h"

namespace lumifield {

struct Study;

/// Opens the window and runs it; returns the program's exit code.
using RunWindow = int (*)(int argc, char** argv, const WindowOptions& options);

/// Writes a study's chart into a folder, with or without a display.
using WriteStudyChart = Status (*)(const Study& study, const std::filesystem::path& folder);

/// Parses the command line and runs the sub-command; without one, the window. Results go to stdout (one JSON object
/// with --json), progress and errors to stderr. Returns 0 done, 1 failed with a reason, 2 wrong use, 3 stopped by or
/// waiting for the operator.
int run_command_line(int argc, char** argv, RunWindow window, WriteStudyChart write_chart);

}  // namespace lumifield
