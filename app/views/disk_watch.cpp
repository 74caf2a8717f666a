#include "app/views/disk_watch.h"

#include <condition_variable>
#include <mutex>

#include "app/session/beside.h"
#include "app/session/disk_room.h"

namespace lumifield {

/// One folder's watch, owned by both sides.
struct DiskWatch::Watch : std::enable_shared_from_this<Watch> {
  std::filesystem::path folder;
  std::chrono::milliseconds period;
  std::mutex mutex;
  std::condition_variable ended;
  DiskWatch* reader = nullptr;  ///< null once nobody listens

  void run();
  void look();
  /// `fault` is empty where the room is known.
  void post(const std::string& fault, double free_bytes);
};

void DiskWatch::Watch::run() {
  std::unique_lock lock(mutex);
  while (reader) {
    lock.unlock();
    look();
    lock.lock();
    ended.wait_for(lock, period, [this] { return !reader; });
  }
}

void DiskWatch::Watch::look() {
  const Result<DiskRoom> disk = disk_room(folder);
  disk ? post({}, disk->free_bytes) : post(disk.error().message(), 0);
}

void DiskWatch::Watch::post(const std::string& fault, double free_bytes) {
  std::lock_guard lock(mutex);
  if (!reader) return;
  DiskWatch* const to = reader;
  QMetaObject::invokeMethod(
      to,
      [self = shared_from_this(), to, fault, free_bytes] {
        if (to->watch_ != self) return;
        if (fault.empty())
          emit to->roomRead(free_bytes);
        else
          emit to->failed(QString::fromStdString(fault));
      },
      Qt::QueuedConnection);
}

DiskWatch::DiskWatch(QObject* parent, std::chrono::milliseconds period) : QObject(parent), period_(period) {}

DiskWatch::~DiskWatch() { end(); }

void DiskWatch::end() {
  if (!watch_) return;
  std::lock_guard lock(watch_->mutex);
  watch_->reader = nullptr;
  watch_->ended.notify_all();
}

void DiskWatch::watch(const std::filesystem::path& folder) {
  end();
  watch_.reset();
  if (folder.empty()) return;
  watch_ = std::make_shared<Watch>();
  watch_->folder = folder;
  watch_->period = period_;
  watch_->reader = this;
  run_beside(
      "the disk's room", [watch = watch_] { watch->run(); },
      [watch = watch_](const Error& error) { watch->post(error.message(), 0); });
}

}  // namespace lumifield
