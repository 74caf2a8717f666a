#pragma once

#include "luminaire/error.h"

namespace lumifield {

/// The operator's wish that a computation end. From here on SIGINT, SIGTERM and SIGHUP are answered on stderr at once
/// and end it where it next asks; a second one ends the program. A wish of before is forgotten. Thread-bound.
void stop_on_signals();
bool stop_wished();

/// The Error of a computation that was stopped.
tl::unexpected<Error> stopped_by_operator(std::string what);

}  // namespace lumifield
