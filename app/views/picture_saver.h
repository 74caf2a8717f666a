#pragma once

#include <QObject>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>

#include "app/session/live_preview.h"
#include "app/views/operator_notice.h"

namespace lumifield {

/// Writes a frame or a scene to a file in a thread of its own, one at a time: .png as it is shown, .exr its linear
/// radiance. The notice that follows, and the EXR's comment, say what the picture lacks; the comment also says where
/// the luminaires stand. GUI thread; destroying it waits for the file.
class PictureSaver : public QObject {
  Q_OBJECT

 public:
  explicit PictureSaver(QObject* parent = nullptr);
  ~PictureSaver() override;

  bool busy() const { return busy_; }
  void save(std::shared_ptr<const PreviewFrame> frame, const std::filesystem::path& file);
  /// `sceneSaved` too, when it went well.
  void save(const Scene& scene, const std::filesystem::path& file);

 signals:
  void busyChanged(bool busy);
  void noticed(const lumifield::OperatorNotice& notice);
  void sceneSaved(const QString& file);

 private:
  /// `work` in the thread, then `done`.
  void begin(const std::filesystem::path& file, std::function<Status()> work, std::function<void()> done);
  void finish(const Status& written, const std::function<void()>& done);

  bool busy_ = false;
  std::jthread writing_;
};

}  // namespace lumifield
