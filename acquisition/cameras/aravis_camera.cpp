#include "acquisition/cameras/aravis_camera.h"

#include <algorithm>
#include <arv.h>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "acquisition/cameras/aravis_handle.h"
#include "acquisition/cameras/aravis_packets.h"
#include "acquisition/cameras/aravis_settings.h"
#include "acquisition/cameras/aravis_stream.h"
#include "acquisition/cameras/gvcp_probe.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr double watchdog_s = 0.3;
constexpr int incomplete_limit = 5;
constexpr double us_per_s = 1e6;

// Aravis 0.8 sends a command again when its answer is late: by 0.5 s on GigE Vision, on USB3 Vision by what the camera
// says that it may take, 5 ms at least (USB3 Vision 1.0, bootstrap register "Maximum Device Response Time"). Somewhat
// less here: a trigger that is taken for repeated costs a new stream and the time of a frame, one that is not, a frame.
constexpr double gige_repeat_s = 0.4, least_usb_repeat_s = 4e-3, usb_repeat_s_per_ms = 0.8e-3;
constexpr guint64 usb_response_time_address = 0x1cc;

using Clock = std::chrono::steady_clock;

class AravisCamera final : public Camera {
 public:
  AravisCamera(CameraHandle camera, AravisAddress at, const CameraSettings& settings);
  ~AravisCamera() override;

  /// Applies the settings and starts the stream.
  Status start();

  const CameraInfo& info() const override { return info_; }
  Result<RawImage> expose(double exposure_s) override;
  int frames_retaken() const override { return frames_retaken_; }

 private:
  Status apply_exposure(double exposure_s);
  static void end_exposure(double left_s);
  Status set_packets();
  Status ask_response_time();
  Status start_stream();
  Status pass_over_late_frames();
  Status check_alive();
  Status trigger();
  bool began_before(Clock::time_point time) const;
  Status control_failure(const std::string& what, const GFault& fault);
  std::string packets_name() const {
    return info_.vendor + " " + info_.model + " " + info_.serial + " at " + info_.address;
  }
  bool is_on_usb() const { return at_.ipv4.empty(); }
  double frame_time_s() const { return exposure_s_ + settings_.readout_s + watchdog_s; }

  tl::unexpected<Error> error(std::string what, std::string remedy) const {
    return fail(std::move(what), "camera " + settings_.address, std::move(remedy));
  }
  tl::unexpected<Error> gone(const std::string& how) {
    is_gone_ = true;
    return error("camera gone: " + how, "check cable and power");
  }

  CameraHandle camera_;
  std::optional<AravisStream> stream_;
  AravisAddress at_;
  CameraSettings settings_;
  CameraInfo info_;
  AppliedSettings applied_;
  std::optional<double> asked_exposure_s_;
  double exposure_s_ = 0;
  double repeat_s_ = gige_repeat_s;  ///< a command whose answer took that long may have been sent again
  int frames_retaken_ = 0;
  bool is_gone_ = false;
  std::atomic<bool> control_lost_ = false;  // set by Aravis' heartbeat thread
};

AravisCamera::AravisCamera(CameraHandle camera, AravisAddress at, const CameraSettings& settings)
    : camera_(std::move(camera)), at_(std::move(at)), settings_(settings) {
  const auto on_control_lost =
      +[](ArvDevice*, gpointer self) { static_cast<AravisCamera*>(self)->control_lost_ = true; };
  g_signal_connect(arv_camera_get_device(camera_.get()), "control-lost", G_CALLBACK(on_control_lost), this);
}

AravisCamera::~AravisCamera() {
  g_signal_handlers_disconnect_by_data(arv_camera_get_device(camera_.get()), this);
  GFault ignored;  // there is nobody to tell, and nothing left to do
  if (stream_ && !is_gone_ && !control_lost_) arv_camera_stop_acquisition(camera_.get(), ignored.out());
  stream_.reset();
}

Status AravisCamera::start() {
  GFault ignored;  // a program that died may have left it streaming; a camera that is idle may refuse to stop
  arv_camera_stop_acquisition(camera_.get(), ignored.out());
  GFault fault;
  end_exposure(arv_camera_get_exposure_time(camera_.get(), ignored.out()) / us_per_s);
  info_ = {text_or_empty(arv_camera_get_vendor_name(camera_.get(), fault.out())),
           text_or_empty(arv_camera_get_model_name(camera_.get(), fault.out())),
           text_or_empty(arv_camera_get_device_serial_number(camera_.get(), fault.out())), at_.name};
  if (fault) return error("does not tell who it is (" + fault.text() + ")", "check that it is a GenICam camera");
  const Result<AppliedSettings> applied = apply_settings(camera_.get(), settings_);
  if (!applied) return tl::unexpected(applied.error());
  applied_ = *applied;
  info_.sensor_width_px = applied_.width_px;
  info_.sensor_height_px = applied_.height_px;
  if (Status chosen = set_packets(); !chosen) return chosen;
  if (settings_.gain != 0 && applied_.gain_db == 0)
    info_.found += (info_.found.empty() ? "" : ", ") + std::string("a gain that counts in a unit of its own, not dB");
  if (Status timed = ask_response_time(); !timed) return timed;
  return start_stream();
}

/// A frame that a program which died left in exposure is to come before the stream begins. The camera may end it first.
void AravisCamera::end_exposure(double left_s) {
  constexpr double short_s = 0.05;
  if (left_s > short_s) std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left_s, 10.0)));
}

/// Others than GigE Vision cameras send no packets that could be chosen.
Status AravisCamera::set_packets() {
  if (is_on_usb()) return {};
  const Result<StreamPackets> packets = choose_packets(camera_.get(), settings_, applied_, packets_name());
  if (!packets) return tl::unexpected(packets.error());
  if (settings_.packet_bytes == 0)
    info_.found =
        "\"packet_bytes\": " + std::to_string(packets->bytes) + ", \"packet_delay_us\": " + say(packets->delay_us);
  return {};
}

Status AravisCamera::ask_response_time() {
  ArvDevice* const device = arv_camera_get_device(camera_.get());
  if (!ARV_IS_UV_DEVICE(device)) return {};
  GFault fault;
  guint32 response_ms = 0;
  arv_device_read_memory(device, usb_response_time_address, sizeof response_ms, &response_ms, fault.out());
  if (fault) return refused(settings_, "a question for its response time", fault);
  repeat_s_ = std::max(least_usb_repeat_s, usb_repeat_s_per_ms * GUINT32_FROM_LE(response_ms));
  return {};
}

Status AravisCamera::start_stream() {
  Result<AravisStream> stream = AravisStream::start(camera_.get(), settings_, applied_);
  if (!stream) return tl::unexpected(stream.error());
  stream_.emplace(std::move(*stream));
  return {};
}

/// A frame that was due and never came is no answer to the next trigger, whenever it comes: the camera gives up its
/// exposure, or has the time to end it, and what arrives for the stream that was goes nowhere.
Status AravisCamera::pass_over_late_frames() {
  if (!stream_) return start_stream();
  stream_->drop_arrived();
  if (stream_->frames_due() == 0) return {};
  GFault fault;
  arv_camera_stop_acquisition(camera_.get(), fault.out());
  if (fault) return control_failure("a stop of the acquisition", fault);
  std::this_thread::sleep_for(std::chrono::duration<double>(frame_time_s()));
  stream_.reset();
  return start_stream();
}

Status AravisCamera::check_alive() {
  if (is_gone_) return gone("its link was lost before");
  if (control_lost_) return gone("control of it was lost");
  if (is_on_usb()) {
    GFault fault;
    guint32 version = 0;  // the first register of every bus
    arv_device_read_register(arv_camera_get_device(camera_.get()), 0, &version, fault.out());
    return fault ? gone("it does not answer (" + fault.text() + ")") : Status{};
  }
  const GvcpAnswer answer = probe_gvcp(at_.ipv4);
  if (answer.presence == GvcpPresence::refused) return gone("the host is there, but no camera on it");
  if (answer.presence == GvcpPresence::silent) return gone("it does not answer");
  if (!answer.controlled) return gone("it restarted, or another program released it");
  return {};
}

Status AravisCamera::apply_exposure(double exposure_s) {
  if (exposure_s == asked_exposure_s_) return {};
  constexpr double rounding = 1e-9;
  if (!(exposure_s >= applied_.shortest_s * (1 - rounding) && exposure_s <= applied_.longest_s * (1 + rounding)))
    return refused_for_good(
        error("an exposure of " + say(exposure_s) + " s is out of its range",
              "choose one from " + say(applied_.shortest_s) + " to " + say(applied_.longest_s) + " s")
            .value());
  asked_exposure_s_.reset();  // when an answer is lost, nobody knows which one it has
  GFault fault;
  const double whole_ns = std::round(exposure_s * 1e9);  // or 1100 µs come out as 1099 in cameras that count them
  arv_camera_set_exposure_time(camera_.get(), whole_ns / 1e3, fault.out());
  const double taken_us = arv_camera_get_exposure_time(camera_.get(), fault.out());
  if (fault) return control_failure("an exposure of " + say(exposure_s) + " s", fault);
  asked_exposure_s_ = exposure_s;
  exposure_s_ = taken_us / us_per_s;
  return {};
}

Status AravisCamera::control_failure(const std::string& what, const GFault& fault) {
  if (Status alive = check_alive(); !alive) return alive;
  return refused(settings_, what, fault);
}

/// Whether a frame that came just now, of the present exposure time, began before that.
bool AravisCamera::began_before(Clock::time_point time) const {
  constexpr double least_share = 0.9, clock_s = 1e-3;
  const double since_s = std::chrono::duration<double>(Clock::now() - time).count();
  return since_s < least_share * exposure_s_ - clock_s;
}

/// One that was sent again is due as many frames: a camera may carry it out each time, and only its answer was lost.
Status AravisCamera::trigger() {
  const Clock::time_point begin = Clock::now();
  GFault fault;
  arv_camera_software_trigger(camera_.get(), fault.out());
  const double spent_s = std::chrono::duration<double>(Clock::now() - begin).count();
  const int repeats = static_cast<int>(spent_s / repeat_s_);
  for (int sent = 0; sent <= repeats; ++sent) stream_->expect_frame();
  if (fault) return control_failure("a software trigger", fault);
  return {};
}

Result<RawImage> AravisCamera::expose(double exposure_s) {
  if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
  if (Status passed = pass_over_late_frames(); !passed) return tl::unexpected(passed.error());
  if (Status applied = apply_exposure(exposure_s); !applied) return tl::unexpected(applied.error());

  bool was_lost = false;
  for (int incomplete = 0; incomplete <= incomplete_limit;) {
    const Clock::time_point asked = Clock::now();
    if (Status sent = trigger(); !sent) return tl::unexpected(sent.error());
    AravisStream::Arrival arrival = stream_->next(frame_time_s());
    // One that comes before it can be exposed began before: a trigger was carried out twice.
    while (arrival.came && began_before(asked)) arrival = stream_->next(frame_time_s());
    if (!arrival.came) {
      if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
      if (was_lost)
        return error("no frame within " + say(frame_time_s()) + " s, twice, though the camera answers",
                     is_on_usb() ? "take another cable or port, or switch the camera off and on"
                                 : "check the firewall, and that the network passes packets of packet_bytes");
      was_lost = true;
      continue;
    }
    if (arrival.image) {
      arrival.image->exposure_s = exposure_s_;
      return std::move(*arrival.image);
    }
    ++incomplete;
    ++frames_retaken_;
  }
  if (!is_on_usb()) remember_packets(packets_name(), std::nullopt);  // found when the network was another
  return error(
      std::to_string(incomplete_limit + 1) + " incomplete frames in a row",
      is_on_usb()
          ? "take another cable or port, or take other devices off its bus"
          : "check cable and network, set packet_bytes to 0 to have it found, or raise net.core.rmem_max to 8 MiB");
}

}  // namespace

Result<std::unique_ptr<Camera>> open_aravis_camera(const CameraSettings& settings) {
  const Result<AravisAddress> at = aravis_address(settings.address);
  if (!at) return tl::unexpected(at.error());
  if (!at->ipv4.empty())
    if (Status is_free = await_free(at->ipv4, settings.address); !is_free) return tl::unexpected(is_free.error());

  Result<CameraHandle> handle = take_control(*at, settings.address);
  if (!handle) return tl::unexpected(handle.error());
  auto camera = std::make_unique<AravisCamera>(std::move(*handle), *at, settings);
  if (Status started = camera->start(); !started) return tl::unexpected(started.error());
  return camera;
}

}  // namespace lumifield
