#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "acquisition/virtual/v4l2_device.h"
#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// A V4L2 device as a file that any program opens, sets by ioctl, polls and maps: FUSE serves it, and the kernel does
/// the rest, as with a driver. Frames go straight into the pages that the program has mapped. It is no character
/// device, which programs do not ask for.
///
/// The file is FOLDER/video0; the folder is made, and gone with the camera. After a kill -9 a dead mount is left:
/// `umount FOLDER`, or `fusermount3 -u FOLDER`. Own thread. Thread-safe.
class VideoFile {
 public:
  /// Errors: no /dev/fuse, no right to mount.
  static Result<std::unique_ptr<VideoFile>> mount(const std::filesystem::path& folder, V4l2Device& device);
  /// Waits half a second for those who still hold it open, who are told ENODEV if the device is unplugged.
  ~VideoFile();

  std::filesystem::path path() const;

  /// A frame's bytes become those of a buffer.
  void store(std::uint32_t buffer, std::span<const std::uint8_t> bytes);
  /// Wakes those who wait for a frame.
  void notify();

 private:
  struct Impl;
  explicit VideoFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
