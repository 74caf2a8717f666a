#include "acquisition/cameras/replay_camera.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <optional>
#include <set>

#include "acquisition/cameras/frame_folder.h"
#include "acquisition/cameras/pixel_layout.h"
#include "luminaire/file_io.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

constexpr double same_exposure = 1e-3, same_gain_db = 0.05;
constexpr const char* other_scan = "use the bench and the plan that it was recorded with, or record it anew";

bool has_exposure(const ListedFrame& frame, double exposure_s) {
  return std::abs(frame.asked_s - exposure_s) <= same_exposure * frame.asked_s;
}

class ReplayCamera final : public Camera {
 public:
  ReplayCamera(const CameraSettings& settings, std::vector<ListedFrame> frames)
      : folder_(settings.address),
        same_place_mm_(settings.same_place_mm),
        frames_(std::move(frames)),
        given_(frames_.size()) {
    info_ = {"Lumifield", "replay", std::to_string(frames_.size()) + " frames", settings.address, 0, 0};
  }

  /// That every frame can be played back with these settings.
  Status check(const CameraSettings& settings);

  const CameraInfo& info() const override { return info_; }
  void tell_place(const Vec2& stage_mm) override { place_mm_ = stage_mm; }
  Result<RawImage> expose(double exposure_s) override;
  int frames_retaken() const override { return 0; }

 private:
  Status check(const ListedFrame& frame, const PixelLayout& layout, const CameraSettings& settings);
  Result<RawImage> read(const ListedFrame& frame) const;
  bool lacks(const fs::path& file) const;
  Result<std::size_t> choose(double exposure_s);
  Result<std::size_t> choose_at_place(double exposure_s);
  Result<std::size_t> choose_next(double exposure_s);
  Result<std::size_t> choose_round(double exposure_s);
  tl::unexpected<Error> not_recorded(double exposure_s, const std::function<bool(const ListedFrame&)>& counts,
                                     const std::string& place) const;
  tl::unexpected<Error> error(std::string what, std::string remedy) const {
    return refused_for_good({std::move(what), "camera " + info_.address, std::move(remedy)});
  }

  fs::path folder_;
  double same_place_mm_;
  std::vector<ListedFrame> frames_;
  std::vector<bool> given_;
  CameraInfo info_;
  std::optional<Vec2> place_mm_;
  std::size_t next_ = 0;
  std::uint64_t exposures_ = 0;
};

Result<PgmHeader> header_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string begin(2048, '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (stream.bad() || !stream.is_open())
    return fail("is listed, but cannot be read", file.string(), "put it there, or take its line out of the list");
  begin.resize(static_cast<std::size_t>(stream.gcount()));
  const Result<PgmHeader> header = parse_pgm_header(begin, file.string());
  std::error_code code;
  const std::uintmax_t bytes = fs::file_size(file, code);
  if (header && !code && bytes != header->file_bytes())
    return fail("holds " + std::to_string(bytes) + " bytes, its header says " + std::to_string(header->file_bytes()),
                file.string(), "it was cut off or is damaged: record it again");
  return header;
}

Status ReplayCamera::check(const CameraSettings& settings) {
  const std::optional<PixelLayout> layout = pixel_layout(settings.pixel_format);
  if (!layout) return error("no pixel format \"" + settings.pixel_format + "\"", "give one such as Mono12");
  for (const ListedFrame& frame : frames_)
    if (Status usable = check(frame, *layout, settings); !usable) return usable;
  return {};
}

Status ReplayCamera::check(const ListedFrame& frame, const PixelLayout& layout, const CameraSettings& settings) {
  const auto file = path_inside(folder_, frame.file, (folder_ / frame_list_name).string());
  if (!file) return tl::unexpected(file.error());
  const Result<PgmHeader> header = header_of(*file);
  if (!header) return tl::unexpected(header.error());
  const auto refuse = [&](const std::string& what, std::string remedy) {
    return fail(what, file->string(), std::move(remedy));
  };
  if (info_.sensor_width_px == 0) info_.sensor_width_px = header->width_px, info_.sensor_height_px = header->height_px;
  if (header->width_px != info_.sensor_width_px || header->height_px != info_.sensor_height_px)
    return refuse("is " + std::to_string(header->width_px) + "x" + std::to_string(header->height_px) + " pixels, " +
                      frames_.front().file + " is " + std::to_string(info_.sensor_width_px) + "x" +
                      std::to_string(info_.sensor_height_px),
                  "take out the frames of another size");
  if (header->bits != layout.bits || frame.pattern != layout.pattern)
    return refuse("has " + std::to_string(header->bits) + " bits" +
                      (frame.pattern != layout.pattern ? " and another pattern of colours" : "") +
                      ", the bench file says " + settings.pixel_format,
                  "set pixel_format to that of the frames");
  if (frame.gain_db != 0 && std::abs(frame.gain_db - settings.gain) > same_gain_db)
    return refuse("was taken with a gain of " + say(frame.gain_db) + " dB, the bench file says " + say(settings.gain),
                  "set gain to that of the frames");
  return {};
}

/// Tells which exposures there are among the frames that count.
tl::unexpected<Error> ReplayCamera::not_recorded(double exposure_s,
                                                 const std::function<bool(const ListedFrame&)>& counts,
                                                 const std::string& place) const {
  std::set<double> there;
  for (const ListedFrame& frame : frames_)
    if (counts(frame)) there.insert(frame.asked_s);
  std::string list;
  for (const double each : there) list.append(list.empty() ? "" : ", ").append(say(each));
  return error("an exposure of " + say(exposure_s) + " s was not recorded" + place + "; there is " + list + " s",
               other_scan);
}

Result<std::size_t> ReplayCamera::choose_at_place(double exposure_s) {
  const auto off_mm = [&](const ListedFrame& frame) { return (*frame.stage_mm - *place_mm_).norm(); };
  const auto nearest = std::ranges::min_element(frames_, {}, off_mm);
  if (!(off_mm(*nearest) <= same_place_mm_))
    return error("no frame was recorded at " + say(*place_mm_) + " mm; the nearest, " + nearest->file + ", at " +
                     say(*nearest->stage_mm) + " mm, is more than " + say(same_place_mm_) + " mm off",
                 std::string(other_scan) + "; of frames of your own, set tolerance_mm to how far off they are");
  const auto is_here = [&](const ListedFrame& frame) { return off_mm(frame) <= same_place_mm_; };
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < frames_.size(); ++k) {
    if (!has_exposure(frames_[k], exposure_s) || !is_here(frames_[k])) continue;
    last = k;
    if (!given_[k]) break;
  }
  if (!last) return not_recorded(exposure_s, is_here, " at " + say(*place_mm_) + " mm");
  return *last;
}

Result<std::size_t> ReplayCamera::choose_next(double exposure_s) {
  if (next_ == frames_.size())
    return error("all " + std::to_string(next_) + " frames are given",
                 "the list has too few for this scan: use the plan that it was recorded with");
  const ListedFrame& frame = frames_[next_];
  if (!has_exposure(frame, exposure_s))
    return error("an exposure of " + say(exposure_s) + " s was asked for, but the next frame, " + frame.file +
                     ", has " + say(frame.asked_s) + " s",
                 other_scan);
  return next_++;
}

Result<std::size_t> ReplayCamera::choose_round(double exposure_s) {
  for (std::size_t n = 0; n < frames_.size(); ++n) {
    const std::size_t k = (next_ + n) % frames_.size();
    if (!has_exposure(frames_[k], exposure_s)) continue;
    next_ = k + 1;
    return k;
  }
  return not_recorded(
      exposure_s, [](const ListedFrame&) { return true; }, "");
}

Result<std::size_t> ReplayCamera::choose(double exposure_s) {
  if (!place_mm_) return choose_round(exposure_s);
  return frames_.front().stage_mm ? choose_at_place(exposure_s) : choose_next(exposure_s);
}

/// A folder that is gone as a whole may come back, with the disk or the network that it is on.
bool ReplayCamera::lacks(const fs::path& file) const {
  std::error_code file_code, list_code;
  return !fs::exists(file, file_code) && !file_code && fs::exists(folder_ / frame_list_name, list_code);
}

Result<RawImage> ReplayCamera::read(const ListedFrame& frame) const {
  const fs::path file = folder_ / frame.file;
  const Result<std::string> bytes = read_file(file, most_picture_bytes);
  if (!bytes) return lacks(file) ? refused_for_good(bytes.error()) : tl::unexpected(bytes.error());
  Result<RawImage> image = decode_pgm(*bytes, file.string());
  if (!image) return refused_for_good(image.error());
  if (image->width_px != info_.sensor_width_px || image->height_px != info_.sensor_height_px)
    return refused_for_good(
        {"is of another size than when it was opened", file.string(), "leave the folder as it was recorded"});
  return image;
}

Result<RawImage> ReplayCamera::expose(double exposure_s) {
  const Result<std::size_t> chosen = choose(exposure_s);
  if (!chosen) return tl::unexpected(chosen.error());
  const ListedFrame& frame = frames_[*chosen];
  Result<RawImage> image = read(frame);
  if (!image) return image;
  given_[*chosen] = true;
  image->pattern = frame.pattern;
  image->exposure_s = frame.exposure_s;
  image->gain = frame.gain_db;
  image->frame_id = ++exposures_;
  return image;
}

}  // namespace

Result<std::unique_ptr<Camera>> open_replay_camera(const CameraSettings& settings) {
  Result<std::vector<ListedFrame>> frames = read_frame_list(settings.address);
  if (!frames) return tl::unexpected(frames.error());
  auto camera = std::make_unique<ReplayCamera>(settings, std::move(*frames));
  if (Status usable = camera->check(settings); !usable) return tl::unexpected(usable.error());
  return camera;
}

std::vector<DeviceReport> find_replay_cameras() { return {}; }

DeviceReport probe_replay_camera(const CameraSettings& settings) {
  const Result<std::unique_ptr<Camera>> camera = open_replay_camera(settings);
  if (!camera) return {"camera", {}, settings.address, false, camera.error().message(), {}};
  return {"camera", "replay of " + (*camera)->info().serial, settings.address, true, {}, {}};
}

}  // namespace lumifield
