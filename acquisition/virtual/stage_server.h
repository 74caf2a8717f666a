#pragma once

#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield::virtual_bench {

/// A simulated two-axis stage on a real transport, and what can go wrong with it. Thread-safe.
class StageServer {
 public:
  virtual ~StageServer() = default;

  /// Where the carriage is now, whatever its controller claims.
  virtual Vec2 true_position_mm() const = 0;
  /// Where it is less what the controller claims.
  virtual Vec2 off_mm() const = 0;

  /// Each later move of more than 2 mm falls short by this.
  virtual void lose_steps(double mm_per_move) = 0;
  virtual void set_backlash(double mm) = 0;  ///< of either axis
  virtual void stick(bool stuck) = 0;        ///< the axes stop and the state stays what it is
  virtual void silence(bool silent) = 0;     ///< nothing is answered
  virtual void trip_limit() = 0;             ///< a limit switch closes now
  /// Takes the cable out, or puts it in again. Errors: a transport that cannot.
  virtual Status unplug(bool out) = 0;
};

}  // namespace lumifield::virtual_bench
