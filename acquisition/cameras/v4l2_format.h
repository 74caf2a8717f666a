#pragma once

#include <string>
#include <vector>

#include "acquisition/cameras/v4l2_node.h"
#include "acquisition/cameras/v4l2_pixels.h"
#include "luminaire/bench.h"

namespace lumifield {

/// The picture that a camera was set to, read back from it. Value type.
struct V4l2Picture {
  V4l2PixelFormat format;
  int width_px = 0, height_px = 0;
  std::size_t stride = 0;       ///< bytes from one row to the next
  double frame_interval_s = 0;  ///< 0: the camera does not tell
  /// By a transfer function that the driver names. Where it names none, luma is taken for bent, since it is made for
  /// screens, and a sensor's own DN are not.
  bool is_bent = false;

  /// All bytes that hold photosites.
  std::size_t bytes() const { return stride * static_cast<std::size_t>(height_px - 1) + format.row_bytes(width_px); }
};

/// The formats that a camera offers, in its order. `compressed` ones lose detail and bend the response: they are never
/// measured with.
struct V4l2Formats {
  std::vector<V4l2PixelFormat> usable;
  std::vector<std::string> compressed, unknown;  ///< FourCC

  /// GenICam names of the usable ones, each once: "Mono8, Mono12".
  std::string names() const;
  /// Where nothing is usable, why.
  std::string why_none() const;
};
V4l2Formats v4l2_formats(const V4l2Node& node);
/// "; 2592x1944 px" of the usable ones; "" where the camera lists no sizes.
std::string largest_picture(const V4l2Node& node, const V4l2Formats& formats);

/// Of the formats with this GenICam name, which have the same DN, the unpacked one. Errors: not offered, with those
/// that are; a compressed one.
Result<V4l2PixelFormat> choose_format(const V4l2Node& node, const std::string& wanted);

/// Sets pixel format and size and reads them back. Of the sizes the largest is taken, unless the settings name one.
/// Errors: those of choose_format; a size not offered, with those that are; interlaced pictures; held by another
/// program.
Result<V4l2Picture> set_picture(const V4l2Node& node, const CameraSettings& settings);

/// Asks for this time from one frame to the next, or for nothing with 0. A camera may need one as long as the exposure.
/// The interval that it took; 0: it does not tell.
double set_frame_interval(const V4l2Node& node, double interval_s);

}  // namespace lumifield
