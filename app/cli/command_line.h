#pragma once

namespace lumifield {

/// Parses the command line and runs the sub-command. Results go to stdout (one JSON object with --json), progress and
/// errors to stderr.
/// Returns 0 done, 1 failed with a reason, 2 wrong use, 3 stopped by or waiting for the operator.
int run_command_line(int argc, char** argv);

}  // namespace lumifield
