#include "acquisition/cameras/v4l2_camera.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "acquisition/cameras/v4l2_controls.h"
#include "acquisition/cameras/v4l2_format.h"
#include "acquisition/cameras/v4l2_freshness.h"
#include "acquisition/cameras/v4l2_node.h"
#include "acquisition/cameras/v4l2_stream.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr double watchdog_s = 0.3, start_up_s = 2;
constexpr double restart_s = 0.4;  // about what a stream that is started anew costs
constexpr int incomplete_limit = 5;
constexpr double pace_tolerance = 0.05;  // of time stamps

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

class V4l2Camera final : public Camera {
 public:
  V4l2Camera(V4l2Node node, const CameraSettings& settings)
      : node_(std::move(node)), settings_(settings), freshness_(settings.readout_s) {}

  /// Applies the settings and starts the stream.
  Status start();

  const CameraInfo& info() const override { return info_; }
  Result<RawImage> expose(double exposure_s) override;
  double frame_wait_s(std::span<const double> exposures_s) const override;
  int frames_retaken() const override { return frames_retaken_; }

 private:
  using Kind = V4l2Stream::Arrival::Kind;

  Status start_stream();
  Status check_alive();
  Status apply_exposure(double exposure_s);
  Status fit_interval();
  /// Whether after the longest exposure the interval is set back for this one.
  bool gains_by_restart(double is_s, double exposure_s) const {
    return 2 * (is_s - std::max(exposure_s, own_interval_s_)) >= restart_s;
  }
  Status pass_over_arrived();
  Result<std::optional<RawImage>> judge(const V4l2Stream::Frame& frame);
  Status check_pace(const V4l2Stream::Frame& frame) const;
  RawImage image_of(const V4l2Stream::Frame& frame) const;
  double frame_time_s() const {
    return exposure_s_ + std::max(picture_.frame_interval_s, settings_.readout_s) + watchdog_s +
           (is_starting_ ? start_up_s : 0);
  }
  /// Until a frame counts: those passed over, broken ones, and as many again.
  double patience_s() const { return 2 * (V4l2Freshness::frames_passed_over + incomplete_limit + 1) * frame_time_s(); }
  tl::unexpected<Error> gone(const std::string& how) {
    is_gone_ = true;
    return node_.error("camera gone: " + how, "check cable and power");
  }

  V4l2Node node_;  // the stream uses it, and ends before it
  CameraSettings settings_;
  CameraInfo info_;
  V4l2Picture picture_;
  std::optional<V4l2Controls> controls_;
  V4l2Freshness freshness_;
  std::optional<V4l2Stream> stream_;
  std::optional<double> asked_exposure_s_;
  double exposure_s_ = 0;
  double own_interval_s_ = 0;  ///< at short exposures
  struct Seen {
    std::uint32_t sequence;
    double stamp_s;
  };
  std::optional<Seen> last_;  // of the frames with this exposure
  int frames_retaken_ = 0, incomplete_ = 0;
  bool is_gone_ = false, is_starting_ = true;
};

Status V4l2Camera::start() {
  info_ = {node_.vendor(), node_.model(), node_.serial(), node_.path(), 0, 0};
  const Result<V4l2Picture> picture = set_picture(node_, settings_);
  if (!picture) return tl::unexpected(picture.error());
  picture_ = *picture;
  info_.sensor_width_px = picture_.width_px, info_.sensor_height_px = picture_.height_px;
  own_interval_s_ = picture_.frame_interval_s;
  Result<V4l2Controls> controls = V4l2Controls::apply(node_, settings_);
  if (!controls) return tl::unexpected(controls.error());
  controls_.emplace(std::move(*controls));
  if (picture_.is_bent && !controls_->have_gamma())
    return node_.error("gives " + settings_.pixel_format +
                           " through a transfer function that makes light no number, "
                           "and has no gamma to be set to 1",
                       "choose a raw format, which `lumifield devices` lists, or another camera");
  return start_stream();
}

Status V4l2Camera::start_stream() {
  stream_.reset();
  Result<V4l2Stream> stream = V4l2Stream::start(node_, picture_);
  if (!stream) return tl::unexpected(stream.error());
  stream_.emplace(std::move(*stream));
  is_starting_ = true;
  last_.reset();
  return {};
}

Status V4l2Camera::check_alive() {
  if (is_gone_) return gone("its link was lost before");
  if (const int failure = node_.check(); failure != 0) return gone(std::strerror(failure));
  return {};
}

/// Some cameras expose no longer than from one frame to the next, whatever they say. After a long exposure the interval
/// is set back where a frame, which takes two, gains more by that than it costs.
Status V4l2Camera::fit_interval() {
  const double is_s = picture_.frame_interval_s;
  const double wanted_s = std::max(exposure_s_, own_interval_s_);
  if (is_s == 0 || (exposure_s_ <= is_s && !gains_by_restart(is_s, exposure_s_))) return {};
  stream_.reset();  // which few cameras change while they stream
  picture_.frame_interval_s = set_frame_interval(node_, wanted_s);
  return start_stream();
}

/// The question follows a frame: the next one may have begun before it, the second counts, and after a change as many
/// are passed over first.
double V4l2Camera::frame_wait_s(std::span<const double> exposures_s) const {
  if (own_interval_s_ == 0 || exposures_s.empty()) return 0;
  const double longest_s = std::max(own_interval_s_, *std::ranges::max_element(exposures_s));
  const double intervals = 2 + (exposures_s.size() > 1 ? V4l2Freshness::frames_passed_over : 0);
  double sum_s = 0;
  for (const double exposure_s : exposures_s) {
    const bool restarts = gains_by_restart(longest_s, exposure_s);
    sum_s += restarts ? restart_s + intervals * std::max(own_interval_s_, exposure_s) : intervals * longest_s;
  }
  return sum_s / static_cast<double>(exposures_s.size());
}

Status V4l2Camera::apply_exposure(double exposure_s) {
  const bool is_changed = exposure_s != asked_exposure_s_;
  if (is_changed) {
    asked_exposure_s_.reset();  // when it cannot be read back, nobody knows which one it has
    const Result<double> taken = controls_->set_exposure(exposure_s);
    if (!taken) {
      if (Status alive = check_alive(); !alive) return alive;
      return tl::unexpected(taken.error());
    }
    asked_exposure_s_ = exposure_s;
    exposure_s_ = *taken;
    last_.reset();
    if (Status fitted = fit_interval(); !fitted) return fitted;
  }
  freshness_.ask(now_s(), exposure_s_, picture_.frame_interval_s, is_changed);
  return {};
}

/// Frames that came while nobody asked: so many are lost that their sequence tells nothing.
Status V4l2Camera::pass_over_arrived() {
  constexpr int most = 64;  // more than it has buffers, however fast it is
  for (int i = 0; i < most; ++i) {
    const V4l2Stream::Arrival arrival = stream_->next(0);
    if (arrival.kind == Kind::gone) return gone(arrival.how_gone);
    if (arrival.kind == Kind::nothing) break;
    stream_->give_back(arrival.frame);
    is_starting_ = false;
  }
  last_.reset();
  return {};
}

/// A camera cannot expose longer than from one frame to the next.
Status V4l2Camera::check_pace(const V4l2Stream::Frame& frame) const {
  if (!last_ || frame.sequence <= last_->sequence) return {};
  const double interval_s = (frame.stamp_s - last_->stamp_s) / (frame.sequence - last_->sequence);
  if (interval_s >= exposure_s_ * (1 - pace_tolerance)) return {};
  return node_.error("says that it exposes " + say(exposure_s_) + " s, but its frames follow each other after " +
                         say(interval_s, 3) + " s",
                     "choose exposures below that, or a slower frame rate in the camera");
}

RawImage V4l2Camera::image_of(const V4l2Stream::Frame& frame) const {
  RawImage image;
  image.width_px = picture_.width_px, image.height_px = picture_.height_px;
  image.bits = picture_.format.bits;
  image.pattern = picture_.format.pattern;
  image.dn = unpack(frame.bytes, picture_.stride, picture_.width_px, picture_.height_px, picture_.format.packing);
  image.exposure_s = exposure_s_;
  image.frame_id = frame.sequence;
  return image;
}

/// The frame's image, when it is whole and was taken when asked.
Result<std::optional<RawImage>> V4l2Camera::judge(const V4l2Stream::Frame& frame) {
  if (!frame.is_complete) {
    ++frames_retaken_;
    if (++incomplete_ > incomplete_limit)
      return node_.error(std::to_string(incomplete_) + " incomplete frames in a row",
                         "check cable and USB port, take other devices off its bus, or choose a smaller picture");
    return std::nullopt;
  }
  incomplete_ = 0;
  const Status pace = check_pace(frame);
  if (last_ && frame.sequence > last_->sequence + 1)
    frames_retaken_ += static_cast<int>(std::min<std::uint32_t>(frame.sequence - last_->sequence - 1, 1000));
  last_ = {frame.sequence, frame.stamp_s};
  if (!freshness_.counts(frame.stamp_s)) return std::nullopt;
  if (!pace) return tl::unexpected(pace.error());
  return image_of(frame);
}

Result<RawImage> V4l2Camera::expose(double exposure_s) {
  if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
  if (!stream_)
    if (Status started = start_stream(); !started) return tl::unexpected(started.error());
  if (Status passed = pass_over_arrived(); !passed) return tl::unexpected(passed.error());
  if (Status applied = apply_exposure(exposure_s); !applied) return tl::unexpected(applied.error());

  incomplete_ = 0;
  double deadline_s = now_s() + patience_s();
  for (bool was_silent = false;;) {
    const double wait_s = frame_time_s();
    const V4l2Stream::Arrival arrival = stream_->next(wait_s);
    if (arrival.kind == Kind::gone) return gone(arrival.how_gone);
    if (arrival.kind == Kind::nothing) {
      if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
      if (std::exchange(was_silent, true))
        return node_.error("no frame within " + say(wait_s, 3) + " s, though the camera answers and was started anew",
                           "check cable and USB port, take other devices off its bus, or switch it off and on");
      if (Status started = start_stream(); !started) return tl::unexpected(started.error());
      freshness_.ask(now_s(), exposure_s_, picture_.frame_interval_s, true);  // the first frames may be anything
      deadline_s = now_s() + patience_s();
      continue;
    }
    is_starting_ = false;
    Result<std::optional<RawImage>> image = judge(arrival.frame);
    stream_->give_back(arrival.frame);
    if (!image) return tl::unexpected(image.error());
    if (*image) return std::move(**image);
    if (now_s() > deadline_s)
      return node_.error("frames come, but by their time stamps none began after it was asked for",
                         "check that its driver stamps frames with CLOCK_MONOTONIC, and readout_s of the bench file");
  }
}

}  // namespace

Result<std::unique_ptr<Camera>> open_v4l2_camera(const CameraSettings& settings) {
  Result<V4l2Node> node = V4l2Node::open(settings.address);
  if (!node) return tl::unexpected(node.error());
  auto camera = std::make_unique<V4l2Camera>(std::move(*node), settings);
  if (Status started = camera->start(); !started) return tl::unexpected(started.error());
  return camera;
}

}  // namespace lumifield
