#include "acquisition/cameras/recording_camera.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <system_error>
#include <utility>
#include <vector>

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

Result<std::shared_ptr<FrameRecording>> FrameRecording::resume(const fs::path& folder) {
  const fs::path list = folder / frame_list_name;
  if (Status writable = check_writable(list); !writable) return tl::unexpected(writable.error());
  std::shared_ptr<FrameRecording> recording(new FrameRecording(folder));
  std::error_code code;
  const bool is_there = fs::exists(list, code);
  if (code) return system_failure("could not be looked at", list, code.value());
  if (!is_there) return recording;
  const Result<std::string> csv = read_file(list, most_frame_list_bytes);
  if (!csv) return tl::unexpected(csv.error());
  const std::string_view whole = std::string_view(*csv).substr(0, csv->rfind('\n') + 1);
  if (Status taken = recording->take_up(whole); !taken) return tl::unexpected(taken.error());
  if (whole.size() < csv->size())
    if (Status cut = cut_file(list, whole.size()); !cut) return tl::unexpected(cut.error());
  return recording;
}

/// The lines that are whole: new ones come after them, under numbers that none of them has.
Status FrameRecording::take_up(std::string_view list) {
  const std::string where = (folder_ / frame_list_name).string(), header = frame_list_header();
  list_bytes_ = list.size();
  if (list.empty() || list == header) return {};
  if (!list.starts_with(header)) return fail("is a list that no recording wrote", where, "record into another folder");
  const Result<std::vector<ListedFrame>> frames = parse_frame_list(list, where);
  if (!frames) return tl::unexpected(frames.error());
  frames_ = frames->size();
  for (const ListedFrame& frame : *frames) {
    std::size_t number = 0;
    std::from_chars(frame.file.data(), frame.file.data() + frame.file.size(), number);
    last_number_ = std::max(last_number_, number);
  }
  return {};
}

Status FrameRecording::append(const std::string& line) {
  if (Status done = append_durably(folder_ / frame_list_name, line, list_bytes_); !done) return done;
  list_bytes_ += line.size();
  return {};
}

Status FrameRecording::write(const RawImage& image, double asked_s, const Vec2& stage_mm) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.pgm", last_number_ + 1);
  if (Status done = write_file_durably(folder_ / name, encode_pgm(image)); !done) return done;
  if (list_bytes_ == 0)
    if (Status begun = append(frame_list_header()); !begun) return begun;
  return append(frame_list_line({name, image.exposure_s, asked_s, image.gain, image.pattern, stage_mm}));
}

void FrameRecording::add(const RawImage& image, double asked_s, const Vec2& stage_mm) {
  if (error_) return;
  if (Status written = write(image, asked_s, stage_mm); written) {
    ++frames_, ++last_number_;
  } else {
    error_ = written.error();
    if (ended_) ended_();
  }
}

std::unique_ptr<Camera> record(std::unique_ptr<Camera> camera, std::shared_ptr<FrameRecording> recording) {
  return std::make_unique<RecordingCamera>(std::move(camera), std::move(recording));
}

}  // namespace lumifield
