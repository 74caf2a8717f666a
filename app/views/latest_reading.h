#pragma once

#include <functional>
#include <memory>

class QObject;

namespace lumifield {

/// Reads files on threads of their own. Of several readings only the latest counts; one that hangs (a file server that
/// does not answer) is left behind (beside.h), and nothing waits for it. What one throws is logged. GUI thread.
class LatestReading {
 public:
  /// `owner` outlives this.
  explicit LatestReading(QObject* owner);
  ~LatestReading();
  LatestReading(const LatestReading&) = delete;
  LatestReading& operator=(const LatestReading&) = delete;

  /// `read` runs on a thread of its own and touches nothing of the owner; what it returns runs on the owner's thread,
  /// unless another reading was begun meanwhile.
  void begin(std::function<std::function<void()>()> read);

 private:
  struct Link;
  std::shared_ptr<Link> link_;
};

}  // namespace lumifield
