#pragma once

#include <chrono>
#include <functional>

#include "luminaire/error.h"

namespace lumifield {

/// Work on threads that nobody waits for while the program runs: what may hang, as the reading of a file does whose
/// server does not answer. They belong to the program, not to those who start them: work shares or copies what it uses.
/// Thread-safe.

/// Runs `work` on a thread of its own. What it throws, and that no thread could be had, goes to `failed`, on that
/// thread or on this one; what that throws is lost.
void run_beside(const char* where, std::function<void()> work, std::function<void(const Error&)> failed);

/// Waits, `limit` at most, until all of them have ended. Where one has not, false: a program must not return from main
/// then, which would take away what the thread uses, but leave by _exit.
bool beside_ended(std::chrono::milliseconds limit);

}  // namespace lumifield
