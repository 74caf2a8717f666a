#include <algorithm>
#include <filesystem>
#include <linux/videodev2.h>

#include "acquisition/cameras/v4l2_camera.h"
#include "acquisition/cameras/v4l2_controls.h"
#include "acquisition/cameras/v4l2_format.h"
#include "acquisition/cameras/v4l2_node.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

/// /dev/video*, in the order of their numbers.
std::vector<std::string> device_paths() {
  std::vector<std::pair<long, std::string>> numbered;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename();
    const std::string digits = name.starts_with("video") ? name.substr(5) : "";
    if (!digits.empty() && digits.size() < 9 && digits.find_first_not_of("0123456789") == std::string::npos)
      numbered.emplace_back(std::stol(digits), entry.path());
  }
  std::ranges::sort(numbered);
  std::vector<std::string> paths;
  for (auto& [number, path] : numbered) paths.push_back(std::move(path));
  return paths;
}

/// Whether another program streams: it then has the buffers, and none are asked for here.
Status check_free(const V4l2Node& node) {
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, none.memory = V4L2_MEMORY_MMAP;
  if (const int failure = node.call(VIDIOC_REQBUFS, &none); failure != 0) return node.refused("a stream", failure);
  return {};
}

DeviceReport report_of(const V4l2Node& node) {
  DeviceReport report{"camera", node.vendor() + " " + node.model() + " " + node.serial(), node.path(), false, {}, {}};
  const V4l2Formats formats = v4l2_formats(node);
  if (formats.usable.empty()) {
    report.reason = formats.why_none(), report.remedy = "use a camera with uncompressed pictures";
  } else if (report.reason = V4l2Controls::shortcoming(node); !report.reason.empty()) {
    report.remedy = "use a camera that can be set by hand";
  } else if (const Status free = check_free(node); !free) {
    report.reason = free.error().what, report.remedy = free.error().remedy;
  } else {
    report.usable = true;
    report.capabilities = formats.names() + largest_picture(node, formats) + "; " + V4l2Controls::capabilities(node);
  }
  return report;
}

DeviceReport unusable(const std::string& path, const Error& error) {
  return {"camera", {}, path, false, error.what, error.remedy};
}

}  // namespace

std::vector<DeviceReport> find_v4l2_cameras() {
  std::vector<DeviceReport> reports;
  for (const std::string& path : device_paths()) {
    const Result<V4l2Node> node = V4l2Node::open(path);
    // Decoders and a camera's second node, of its metadata, are none: of those that open only cameras are told.
    if (node)
      reports.push_back(report_of(*node));
    else if (!node.error().what.starts_with("is no camera"))
      reports.push_back(unusable(path, node.error()));
  }
  return reports;
}

DeviceReport probe_v4l2_camera(const CameraSettings& settings) {
  const Result<V4l2Node> node = V4l2Node::open(settings.address);
  if (!node) return unusable(settings.address, node.error());
  DeviceReport report = report_of(*node);
  if (report.usable) {
    Status offered = V4l2Controls::check_gain(*node, settings.gain);
    if (const auto format = choose_format(*node, settings.pixel_format); !format)
      offered = tl::unexpected(format.error());
    if (!offered) report.usable = false, report.reason = offered.error().what, report.remedy = offered.error().remedy;
  }
  std::error_code ignored;
  if (const fs::path device = fs::canonical(settings.address, ignored); !device.empty()) report.address = device;
  return report;
}

}  // namespace lumifield
