#pragma once

#include <string>

#include "acquisition/cameras/v4l2_node.h"
#include "luminaire/bench.h"

namespace lumifield {

/// The controls of a V4L2 camera that a measurement depends on. Thread-bound; the node outlives it.
///
/// A frame means light only when nothing in the camera follows the light or bends the response. All of these, where a
/// camera has them, are switched off, then read back together, as one may switch another on again; a camera in which
/// one of them stays is refused:
///   automatic exposure, gain, white balance, hue, chroma, brightness, focus and sensitivity; backlight compensation,
///   wide dynamic range, scene modes, image stabilisation; the power-line filter, which moves the exposure to whole
///   periods of the mains; gamma, whose 100 means 1.
class V4l2Controls {
 public:
  /// Switches off, sets the gain, and reads all back. Errors: an automatic that stays on, a gamma that cannot be made
  /// 1, a gain out of range, no exposure in seconds.
  static Result<V4l2Controls> apply(const V4l2Node& node, const CameraSettings& settings);
  /// apply() made its gamma 1; without such a control it may bend the response, or not.
  bool have_gamma() const { return have_gamma_; }
  /// What would make apply() refuse a camera, as far as can be told without changing it; empty when nothing.
  static std::string shortcoming(const V4l2Node& node);
  /// That its gain can be set to this number.
  static Status check_gain(const V4l2Node& node, double gain);
  /// "exposures of 0.0001 to 1 s; gain 0 to 100, not in dB", of a camera without shortcoming.
  static std::string capabilities(const V4l2Node& node);

  /// Sets the exposure time, in whole units of 100 µs, and returns what the control then says. Errors: out of range.
  Result<double> set_exposure(double exposure_s) const;

 private:
  explicit V4l2Controls(const V4l2Node& node) : node_(&node) {}

  const V4l2Node* node_;
  bool have_gamma_ = false;
  int shortest_ = 0, longest_ = 0;  // units
};

}  // namespace lumifield
