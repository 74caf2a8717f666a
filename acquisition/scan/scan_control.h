#pragma once

#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>

#include "luminaire/light_field.h"

namespace lumifield {

/// What the operator asks of a scan that runs: to pause and go on, and to take cells again. The scanner obeys between
/// two steps; it pauses by itself when it is in trouble. Thread-safe.
class ScanControl {
 public:
  void pause();
  void resume();
  bool paused() const;
  /// Returns when nobody pauses the scan any more or `stop` is requested.
  void wait_while_paused(std::stop_token stop);

  /// Somebody is there to answer: a trouble that the scan cannot help itself pauses it. Without, it ends the scan.
  void attend();
  bool attended() const;

  /// These cells are taken next, in this order; one that waits already keeps its place.
  void retake(std::span<const CellIndex> cells);
  /// The next of them, taken off the list.
  std::optional<CellIndex> next_retake();

 private:
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  bool paused_ = false, attended_ = false;
  std::deque<CellIndex> retakes_;
};

}  // namespace lumifield
