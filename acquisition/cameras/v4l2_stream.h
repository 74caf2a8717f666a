#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/cameras/v4l2_format.h"

namespace lumifield {

/// The frames of a camera that streams into mapped memory. Thread-bound; the node outlives it.
class V4l2Stream {
 public:
  struct Frame {
    bool is_complete = false;                  ///< whole, and without an error
    std::uint32_t sequence = 0;                ///< the driver's count, lost ones included
    double stamp_s = 0;                        ///< CLOCK_MONOTONIC
    std::span<const std::uint8_t> bytes = {};  ///< until the frame is given back
    std::uint32_t buffer = 0;
  };
  struct Arrival {
    enum class Kind { frame, nothing, gone } kind = Kind::nothing;
    Frame frame;
    std::string how_gone;
  };

  /// Makes the buffers and starts the stream. Errors: another program streams, no memory, time stamps of another clock.
  static Result<V4l2Stream> start(const V4l2Node& node, const V4l2Picture& picture);
  ~V4l2Stream();
  V4l2Stream(V4l2Stream&& other) noexcept;
  V4l2Stream& operator=(V4l2Stream&&) = delete;

  /// The next frame, waited for `wait_s`; the caller gives it back.
  Arrival next(double wait_s);
  void give_back(const Frame& frame);

 private:
  struct Mapping {
    void* memory;
    std::size_t bytes;
  };
  V4l2Stream(const V4l2Node& node, const V4l2Picture& picture) : node_(&node), picture_(picture) {}
  Status map_buffers();
  Status map_buffer(std::uint32_t index);
  Arrival take();
  static Arrival gone(int failure);

  const V4l2Node* node_;
  V4l2Picture picture_;
  std::vector<Mapping> mappings_;
};

}  // namespace lumifield
