#pragma once

#include <QObject>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "app/views/camera_picture.h"

namespace lumifield {

/// Makes camera pictures on a thread of its own. The latest wish wins: one that waits is replaced. GUI thread.
class CameraPictureMaker : public QObject {
  Q_OBJECT

 public:
  struct Wish {
    std::shared_ptr<const Bracket> bracket;
    std::size_t exposure = 0;
    double saturation_dn = 0;
    CameraColours colours = CameraColours::photosites;
  };

  explicit CameraPictureMaker(QObject* parent = nullptr);
  ~CameraPictureMaker() override;

  void make(Wish wish);

 signals:
  void made(std::shared_ptr<const lumifield::CameraPicture> picture);

 private:
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any wished_;
  std::optional<Wish> wish_;
  std::jthread thread_;
};

}  // namespace lumifield
