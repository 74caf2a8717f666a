#include "acquisition/scan/scan_control.h"

#include <algorithm>

namespace lumifield {

void ScanControl::pause() {
  std::lock_guard lock(mutex_);
  paused_ = true;
}

void ScanControl::resume() {
  std::lock_guard lock(mutex_);
  paused_ = false;
  changed_.notify_all();
}

bool ScanControl::paused() const {
  std::lock_guard lock(mutex_);
  return paused_;
}

void ScanControl::wait_while_paused(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, std::move(stop), [this] { return !paused_; });
}

void ScanControl::attend() {
  std::lock_guard lock(mutex_);
  attended_ = true;
}

bool ScanControl::attended() const {
  std::lock_guard lock(mutex_);
  return attended_;
}

void ScanControl::retake(std::span<const CellIndex> cells) {
  std::lock_guard lock(mutex_);
  for (const CellIndex cell : cells)
    if (std::ranges::find(retakes_, cell) == retakes_.end()) retakes_.push_back(cell);
}

std::optional<CellIndex> ScanControl::next_retake() {
  std::lock_guard lock(mutex_);
  if (retakes_.empty()) return std::nullopt;
  const CellIndex next = retakes_.front();
  retakes_.pop_front();
  return next;
}

}  // namespace lumifield
