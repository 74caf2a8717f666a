#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "luminaire/raw_image.h"

namespace lumifield {

/// How a device is connected, for people.
struct DeviceView {
  enum class Link { closed, opening, open, failed };
  Link link = Link::closed;
  std::string name;   ///< vendor, model, address, once open
  std::string error;  ///< what, where and what to do, when failed
};

/// What the bench shows at this moment.
struct BenchSnapshot {
  std::uint64_t number = 0;  ///< grows with every change
  DeviceView camera, stage;
  std::shared_ptr<const Bracket> bracket;  ///< the last complete one, ascending exposure; null before the first
  std::string place;                       ///< of the bracket: "cell (3, 4), pass positive", "dark set 1", "live"
  std::optional<Vec2> stage_mm;            ///< read back last
};

/// The place where the bench thread leaves what it sees, for windows that look when they like: the latest wins and
/// nobody waits. Thread-safe.
class BenchView {
 public:
  BenchSnapshot snapshot() const;
  void set_camera(DeviceView camera);
  void set_stage(DeviceView stage);
  void set_stage_mm(const Vec2& stage_mm);
  void set_bracket(std::shared_ptr<const Bracket> bracket, std::string place);
  /// What a scan has exposed, and where; the bracket is copied while it is watched.
  void show(const Bracket& bracket, const std::string& place, const Vec2& stage_mm);

  /// Somebody looks at brackets: else none needs to be copied for it. Not at first.
  void set_watched(bool watched) { watched_ = watched; }
  bool watched() const { return watched_; }

 private:
  mutable std::mutex mutex_;
  BenchSnapshot now_;
  std::atomic<bool> watched_ = false;
};

}  // namespace lumifield
