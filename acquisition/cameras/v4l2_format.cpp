#include "acquisition/cameras/v4l2_format.h"

#include <algorithm>
#include <cmath>
#include <linux/videodev2.h>

namespace lumifield {
namespace {

constexpr std::uint32_t type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr int longest_side_px = 1 << 16;
constexpr std::uint32_t most_entries = 1000;  // of an endless list

struct Size {
  int width_px = 0, height_px = 0;
  std::string text() const { return std::to_string(width_px) + "x" + std::to_string(height_px); }
  long area() const { return long{width_px} * height_px; }
};

std::string join(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += (all.empty() ? "" : ", ") + text;
  return all;
}

/// Sizes that the camera lists for a format, or the ends of its range.
std::vector<Size> sizes_of(const V4l2Node& node, std::uint32_t fourcc) {
  std::vector<Size> sizes;
  const auto add = [&](std::uint32_t width, std::uint32_t height) {
    if (width > 0 && height > 0 && width <= longest_side_px && height <= longest_side_px)
      sizes.push_back({static_cast<int>(width), static_cast<int>(height)});
  };
  for (std::uint32_t i = 0; i < most_entries; ++i) {
    v4l2_frmsizeenum entry{};
    entry.index = i, entry.pixel_format = fourcc;
    if (node.call(VIDIOC_ENUM_FRAMESIZES, &entry) != 0) break;
    if (entry.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      add(entry.discrete.width, entry.discrete.height);
      continue;
    }
    add(entry.stepwise.min_width, entry.stepwise.min_height);
    add(entry.stepwise.max_width, entry.stepwise.max_height);
    break;
  }
  return sizes;
}

}  // namespace

Result<V4l2PixelFormat> choose_format(const V4l2Node& node, const std::string& wanted) {
  const V4l2Formats offered = v4l2_formats(node);
  if (std::ranges::find(offered.compressed, wanted) != offered.compressed.end())
    return node.error(
        "its pixel format " + wanted + " is compressed: it drops detail and bends the response",
        offered.usable.empty() ? "use a camera with uncompressed pictures" : "choose one of " + offered.names());
  if (offered.usable.empty()) return node.error(offered.why_none(), "use a camera with uncompressed pictures");
  const V4l2PixelFormat* chosen = nullptr;
  for (const V4l2PixelFormat& format : offered.usable)
    if (format.name == wanted && (chosen == nullptr || format.packing < chosen->packing)) chosen = &format;
  if (chosen == nullptr)
    return node.error("does not offer the pixel format \"" + wanted + "\"", "choose one of " + offered.names());
  return *chosen;
}

std::string V4l2Formats::names() const {
  std::vector<std::string> once;
  for (const V4l2PixelFormat& format : usable)
    if (std::ranges::find(once, format.name) == once.end()) once.emplace_back(format.name);
  return join(once);
}

std::string V4l2Formats::why_none() const {
  std::string why = "offers no pixel format that can be measured with";
  if (!compressed.empty()) why += "; compressed, which drops detail and bends the response: " + join(compressed);
  if (!unknown.empty()) why += "; not known: " + join(unknown);
  return why;
}

V4l2Formats v4l2_formats(const V4l2Node& node) {
  V4l2Formats formats;
  for (std::uint32_t i = 0; i < most_entries; ++i) {
    v4l2_fmtdesc entry{};
    entry.index = i, entry.type = type;
    if (node.call(VIDIOC_ENUM_FMT, &entry) != 0) break;
    const auto known = v4l2_pixel_format(entry.pixelformat);
    if ((entry.flags & V4L2_FMT_FLAG_COMPRESSED) != 0)
      formats.compressed.push_back(fourcc_text(entry.pixelformat));
    else if ((entry.flags & V4L2_FMT_FLAG_EMULATED) == 0 && known)
      formats.usable.push_back(*known);
    else
      formats.unknown.push_back(fourcc_text(entry.pixelformat));
  }
  return formats;
}

std::string largest_picture(const V4l2Node& node, const V4l2Formats& formats) {
  Size largest;
  for (const V4l2PixelFormat& format : formats.usable)
    for (const Size& size : sizes_of(node, format.fourcc))
      if (size.area() > largest.area()) largest = size;
  return largest.area() > 0 ? "; " + largest.text() + " px" : "";
}

namespace {

bool is_bent(const v4l2_pix_format& pix, PixelPacking packing) {
  const bool is_told = pix.priv == V4L2_PIX_FMT_PRIV_MAGIC && pix.xfer_func != V4L2_XFER_FUNC_DEFAULT;
  if (is_told) return pix.xfer_func != V4L2_XFER_FUNC_NONE;
  const bool is_luma = packing == PixelPacking::luma_first || packing == PixelPacking::luma_second;
  return is_luma && pix.colorspace != V4L2_COLORSPACE_RAW;
}

}  // namespace

Result<V4l2Picture> set_picture(const V4l2Node& node, const CameraSettings& settings) {
  const Result<V4l2PixelFormat> format = choose_format(node, settings.pixel_format);
  if (!format) return tl::unexpected(format.error());
  const std::vector<Size> sizes = sizes_of(node, format->fourcc);
  v4l2_format now{};
  now.type = type;
  if (const int failure = node.call(VIDIOC_G_FMT, &now); failure != 0)
    return node.refused("a question for its picture", failure);
  v4l2_pix_format& pix = now.fmt.pix;
  Size wanted{settings.width_px, settings.height_px};
  if (wanted.area() == 0)
    wanted = sizes.empty() ? Size{static_cast<int>(pix.width), static_cast<int>(pix.height)}
                           : *std::ranges::max_element(sizes, {}, &Size::area);
  pix.width = static_cast<std::uint32_t>(wanted.width_px), pix.height = static_cast<std::uint32_t>(wanted.height_px);
  pix.pixelformat = format->fourcc, pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = pix.sizeimage = 0;
  if (const int failure = node.call(VIDIOC_S_FMT, &now); failure != 0)
    return node.refused("the pixel format " + settings.pixel_format, failure);

  if (pix.pixelformat != format->fourcc)
    return node.error("took the pixel format " + fourcc_text(pix.pixelformat) + " for " + fourcc_text(format->fourcc),
                      "choose one of " + v4l2_formats(node).names());
  if (pix.width != static_cast<std::uint32_t>(wanted.width_px) ||
      pix.height != static_cast<std::uint32_t>(wanted.height_px)) {
    std::vector<std::string> texts;
    for (const Size& size : sizes) texts.push_back(size.text());
    return node.error("does not offer pictures of " + wanted.text() + " px as " + settings.pixel_format,
                      texts.empty() ? "choose a size from its manual" : "choose one of " + join(texts));
  }
  if (pix.field != V4L2_FIELD_NONE)
    return node.error("gives interlaced pictures: their halves are exposed at different times",
                      "use a camera with progressive scan");
  const std::size_t row = format->row_bytes(wanted.width_px);
  const V4l2Picture picture{*format,
                            wanted.width_px,
                            wanted.height_px,
                            std::max<std::size_t>(pix.bytesperline, row),
                            set_frame_interval(node, 0),
                            is_bent(pix, format->packing)};
  if ((pix.bytesperline != 0 && pix.bytesperline < row) || pix.sizeimage < picture.bytes())
    return node.error(
        "announces frames of " + std::to_string(pix.sizeimage) + " bytes, rows of " + std::to_string(pix.bytesperline),
        "its driver is at fault: choose another pixel format");
  return picture;
}

double set_frame_interval(const V4l2Node& node, double interval_s) {
  v4l2_streamparm parameters{};
  parameters.type = type;
  if (node.call(VIDIOC_G_PARM, &parameters) != 0) return 0;
  v4l2_fract& interval = parameters.parm.capture.timeperframe;
  const auto told_s = [&] {
    return interval.denominator == 0 ? 0 : static_cast<double>(interval.numerator) / interval.denominator;
  };
  if (interval_s == 0 || (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) == 0) return told_s();
  constexpr std::uint32_t per_s = 10'000;  // the unit of exposures, too
  interval = {static_cast<std::uint32_t>(std::ceil(interval_s * per_s)), per_s};
  node.call(VIDIOC_S_PARM, &parameters);  // what it took is what is told next
  return node.call(VIDIOC_G_PARM, &parameters) == 0 ? told_s() : 0;
}

}  // namespace lumifield
