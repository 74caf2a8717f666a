#include "app/views/picture_saver.h"

#include <string>
#include <utility>

#include "app/views/preview_text.h"

namespace lumifield {
namespace {

/// "26 of 63 cells not measured yet: their light is missing; a coarse picture"; empty for a whole one.
std::string shortcomings(const PreviewFrame& frame) {
  std::string text = missing_text(frame).toStdString();
  if (frame.coarse) text += text.empty() ? "a coarse picture" : "; a coarse picture";
  return text;
}

Status write_frame(const PreviewFrame& frame, const std::filesystem::path& file) {
  if (file.extension() == ".png") return write_png(frame.shown, file);
  if (file.extension() != ".exr")
    return fail("the picture's format is not known", file.string(), "end its name in .png or .exr");
  Picture picture = frame.radiance ? *frame.radiance : Picture{};
  if (const std::string lacks = shortcomings(frame); !lacks.empty())
    picture.note += (picture.note.empty() ? "" : "; ") + lacks;
  return write_exr(picture, file);
}

}  // namespace

PictureSaver::PictureSaver(QObject* parent) : QObject(parent) {}

PictureSaver::~PictureSaver() = default;

void PictureSaver::save(std::shared_ptr<const PreviewFrame> frame, const std::filesystem::path& file) {
  const QString where = QString::fromStdString(file.string());
  if (busy_) {
    const Error error{"the last picture is still being written", file.string(), "save again when it is done", {}};
    emit noticed({OperatorNotice::Level::fault, QString::fromStdString(error.message())});
    return;
  }
  busy_ = true;
  emit busyChanged(true);
  const QString lacks = QString::fromStdString(shortcomings(*frame));
  writing_ = std::jthread(
      [this, frame = std::move(frame), file, success = "saved " + where + (lacks.isEmpty() ? "" : ": " + lacks)] {
        const Status written = write_frame(*frame, file);
        QMetaObject::invokeMethod(
            this, [this, written, success] { finish(written, success); }, Qt::QueuedConnection);
      });
}

void PictureSaver::finish(const Status& written, const QString& success) {
  busy_ = false;
  emit busyChanged(false);
  if (written)
    emit noticed({OperatorNotice::Level::information, success});
  else
    emit noticed({OperatorNotice::Level::fault, QString::fromStdString(written.error().message())});
}

}  // namespace lumifield
