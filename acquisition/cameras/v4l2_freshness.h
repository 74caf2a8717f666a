#pragma once

#include <cstdint>

namespace lumifield {

/// Which frame of a free-running camera is the answer to a question. Value type; times are of CLOCK_MONOTONIC, s.
///
/// A V4L2 camera exposes frame after frame whether anybody asks or not, and a driver's time stamp says only when a
/// frame came: it is the end of the frame, or, where it is called the start of the exposure, often the arrival of the
/// first packet, which is after the exposure too. Both are therefore taken for the end of the read-out, the latest that
/// they can be: an exposure is known to have begun only by
///
///     time stamp − exposure time − max(read-out, frame interval)
///
/// where the frame interval bounds the read-out of a camera that keeps its rate, and the bench file's `readout_s` is
/// there for those which hold frames back longer. A frame counts when that is after the question was asked.
///
/// A control acts some frames after it was set: sensors latch it at the next frame's start, one more is in the pipeline
/// by then, and USB cameras apply it a frame later still. After a change, therefore, as many frames that began after it
/// are passed over, and the next one counts.
class V4l2Freshness {
 public:
  static constexpr int frames_passed_over = 3;

  explicit V4l2Freshness(double readout_s) : readout_s_(readout_s) {}

  /// The exposure time of the frames now asked for, at `now_s`; the latest change of a control is over.
  void ask(double now_s, double exposure_s, double frame_interval_s, bool is_changed);
  /// Whether the next frame, with this time stamp, counts. Asked once a frame.
  bool counts(double stamp_s);

 private:
  double readout_s_;
  double earliest_s_ = 0;  // time stamp
  int to_pass_over_ = 0;
};

}  // namespace lumifield
