#include "acquisition/cameras/v4l2_freshness.h"

#include <algorithm>

namespace lumifield {

void V4l2Freshness::ask(double now_s, double exposure_s, double frame_interval_s, bool is_changed) {
  earliest_s_ = now_s + exposure_s + std::max(readout_s_, frame_interval_s);
  if (is_changed) to_pass_over_ = frames_passed_over;
}

bool V4l2Freshness::counts(double stamp_s) {
  if (stamp_s < earliest_s_) return false;
  if (to_pass_over_ == 0) return true;
  --to_pass_over_;
  return false;
}

}  // namespace lumifield
