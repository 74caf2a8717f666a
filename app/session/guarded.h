#pragma once

#include <exception>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "luminaire/error.h"

namespace lumifield {

/// The border where exceptions end: what `body` returns, or the Error of what it threw. `body` returns a Result. Every
/// thread of a session runs inside one, since an exception that leaves a thread ends the program. Thread-safe.
template <class Body>
std::invoke_result_t<Body> guarded(const char* where, Body&& body) {
  try {
    return std::forward<Body>(body)();
  } catch (const std::bad_alloc&) {
    return fail("out of memory", where, "end other programs, then run again");
  } catch (const std::exception& thrown) {
    return fail(std::string("failed unexpectedly: ") + thrown.what(), where, "report this, then run again");
  } catch (...) {
    return fail("failed unexpectedly", where, "report this, then run again");
  }
}

}  // namespace lumifield
