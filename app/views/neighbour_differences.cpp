#include "app/views/neighbour_differences.h"

#include <utility>

#include "luminaire/neighbours.h"

namespace lumifield {

NeighbourDifferences::NeighbourDifferences(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& stop) { run(stop); }) {}

NeighbourDifferences::~NeighbourDifferences() {
  thread_.request_stop();
  thread_.join();
}

void NeighbourDifferences::wish(const Sampling& sampling, CellIndex cell, Images images) {
  {
    const std::lock_guard lock(mutex_);
    wishes_.insert_or_assign(cell, Wish{sampling, std::move(images)});
  }
  came_.notify_one();
}

void NeighbourDifferences::forget() {
  const std::lock_guard lock(mutex_);
  wishes_.clear();
  ++luminaire_;
}

void NeighbourDifferences::run(const std::stop_token& stop) {
  while (true) {
    std::unique_lock lock(mutex_);
    if (!came_.wait(lock, stop, [&] { return !wishes_.empty(); })) return;
    const auto next = wishes_.extract(wishes_.begin());
    const std::uint64_t luminaire = luminaire_;
    lock.unlock();
    const auto& [sampling, images] = next.mapped();
    const double difference = neighbour_difference(sampling, next.key(), [&](CellIndex at) {
      const auto image = images.find(at);
      return image == images.end() ? nullptr : image->second.get();
    });
    QMetaObject::invokeMethod(
        this,
        [this, luminaire, cell = next.key(), difference] {
          if (luminaire == luminaire_) emit known(cell, difference);  // changed on this thread alone
        },
        Qt::QueuedConnection);
  }
}

}  // namespace lumifield
