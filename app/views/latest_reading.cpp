#include "app/views/latest_reading.h"

#include <QObject>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>

namespace lumifield {

struct LatestReading::Link {
  std::mutex mutex;
  QObject* owner = nullptr;  ///< null once nobody waits
  std::uint64_t latest = 0;
};

LatestReading::LatestReading(QObject* owner) : link_(std::make_shared<Link>()) { link_->owner = owner; }

LatestReading::~LatestReading() {
  std::lock_guard lock(link_->mutex);
  link_->owner = nullptr;
}

void LatestReading::begin(std::function<std::function<void()>()> read) {
  std::lock_guard lock(link_->mutex);
  std::thread([link = link_, number = ++link_->latest, read = std::move(read)] {
    const std::function<void()> take = read();
    std::lock_guard posting(link->mutex);
    if (!link->owner) return;
    QMetaObject::invokeMethod(
        link->owner,
        [link, number, take] {
          {
            std::lock_guard checking(link->mutex);
            if (!link->owner || number != link->latest) return;
          }
          take();
        },
        Qt::QueuedConnection);
  }).detach();
}

}  // namespace lumifield
