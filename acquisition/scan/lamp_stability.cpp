#include "acquisition/scan/lamp_stability.h"

#include <algorithm>
#include <cassert>

namespace lumifield {

void LampStability::add(double time_s, double signal) {
  assert(signal > 0);
  readings_.push_back({time_s, signal});
  while (readings_.size() > fewest && time_s - readings_[1].time_s >= wanted_.over_s) readings_.pop_front();
}

std::optional<double> LampStability::spread() const {
  if (readings_.size() < 2) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(readings_, {}, &Reading::signal);
  return (high.signal - low.signal) / low.signal;
}

bool LampStability::judges() const {
  return readings_.size() >= fewest && readings_.back().time_s - readings_.front().time_s >= wanted_.over_s;
}

bool LampStability::steady() const { return judges() && *spread() <= wanted_.within; }

}  // namespace lumifield
