#include "app/views/latest_reading.h"

#include <QObject>
#include <cstdint>
#include <mutex>
#include <utility>

#include "app/session/beside.h"

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
  const auto work = [link = link_, number = ++link_->latest, read = std::move(read)] {
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
  };
  run_beside("reading", work, [](const Error& error) { qWarning("%s", error.message().c_str()); });
}

}  // namespace lumifield
