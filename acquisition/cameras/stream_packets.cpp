#include "acquisition/cameras/stream_packets.h"

#include <algorithm>
#include <map>
#include <mutex>

namespace lumifield {
namespace {

/// Jumbo frames of network cards, then what passes almost anywhere, and the smallest that every host must take.
constexpr int usual_bytes[] = {9000, 8192, 4096, 2048, 1500, 1400, 576};
constexpr double delays_us[] = {10, 40, 160};

struct Memory {
  std::mutex mutex;
  std::map<std::string, StreamPackets> packets;
};
Memory& memory() {
  static Memory found;
  return found;
}

}  // namespace

std::optional<StreamPackets> find_packets(int smallest_bytes, int largest_bytes, int step_bytes,
                                          const TryPackets& ask) {
  std::vector<int> sizes{largest_bytes};
  for (const int bytes : usual_bytes)
    if (bytes >= smallest_bytes && bytes < largest_bytes)
      sizes.push_back(smallest_bytes + (bytes - smallest_bytes) / step_bytes * step_bytes);
  std::optional<StreamPackets> best;
  int most = 0;
  const auto is_enough = [&](const StreamPackets& packets) {
    const int complete = ask(packets);
    if (complete > most) most = complete, best = packets;
    return complete;
  };
  for (const int bytes : sizes) {
    const int complete = is_enough({bytes, 0});
    if (complete == frames_per_try) return best;
    // A pause helps where some arrive; what the network never passes does not become smaller by it.
    for (const double delay_us : delays_us)
      if (complete > 0 && is_enough({bytes, delay_us}) == frames_per_try) return best;
  }
  return best;
}

std::optional<StreamPackets> remembered_packets(const std::string& camera) {
  const std::lock_guard lock(memory().mutex);
  const auto found = memory().packets.find(camera);
  return found == memory().packets.end() ? std::nullopt : std::optional(found->second);
}

void remember_packets(const std::string& camera, const std::optional<StreamPackets>& packets) {
  const std::lock_guard lock(memory().mutex);
  if (packets)
    memory().packets[camera] = *packets;
  else
    memory().packets.erase(camera);
}

}  // namespace lumifield
