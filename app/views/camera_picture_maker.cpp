#include "app/views/camera_picture_maker.h"

#include <utility>

namespace lumifield {

CameraPictureMaker::CameraPictureMaker(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& stop) { run(stop); }) {}

CameraPictureMaker::~CameraPictureMaker() {
  thread_.request_stop();
  thread_.join();  // at most one picture
}

void CameraPictureMaker::make(Wish wish) {
  if (!wish.bracket || wish.exposure >= wish.bracket->size()) return;
  std::lock_guard lock(mutex_);
  wish_ = std::move(wish);
  wished_.notify_one();
}

void CameraPictureMaker::run(const std::stop_token& stop) {
  while (true) {
    std::unique_lock lock(mutex_);
    if (!wished_.wait(lock, stop, [this] { return wish_.has_value(); })) return;
    Wish wish = *std::exchange(wish_, std::nullopt);
    lock.unlock();
    auto picture = std::make_shared<const CameraPicture>(
        make_camera_picture(std::move(wish.bracket), wish.exposure, wish.saturation_dn, wish.colours));
    QMetaObject::invokeMethod(
        this, [this, picture = std::move(picture)] { emit made(picture); }, Qt::QueuedConnection);
  }
}

}  // namespace lumifield
