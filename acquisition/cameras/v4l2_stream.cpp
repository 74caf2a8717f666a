#include "acquisition/cameras/v4l2_stream.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstring>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <utility>

namespace lumifield {
namespace {

constexpr std::uint32_t buffers_wanted = 4, most_buffers = 32;

v4l2_buffer capture_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.index = index, buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

int request_buffers(const V4l2Node& node, std::uint32_t& count) {
  v4l2_requestbuffers request{};
  request.count = count, request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, request.memory = V4L2_MEMORY_MMAP;
  const int failure = node.call(VIDIOC_REQBUFS, &request);
  count = request.count;
  return failure;
}

}  // namespace

Result<V4l2Stream> V4l2Stream::start(const V4l2Node& node, const V4l2Picture& picture) {
  V4l2Stream stream(node, picture);
  if (Status mapped = stream.map_buffers(); !mapped) return tl::unexpected(mapped.error());
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const int failure = node.call(VIDIOC_STREAMON, &type);
  if (failure == ENOSPC)
    return node.error("the USB bus has no room for its stream",
                      "take other cameras off this USB bus, or choose a "
                      "smaller picture");
  if (failure != 0) return node.refused("a start of its stream", failure);
  return stream;
}

Status V4l2Stream::map_buffers() {
  std::uint32_t count = buffers_wanted;
  if (const int failure = request_buffers(*node_, count); failure != 0) return node_->refused("a stream", failure);
  if (count == 0 || count > most_buffers)
    return node_->error("gives " + std::to_string(count) + " frame buffers for " + std::to_string(buffers_wanted),
                        "close other programs, or choose a smaller picture");
  for (std::uint32_t i = 0; i < count; ++i)
    if (Status mapped = map_buffer(i); !mapped) return mapped;
  return {};
}

Status V4l2Stream::map_buffer(std::uint32_t index) {
  v4l2_buffer buffer = capture_buffer(index);
  if (const int failure = node_->call(VIDIOC_QUERYBUF, &buffer); failure != 0)
    return node_->refused("a question for its frame buffers", failure);
  if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
    return node_->error("does not tell when its frames were taken", "use a camera whose driver stamps its frames");
  // Only read: the camera writes. Its memory is what mmap gives, page cache or device memory.
  void* const memory =
      mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, node_->descriptor(), static_cast<off_t>(buffer.m.offset));
  if (memory == MAP_FAILED)
    return node_->error(std::string("its frame buffers cannot be mapped (") + std::strerror(errno) + ")",
                        "close other programs, or choose a smaller picture");
  mappings_.push_back({memory, buffer.length});
  if (buffer.length < picture_.bytes())
    return node_->error("gives frame buffers of " + std::to_string(buffer.length) + " bytes for frames of " +
                            std::to_string(picture_.bytes()),
                        "choose another pixel format");
  if (const int failure = node_->call(VIDIOC_QBUF, &buffer); failure != 0)
    return node_->refused("a frame buffer", failure);
  return {};
}

V4l2Stream::V4l2Stream(V4l2Stream&& other) noexcept
    : node_(other.node_), picture_(other.picture_), mappings_(std::exchange(other.mappings_, {})) {}

V4l2Stream::~V4l2Stream() {
  if (mappings_.empty()) return;
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  node_->call(VIDIOC_STREAMOFF, &type);
  for (const Mapping& mapping : mappings_) munmap(mapping.memory, mapping.bytes);
  std::uint32_t none = 0;
  request_buffers(*node_, none);
}

V4l2Stream::Arrival V4l2Stream::gone(int failure) { return {Arrival::Kind::gone, {}, std::strerror(failure)}; }

V4l2Stream::Arrival V4l2Stream::next(double wait_s) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(wait_s);
  while (true) {
    const double left_s = std::max(0.0, std::chrono::duration<double>(deadline - Clock::now()).count());
    pollfd readable{node_->descriptor(), POLLIN, 0};
    const int ready = poll(&readable, 1, static_cast<int>(std::ceil(left_s * 1e3)));
    if (ready < 0 && errno != EINTR) return gone(errno);
    if (ready == 0) return {};
    if (ready < 0) continue;
    Arrival arrival = take();
    const bool is_broken = (readable.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    if (arrival.kind == Arrival::Kind::nothing && is_broken) {
      const int failure = node_->check();
      return gone(failure != 0 ? failure : EPIPE);
    }
    if (arrival.kind != Arrival::Kind::nothing || left_s == 0) return arrival;
  }
}

V4l2Stream::Arrival V4l2Stream::take() {
  v4l2_buffer buffer = capture_buffer(0);
  const int failure = node_->call(VIDIOC_DQBUF, &buffer);
  if (means_gone(failure)) return gone(failure);
  if (failure == EIO) return {Arrival::Kind::frame, {.buffer = most_buffers}, {}};  // none was taken out of the queue
  if (failure == EAGAIN) return {};
  if (failure != 0) return gone(failure);
  if (buffer.index >= mappings_.size()) return gone(EPROTO);
  Frame frame;
  frame.is_complete = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.bytesused >= picture_.bytes();
  frame.sequence = buffer.sequence;
  frame.stamp_s = static_cast<double>(buffer.timestamp.tv_sec) + 1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  frame.bytes = {static_cast<const std::uint8_t*>(mappings_[buffer.index].memory), mappings_[buffer.index].bytes};
  frame.buffer = buffer.index;
  return {Arrival::Kind::frame, frame, {}};
}

void V4l2Stream::give_back(const Frame& frame) {
  if (frame.buffer >= mappings_.size()) return;
  v4l2_buffer buffer = capture_buffer(frame.buffer);
  node_->call(VIDIOC_QBUF, &buffer);  // a camera that is gone says so when it is asked for the next frame
}

}  // namespace lumifield
