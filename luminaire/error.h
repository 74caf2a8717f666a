#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace lumifield {

/// What an Error means for the program: something is at fault, the operator asked to stop, nothing goes on without the
/// operator's word, the disk is full and the same works once there is room, or a device that is well was asked for what
/// it does not have, and will not have when it is opened again.
enum class ErrorKind { fault, stopped, waiting, disk_full, refused };

/// An expected failure: what went wrong, where, and what the operator can do about it.
///
/// A device that is unplugged, a file that is truncated, a plan that does not fit its bench are values of this type and
/// travel in a `Result`. Bugs are asserts. Exceptions come from wrapped libraries only and end at that wrapper.
/// Value type.
struct Error {
  std::string what;    ///< the fault, one clause without a full stop: "the stage did not answer within 2 s"
  std::string where;   ///< the thing at fault: a path, "path: key", a device address, "cell (3, 4)"
  std::string remedy;  ///< what to do: "check the cable, then run again with --resume"
  ErrorKind kind = ErrorKind::fault;

  /// One line for people: "where: what; remedy".
  std::string message() const {
    std::string text = where.empty() ? what : where + ": " + what;
    if (!remedy.empty()) text += "; " + remedy;
    return text;
  }
};

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

/// Use as `return fail("what", "where", "remedy");` in a function that returns a Result.
inline tl::unexpected<Error> fail(std::string what, std::string where, std::string remedy = {}) {
  return tl::unexpected<Error>(Error{std::move(what), std::move(where), std::move(remedy)});
}

/// The same error, as one that asking again does not mend: ErrorKind::refused.
inline tl::unexpected<Error> refused_for_good(Error error) {
  error.kind = ErrorKind::refused;
  return tl::unexpected<Error>(std::move(error));
}

/// Passes an error on with a larger place in front of its own: "bench.json" + ": " + "camera.address".
inline tl::unexpected<Error> fail_in(std::string_view place, Error error) {
  error.where = error.where.empty() ? std::string(place) : std::string(place) + ": " + error.where;
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace lumifield
