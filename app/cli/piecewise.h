#pragma once

#include <chrono>
#include <string>

#include "app/cli/status_line.h"
#include "luminaire/error.h"

namespace lumifield {

/// A computation in pieces of this length, so that the operator is told how it goes and can stop it.
inline constexpr double piece_s = 1;

/// Progress on stderr of a computation that takes longer than a second: share, time passed, time left. Thread-bound.
class Piecewise {
 public:
  /// `what` is computed: "light".
  explicit Piecewise(std::string what) : what_(std::move(what)) {}
  ~Piecewise() { line_.end(); }
  Piecewise(const Piecewise&) = delete;
  Piecewise& operator=(const Piecewise&) = delete;

  /// After a piece; `share` of all is done. Errors: the operator's wish to stop.
  Status done(double share);

 private:
  std::string what_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double shown_s_ = 0;  ///< after the start
  StatusLine line_;
};

}  // namespace lumifield
