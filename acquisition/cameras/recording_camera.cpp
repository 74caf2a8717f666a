#include "acquisition/cameras/recording_camera.h"

#include <cstdio>
#include <system_error>
#include <utility>

#include "acquisition/cameras/frame_folder.h"
#include "luminaire/file_io.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

class RecordingCamera final : public Camera {
 public:
  RecordingCamera(std::unique_ptr<Camera> camera, std::shared_ptr<FrameRecording> recording)
      : camera_(std::move(camera)), recording_(std::move(recording)) {}

  const CameraInfo& info() const override { return camera_->info(); }
  void tell_place(const Vec2& stage_mm) override {
    place_mm_ = stage_mm;
    camera_->tell_place(stage_mm);
  }
  Result<RawImage> expose(double exposure_s) override {
    Result<RawImage> image = camera_->expose(exposure_s);
    if (image && place_mm_) recording_->add(*image, exposure_s, *place_mm_);
    return image;
  }
  double frame_wait_s(std::span<const double> exposures_s) const override { return camera_->frame_wait_s(exposures_s); }
  int frames_retaken() const override { return camera_->frames_retaken(); }

 private:
  std::unique_ptr<Camera> camera_;
  std::shared_ptr<FrameRecording> recording_;
  std::optional<Vec2> place_mm_;
};

}  // namespace

Result<std::shared_ptr<FrameRecording>> FrameRecording::create(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) return system_failure("could not be made", folder, code.value());
  const bool is_empty = fs::is_empty(folder, code);
  if (code) return system_failure("could not be listed", folder, code.value());
  if (!is_empty) return fail("holds something already", folder.string(), "record into another folder");
  if (Status writable = check_writable(folder / frame_list_name); !writable) return tl::unexpected(writable.error());
  return std::shared_ptr<FrameRecording>(new FrameRecording(folder));
}

Status FrameRecording::append(const std::string& line) {
  if (Status done = append_durably(folder_ / frame_list_name, line, list_bytes_); !done) return done;
  list_bytes_ += line.size();
  return {};
}

Status FrameRecording::write(const RawImage& image, double asked_s, const Vec2& stage_mm) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.pgm", frames_ + 1);
  if (Status done = write_file_durably(folder_ / name, encode_pgm(image)); !done) return done;
  if (list_bytes_ == 0)
    if (Status begun = append(frame_list_header()); !begun) return begun;
  return append(frame_list_line({name, image.exposure_s, asked_s, image.gain, image.pattern, stage_mm}));
}

void FrameRecording::add(const RawImage& image, double asked_s, const Vec2& stage_mm) {
  if (error_) return;
  if (Status written = write(image, asked_s, stage_mm); written) {
    ++frames_;
  } else {
    error_ = written.error();
    if (ended_) ended_();
  }
}

std::unique_ptr<Camera> record(std::unique_ptr<Camera> camera, std::shared_ptr<FrameRecording> recording) {
  return std::make_unique<RecordingCamera>(std::move(camera), std::move(recording));
}

}  // namespace lumifield
