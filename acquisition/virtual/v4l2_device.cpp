#include "acquisition/virtual/v4l2_device.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <linux/videodev2.h>
#include <poll.h>

#include "acquisition/virtual/v4l2_pixels.h"

namespace lumifield::virtual_bench {
namespace {

constexpr std::uint32_t capture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::uint32_t most_buffers = 8;
constexpr std::uint32_t intervals_per_s = 10'000;
constexpr double shortest_interval_s = 0.005;

template <std::size_t N>
void write_text(__u8 (&field)[N], const std::string& text) {
  text.copy(reinterpret_cast<char*>(field), N - 1);
}

template <class T>
T cleared(const T& asked) {
  T blank;
  std::memset(&blank, 0, sizeof blank);
  blank.index = asked.index;
  return blank;
}

}  // namespace

V4l2Device::V4l2Device(const Options& options)
    : options_(options),
      controls_(options.stubborn, options.missing),
      fourcc_(options.formats.front().fourcc),
      frame_interval_s_(options.frame_interval_s) {}

std::size_t V4l2Device::row_bytes() const { return packed_row_bytes(fourcc_, options_.width_px); }

std::size_t V4l2Device::buffer_bytes() const {
  const std::size_t frame = row_bytes() * static_cast<std::size_t>(options_.height_px);
  return (frame + page_bytes - 1) / page_bytes * page_bytes;
}

int V4l2Device::answer(std::uint64_t handle, std::uint32_t request, void* data) {
  const std::lock_guard lock(mutex_);
  if (unplugged_) return ENODEV;
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& told = *static_cast<v4l2_capability*>(data);
      std::memset(&told, 0, sizeof told);
      write_text(told.driver, "lumifield");
      write_text(told.card, "Virtual");
      write_text(told.bus_info, "virtual:" + options_.serial);
      told.version = 0x060100;
      told.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_EXT_PIX_FORMAT;
      told.capabilities = told.device_caps | V4L2_CAP_DEVICE_CAPS;
      return 0;
    }
    case VIDIOC_ENUM_FMT:
    case VIDIOC_ENUM_FRAMESIZES:
    case VIDIOC_ENUMINPUT:
      return list(request, data);
    case VIDIOC_G_INPUT:
      *static_cast<int*>(data) = 0;
      return 0;
    case VIDIOC_S_INPUT:
      return *static_cast<int*>(data) == 0 ? 0 : EINVAL;
    case VIDIOC_G_FMT:
    case VIDIOC_TRY_FMT:
    case VIDIOC_S_FMT: {
      auto& format = *static_cast<v4l2_format*>(data);
      if (format.type != capture) return EINVAL;
      if (request == VIDIOC_S_FMT && owner_ != 0) return EBUSY;
      if (request == VIDIOC_G_FMT) format.fmt.pix.pixelformat = fourcc_;
      set_format(data, request == VIDIOC_S_FMT);
      return 0;
    }
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM: {
      auto& parameters = *static_cast<v4l2_streamparm*>(data);
      if (parameters.type != capture) return EINVAL;
      v4l2_fract& interval = parameters.parm.capture.timeperframe;
      if (request == VIDIOC_S_PARM && interval.denominator != 0 && !options_.keeps_pace) {
        if (streams_) return EBUSY;
        frame_interval_s_ =
            std::max(shortest_interval_s, static_cast<double>(interval.numerator) / interval.denominator);
      }
      std::memset(&parameters.parm, 0, sizeof parameters.parm);
      parameters.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
      interval = {static_cast<std::uint32_t>(std::lround(frame_interval_s_ * intervals_per_s)), intervals_per_s};
      return 0;
    }
    case VIDIOC_QUERYCTRL:
    case VIDIOC_QUERY_EXT_CTRL:
    case VIDIOC_QUERYMENU:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return controls_.answer(request, data);
    case VIDIOC_G_PRIORITY:
      *static_cast<std::uint32_t*>(data) = V4L2_PRIORITY_INTERACTIVE;
      return 0;
    case VIDIOC_S_PRIORITY:
      return 0;
    default:
      return buffers(handle, request, data);
  }
}

int V4l2Device::list(std::uint32_t request, void* data) const {
  if (request == VIDIOC_ENUM_FMT) {
    auto& entry = *static_cast<v4l2_fmtdesc*>(data);
    if (entry.type != capture || entry.index >= options_.formats.size()) return EINVAL;
    const V4l2SensorFormat& format = options_.formats[entry.index];
    entry = cleared(entry);
    entry.type = capture;
    entry.pixelformat = format.fourcc;
    entry.flags = format.is_compressed ? V4L2_FMT_FLAG_COMPRESSED : 0;
    write_text(entry.description, format.description);
  } else if (request == VIDIOC_ENUM_FRAMESIZES) {
    auto& entry = *static_cast<v4l2_frmsizeenum*>(data);
    if (entry.index != 0) return EINVAL;
    const std::uint32_t fourcc = entry.pixel_format;
    entry = cleared(entry);
    entry.pixel_format = fourcc;
    entry.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    entry.discrete = {static_cast<std::uint32_t>(options_.width_px), static_cast<std::uint32_t>(options_.height_px)};
  } else {
    auto& entry = *static_cast<v4l2_input*>(data);
    if (entry.index != 0) return EINVAL;
    entry = cleared(entry);
    write_text(entry.name, "Camera");
    entry.type = V4L2_INPUT_TYPE_CAMERA;
  }
  return 0;
}

/// What the camera makes of a format that it is asked for, as drivers do: its own size, and its first format for one
/// that it cannot give.
void V4l2Device::set_format(void* data, bool apply) {
  v4l2_pix_format& pix = static_cast<v4l2_format*>(data)->fmt.pix;
  const auto found = std::ranges::find(options_.formats, pix.pixelformat, &V4l2SensorFormat::fourcc);
  const bool is_given = found != options_.formats.end() && !found->is_compressed;
  const std::uint32_t fourcc = is_given ? pix.pixelformat : options_.formats.front().fourcc;
  if (apply) fourcc_ = fourcc;
  std::memset(&pix, 0, sizeof pix);
  pix.width = static_cast<std::uint32_t>(options_.width_px);
  pix.height = static_cast<std::uint32_t>(options_.height_px);
  pix.pixelformat = fourcc;
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = static_cast<std::uint32_t>(packed_row_bytes(fourcc, options_.width_px));
  pix.sizeimage = pix.bytesperline * pix.height;
  pix.colorspace = options_.is_for_screens ? V4L2_COLORSPACE_SRGB : V4L2_COLORSPACE_RAW;
}

void V4l2Device::describe(std::uint32_t index, void* data) const {
  auto& told = *static_cast<v4l2_buffer*>(data);
  const Buffer& buffer = buffers_[index];
  using enum Buffer::State;
  const bool is_filled = buffer.stamp_s != 0;
  told.index = index, told.type = capture, told.memory = V4L2_MEMORY_MMAP;
  told.length = static_cast<std::uint32_t>(buffer_bytes());
  told.m.offset = static_cast<std::uint32_t>(index * buffer_bytes());
  told.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE | V4L2_BUF_FLAG_MAPPED | buffer.flags |
               (buffer.state == queued || buffer.state == filling ? V4L2_BUF_FLAG_QUEUED : 0) |
               (buffer.state == done ? V4L2_BUF_FLAG_DONE : 0);
  told.sequence = buffer.sequence;
  told.timestamp.tv_sec = static_cast<time_t>(buffer.stamp_s);
  told.timestamp.tv_usec = static_cast<suseconds_t>((buffer.stamp_s - std::floor(buffer.stamp_s)) * 1e6);
  told.field = V4L2_FIELD_NONE;
  told.bytesused =
      is_filled ? static_cast<std::uint32_t>(row_bytes()) * static_cast<std::uint32_t>(options_.height_px) : 0;
}

int V4l2Device::buffers(std::uint64_t handle, std::uint32_t request, void* data) {
  using enum Buffer::State;
  auto& buffer = *static_cast<v4l2_buffer*>(data);
  switch (request) {
    case VIDIOC_REQBUFS: {
      auto& asked = *static_cast<v4l2_requestbuffers*>(data);
      if (owner_ != 0 && owner_ != handle) return EBUSY;
      if (asked.type != capture || asked.memory != V4L2_MEMORY_MMAP) return EINVAL;
      stop();
      asked.count = asked.count == 0 ? 0 : std::clamp(asked.count, 2u, most_buffers);
      asked.capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP;
      asked.flags = 0;
      buffers_.assign(asked.count, {});
      owner_ = asked.count == 0 ? 0 : handle;
      return 0;
    }
    case VIDIOC_STREAMON:
      if (owner_ != handle || *static_cast<int*>(data) != int(capture)) return EINVAL;
      if (!streams_) ++stream_, sequence_ = 0;
      streams_ = true;
      return 0;
    case VIDIOC_STREAMOFF:
      if (owner_ != 0 && owner_ != handle) return EBUSY;
      stop();
      return 0;
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
      if (buffer.type != capture || buffer.index >= buffers_.size()) return EINVAL;
      if (request == VIDIOC_QBUF) {
        if (owner_ != handle || buffers_[buffer.index].state != free) return EINVAL;
        buffers_[buffer.index] = {queued, 0, 0, 0};
        queued_.push_back(buffer.index);
      }
      describe(buffer.index, data);
      return 0;
    case VIDIOC_DQBUF:
      if (buffer.type != capture || owner_ != handle || !streams_) return EINVAL;
      if (done_.empty()) return would_block;
      buffers_[done_.front()].state = free;
      describe(done_.front(), data);
      done_.pop_front();
      return 0;
    default:
      return ENOTTY;
  }
}

void V4l2Device::stop() {
  streams_ = false;
  queued_.clear(), done_.clear();
  for (Buffer& buffer : buffers_) buffer = {};
}

void V4l2Device::close(std::uint64_t handle) {
  const std::lock_guard lock(mutex_);
  if (owner_ != handle) return;
  stop();
  buffers_.clear();
  owner_ = 0;
}

unsigned V4l2Device::poll_events(std::uint64_t handle) const {
  const std::lock_guard lock(mutex_);
  if (unplugged_) return POLLIN | POLLERR | POLLHUP;
  if (owner_ != handle || !streams_) return POLLERR;
  return done_.empty() ? 0 : POLLIN | POLLRDNORM;
}

void V4l2Device::unplug() {
  const std::lock_guard lock(mutex_);
  unplugged_ = true;
  stop();
}

std::optional<V4l2Device::Settings> V4l2Device::settings() const {
  const std::lock_guard lock(mutex_);
  if (!streams_ || unplugged_) return std::nullopt;
  return Settings{controls_.values(), fourcc_, buffer_bytes(), frame_interval_s_, stream_};
}

std::optional<std::uint32_t> V4l2Device::begin_frame(std::uint64_t stream) {
  const std::lock_guard lock(mutex_);
  if (!streams_ || stream != stream_) return std::nullopt;
  ++sequence_;
  if (queued_.empty()) return std::nullopt;
  const std::uint32_t index = queued_.front();
  queued_.pop_front();
  buffers_[index].state = Buffer::State::filling;
  buffers_[index].sequence = sequence_;
  return index;
}

void V4l2Device::lose_frame() {
  const std::lock_guard lock(mutex_);
  ++sequence_;
}

bool V4l2Device::streams(std::uint64_t stream) const {
  const std::lock_guard lock(mutex_);
  return streams_ && stream == stream_;
}

bool V4l2Device::end_frame(std::uint64_t stream, std::uint32_t index, double stamp_s, bool is_damaged) {
  const std::lock_guard lock(mutex_);
  if (!streams_ || stream != stream_) return false;
  buffers_[index].state = Buffer::State::done;
  buffers_[index].stamp_s = stamp_s;
  buffers_[index].flags = is_damaged ? V4L2_BUF_FLAG_ERROR : 0;
  done_.push_back(index);
  return true;
}

}  // namespace lumifield::virtual_bench
