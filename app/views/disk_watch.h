#pragma once

#include <QObject>
#include <chrono>
#include <filesystem>
#include <memory>

namespace lumifield {

/// Looks every few seconds how much room the disk of a folder has, on a thread of its own. A folder that is not there
/// yet counts as its nearest parent that is. A file server that hangs holds up that thread only: it is left behind, and
/// nothing waits for it (beside.h). GUI thread.
class DiskWatch : public QObject {
  Q_OBJECT

 public:
  explicit DiskWatch(QObject* parent = nullptr, std::chrono::milliseconds period = std::chrono::seconds(5));
  ~DiskWatch() override;

  /// Looks at once, then every period; empty ends it.
  void watch(const std::filesystem::path& folder);

 signals:
  /// Bytes that this user may still write.
  void roomRead(double free_bytes);
  void failed(const QString& message);

 private:
  struct Watch;
  void end();

  std::chrono::milliseconds period_;
  std::shared_ptr<Watch> watch_;
};

}  // namespace lumifield
