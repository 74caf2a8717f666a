#include "app/views/picture_saver.h"

#include <string>
#include <utility>

#include "app/session/guarded.h"
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
  if (!frame.placements.empty())
    picture.note += (picture.note.empty() ? "" : "; ") + placements_text(frame.placements).toStdString();
  return write_exr(picture, file);
}

}  // namespace

PictureSaver::PictureSaver(QObject* parent) : QObject(parent) {}

PictureSaver::~PictureSaver() = default;

void PictureSaver::save(std::shared_ptr<const PreviewFrame> frame, const std::filesystem::path& file) {
  const std::string lacks = shortcomings(*frame);
  const QString success = QString::fromStdString("saved " + file.string() + (lacks.empty() ? "" : ": " + lacks));
  begin(
      file, [frame = std::move(frame), file] { return write_frame(*frame, file); },
      [this, success] {
        emit noticed({OperatorNotice::Level::information, success});
      });
}

void PictureSaver::save(const Scene& scene, const std::filesystem::path& file) {
  const QString where = QString::fromStdString(file.string());
  begin(
      file, [scene, file] { return write_scene(scene, file); },
      [this, where] {
        emit noticed({OperatorNotice::Level::information, "saved " + where});
        emit sceneSaved(where);
      });
}

void PictureSaver::begin(const std::filesystem::path& file, std::function<Status()> work, std::function<void()> done) {
  if (busy_) {
    const Error error{"the last file is still being written", file.string(), "save again when it is done", {}};
    emit noticed({OperatorNotice::Level::fault, QString::fromStdString(error.message())});
    return;
  }
  busy_ = true;
  emit busyChanged(true);
  writing_ = std::jthread([this, work = std::move(work), done = std::move(done)] {
    const Status written = guarded("saving", work);
    QMetaObject::invokeMethod(
        this, [this, written, done] { finish(written, done); }, Qt::QueuedConnection);
  });
}

void PictureSaver::finish(const Status& written, const std::function<void()>& done) {
  busy_ = false;
  emit busyChanged(false);
  if (written)
    done();
  else
    emit noticed({OperatorNotice::Level::fault, QString::fromStdString(written.error().message())});
}

}  // namespace lumifield
