#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lumifield {

/// How a GigE Vision camera cuts its frames up: bytes of a packet, and the pause between two. Value type.
struct StreamPackets {
  int bytes = 8192;
  double delay_us = 0;
  bool operator==(const StreamPackets&) const = default;
};

/// Of `frames_per_try` test frames those that arrived complete; it may stop when the first ones did not.
using TryPackets = std::function<int(const StreamPackets&)>;
inline constexpr int frames_per_try = 4;

/// The largest packets that the network passes, by test frames, from the camera's largest down: taken are the first
/// with which all arrive, if need be with pauses, the shortest that helps; else those with which most do. Nothing when
/// no frame arrives.
std::optional<StreamPackets> find_packets(int smallest_bytes, int largest_bytes, int step_bytes, const TryPackets& ask);

/// What was found for a camera since this program began, so that one that is opened again is not asked again.
/// Thread-safe.
std::optional<StreamPackets> remembered_packets(const std::string& camera);
void remember_packets(const std::string& camera, const std::optional<StreamPackets>& packets);

}  // namespace lumifield
