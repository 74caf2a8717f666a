#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "acquisition/virtual/v4l2_control_panel.h"

namespace lumifield::virtual_bench {

/// A format that the sensor's DN are given in.
struct V4l2SensorFormat {
  std::uint32_t fourcc;
  const char* description;
  bool is_compressed = false;  ///< only listed
};
/// Those of a sensor with pixels of this GenICam format: the same and coarser ones, and MJPG.
std::vector<V4l2SensorFormat> v4l2_sensor_formats(const std::string& pixel_format);

/// What stands behind a V4L2 device file: the driver's answers and its queue of buffers, without the transport.
/// Thread-safe.
///
///     idle ── REQBUFS ──▶ prepared ── STREAMON ──▶ streaming ── STREAMOFF ──▶ prepared ── REQBUFS 0, close ──▶ idle
///
/// One file handle owns the buffers; others may ask and set controls. Unplugged, every request is answered ENODEV.
/// Source: Linux Media Subsystem Documentation, Video for Linux API.
class V4l2Device {
 public:
  struct Options {
    std::string serial;
    std::vector<V4l2SensorFormat> formats;
    int width_px = 0, height_px = 0;
    double frame_interval_s = 0;
    bool keeps_pace = false;  ///< whatever is asked of it
    std::set<std::uint32_t> stubborn, missing;
    bool is_for_screens = false;
  };
  explicit V4l2Device(const Options& options);

  static constexpr std::size_t page_bytes = 4096;
  static constexpr int would_block = -1;

  /// Answers a request with its structure in `data`: 0, errno, or would_block of a DQBUF without a frame.
  int answer(std::uint64_t handle, std::uint32_t request, void* data);
  void close(std::uint64_t handle);
  /// POLLIN, POLLERR …
  unsigned poll_events(std::uint64_t handle) const;
  void unplug();

  /// What the sensor is set to at the start of a frame; none while nothing streams.
  struct Settings {
    std::map<std::uint32_t, int> controls;
    std::uint32_t fourcc;
    std::size_t buffer_bytes;
    double frame_interval_s;
    std::uint64_t stream;  ///< counted
  };
  std::optional<Settings> settings() const;
  /// A buffer to be filled, where there is one. Each frame counts, with or without.
  std::optional<std::uint32_t> begin_frame(std::uint64_t stream);
  /// A frame that only the count tells of.
  void lose_frame();
  bool streams(std::uint64_t stream) const;
  /// The buffer holds a frame. False: its stream has ended meanwhile.
  bool end_frame(std::uint64_t stream, std::uint32_t buffer, double stamp_s, bool is_damaged);

 private:
  struct Buffer {
    enum class State { free, queued, filling, done } state = State::free;
    std::uint32_t sequence = 0, flags = 0;
    double stamp_s = 0;
  };
  std::size_t row_bytes() const;
  std::size_t buffer_bytes() const;
  void set_format(void* format, bool apply);
  int list(std::uint32_t request, void* data) const;
  int buffers(std::uint64_t handle, std::uint32_t request, void* data);
  void describe(std::uint32_t index, void* buffer) const;
  void stop();

  const Options options_;
  mutable std::mutex mutex_;  // guards what follows
  V4l2ControlPanel controls_;
  std::uint32_t fourcc_;
  double frame_interval_s_;
  std::vector<Buffer> buffers_;
  std::deque<std::uint32_t> queued_, done_;
  std::uint64_t owner_ = 0, stream_ = 0;
  std::uint32_t sequence_ = 0;
  bool streams_ = false, unplugged_ = false;
};

}  // namespace lumifield::virtual_bench
