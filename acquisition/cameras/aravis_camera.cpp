#include "acquisition/cameras/aravis_camera.h"

#include <algorithm>
#include <arv.h>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "acquisition/cameras/aravis_settings.h"
#include "acquisition/cameras/gvcp_probe.h"
#include "acquisition/cameras/pixel_layout.h"

namespace lumifield {
namespace {

constexpr double watchdog_s = 0.3;
constexpr int incomplete_limit = 5;
constexpr int buffers = 4;
constexpr int socket_bytes = 8 << 20;  // the kernel cuts it to net.core.rmem_max
constexpr double us_per_s = 1e6;

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
using CameraHandle = std::unique_ptr<ArvCamera, Unref>;
using StreamHandle = std::unique_ptr<ArvStream, Unref>;

class AravisCamera final : public Camera {
 public:
  AravisCamera(CameraHandle camera, std::string address, const CameraSettings& settings);
  ~AravisCamera() override;

  /// Applies the settings and starts the stream.
  Status start();

  const CameraInfo& info() const override { return info_; }
  Result<RawImage> expose(double exposure_s) override;
  int frames_retaken() const override { return frames_retaken_; }

 private:
  Status start_stream();
  Status apply_exposure(double exposure_s);
  Status check_alive();
  Status trigger();
  Status control_failure(const std::string& what, const GFault& fault);
  void drop_stale_frames();
  /// The next new buffer, complete or not; null when none comes in `wait_s`.
  ArvBuffer* next_buffer(double wait_s);
  std::optional<RawImage> take(ArvBuffer* buffer) const;
  double frame_time_s() const { return exposure_s_ + settings_.readout_s + watchdog_s; }

  tl::unexpected<Error> error(std::string what, std::string remedy) const {
    return fail(std::move(what), "camera " + settings_.address, std::move(remedy));
  }
  tl::unexpected<Error> gone(const std::string& how) {
    is_gone_ = true;
    return error("camera gone: " + how, "check cable and power, then open it again");
  }

  CameraHandle camera_;
  StreamHandle stream_;
  std::string ip_;
  CameraSettings settings_;
  CameraInfo info_;
  AppliedSettings applied_;
  std::optional<double> asked_exposure_s_;
  double exposure_s_ = 0;
  int frames_retaken_ = 0;
  int unanswered_triggers_ = 0;
  std::optional<std::uint64_t> last_frame_id_;
  bool is_gone_ = false;
  std::atomic<bool> control_lost_ = false;  // set by Aravis' heartbeat thread
};

AravisCamera::AravisCamera(CameraHandle camera, std::string address, const CameraSettings& settings)
    : camera_(std::move(camera)), ip_(std::move(address)), settings_(settings) {
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
  info_ = {text_or_empty(arv_camera_get_vendor_name(camera_.get(), fault.out())),
           text_or_empty(arv_camera_get_model_name(camera_.get(), fault.out())),
           text_or_empty(arv_camera_get_device_serial_number(camera_.get(), fault.out())),
           ip_,
           0,
           0};
  if (fault) return error("does not tell who it is (" + fault.text() + ")", "check that it is a GigE Vision camera");
  const Result<AppliedSettings> applied = apply_settings(camera_.get(), settings_);
  if (!applied) return tl::unexpected(applied.error());
  applied_ = *applied;
  info_.sensor_width_px = applied_.width_px;
  info_.sensor_height_px = applied_.height_px;
  return start_stream();
}

Status AravisCamera::start_stream() {
  GFault fault;
  const guint payload = arv_camera_get_payload(camera_.get(), fault.out());
  if (fault) return refused(settings_, "a question for its frame size", fault);
  const std::size_t pixels = static_cast<std::size_t>(applied_.width_px) * applied_.height_px;
  if (payload < pixels * applied_.layout.bytes_per_pixel() ||
      payload > 2 * pixels * applied_.layout.bytes_per_pixel() + (1 << 20))
    return error("announces frames of " + std::to_string(payload) + " bytes", "switch chunk data off in the camera");

  stream_.reset(arv_camera_create_stream(camera_.get(), nullptr, nullptr, fault.out()));
  if (!stream_) return refused(settings_, "a stream", fault);
  g_object_set(stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", socket_bytes,
               nullptr);
  for (int i = 0; i < buffers; ++i) arv_stream_push_buffer(stream_.get(), arv_buffer_new(payload, nullptr));
  arv_camera_start_acquisition(camera_.get(), fault.out());
  if (fault) return refused(settings_, "a start of the acquisition", fault);
  return {};
}

Status AravisCamera::check_alive() {
  if (is_gone_) return gone("its link was lost before");
  if (control_lost_) return gone("control of it was lost");
  const GvcpAnswer answer = probe_gvcp(ip_);
  if (answer.presence == GvcpPresence::refused) return gone("the host is there, but no camera on it");
  if (answer.presence == GvcpPresence::silent) return gone("it does not answer");
  if (!answer.controlled) return gone("it restarted, or another program released it");
  return {};
}

Status AravisCamera::apply_exposure(double exposure_s) {
  if (exposure_s == asked_exposure_s_) return {};
  constexpr double rounding = 1e-9;
  if (!(exposure_s >= applied_.shortest_s * (1 - rounding) && exposure_s <= applied_.longest_s * (1 + rounding)))
    return error("an exposure of " + number(exposure_s) + " s is out of its range",
                 "choose one from " + number(applied_.shortest_s) + " to " + number(applied_.longest_s) + " s");
  GFault fault;
  const double whole_ns = std::round(exposure_s * 1e9);  // or 1100 µs come out as 1099 in cameras that count them
  arv_camera_set_exposure_time(camera_.get(), whole_ns / 1e3, fault.out());
  const double taken_us = arv_camera_get_exposure_time(camera_.get(), fault.out());
  if (fault) return control_failure("an exposure of " + number(exposure_s) + " s", fault);
  asked_exposure_s_ = exposure_s;
  exposure_s_ = taken_us / us_per_s;
  return {};
}

Status AravisCamera::control_failure(const std::string& what, const GFault& fault) {
  if (Status alive = check_alive(); !alive) return alive;
  return refused(settings_, what, fault);
}

Status AravisCamera::trigger() {
  GFault fault;
  arv_camera_software_trigger(camera_.get(), fault.out());
  if (fault) return control_failure("a software trigger", fault);
  ++unanswered_triggers_;
  return {};
}

ArvBuffer* AravisCamera::next_buffer(double wait_s) {
  using Seconds = std::chrono::duration<double>;
  const auto deadline = std::chrono::steady_clock::now() + Seconds(wait_s);
  while (true) {
    const double left_s = Seconds(deadline - std::chrono::steady_clock::now()).count();
    ArvBuffer* const buffer =
        left_s > 0 ? arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(left_s * us_per_s))
                   : arv_stream_try_pop_buffer(stream_.get());
    if (buffer == nullptr) return nullptr;
    const std::uint64_t id = arv_buffer_get_frame_id(buffer);
    if (id != last_frame_id_) {
      last_frame_id_ = id;
      unanswered_triggers_ = std::max(0, unanswered_triggers_ - 1);
      return buffer;
    }
    arv_stream_push_buffer(stream_.get(), buffer);  // sent twice
  }
}

void AravisCamera::drop_stale_frames() {
  // The frame of a trigger that seemed lost may still be on its way, with another exposure than the next.
  while (ArvBuffer* const buffer = next_buffer(unanswered_triggers_ > 0 ? frame_time_s() : 0))
    arv_stream_push_buffer(stream_.get(), buffer);
  unanswered_triggers_ = 0;
}

std::optional<RawImage> AravisCamera::take(ArvBuffer* buffer) const {
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return std::nullopt;
  if (arv_buffer_get_payload_type(buffer) != ARV_BUFFER_PAYLOAD_TYPE_IMAGE ||
      arv_buffer_get_image_pixel_format(buffer) != applied_.format ||
      arv_buffer_get_image_width(buffer) != applied_.width_px ||
      arv_buffer_get_image_height(buffer) != applied_.height_px)
    return std::nullopt;
  std::size_t size = 0;
  const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
  const std::size_t pixels = static_cast<std::size_t>(applied_.width_px) * applied_.height_px;
  if (size < pixels * applied_.layout.bytes_per_pixel()) return std::nullopt;

  RawImage image;
  image.width_px = applied_.width_px;
  image.height_px = applied_.height_px;
  image.bits = applied_.layout.bits;
  image.pattern = applied_.layout.pattern;
  image.dn = unpack({bytes, size}, pixels, applied_.layout);
  image.exposure_s = exposure_s_;
  image.gain = applied_.gain_db;
  image.frame_id = arv_buffer_get_frame_id(buffer);
  return image;
}

Result<RawImage> AravisCamera::expose(double exposure_s) {
  if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
  drop_stale_frames();
  if (Status applied = apply_exposure(exposure_s); !applied) return tl::unexpected(applied.error());

  bool was_lost = false;
  for (int incomplete = 0; incomplete <= incomplete_limit;) {
    if (Status sent = trigger(); !sent) return tl::unexpected(sent.error());
    ArvBuffer* const buffer = next_buffer(frame_time_s());
    if (buffer == nullptr) {
      if (Status alive = check_alive(); !alive) return tl::unexpected(alive.error());
      if (was_lost)
        return error("no frame within " + number(frame_time_s()) + " s, twice, though the camera answers",
                     "check the firewall, and that the network passes packets of packet_bytes");
      was_lost = true;
      continue;
    }
    std::optional<RawImage> image = take(buffer);
    arv_stream_push_buffer(stream_.get(), buffer);
    if (image) return std::move(*image);
    ++incomplete;
    ++frames_retaken_;
  }
  return error(std::to_string(incomplete_limit + 1) + " incomplete frames in a row",
               "check the network, lower packet_bytes, or raise net.core.rmem_max to 8 MiB");
}

tl::unexpected<Error> not_there(const std::string& address, GvcpPresence presence) {
  return fail(presence == GvcpPresence::refused ? "the host answers, but no camera on it" : "no camera answers",
              "camera " + address, "check cable, power and address; `lumifield devices` lists what answers");
}

/// The address behind a camera's id or serial number.
Result<std::string> look_up(const std::string& name) {
  if (is_ipv4_address(name)) return name;
  arv_update_device_list();
  for (guint i = 0; i < arv_get_n_devices(); ++i)
    if (name == text_or_empty(arv_get_device_id(i)) || name == text_or_empty(arv_get_device_serial_nbr(i)))
      if (const std::string ip = text_or_empty(arv_get_device_address(i)); is_ipv4_address(ip)) return ip;
  return not_there(name, GvcpPresence::silent);
}

/// Waits until no other program controls the camera.
Status await_free(const std::string& ip, const std::string& name) {
  GvcpAnswer answer = probe_gvcp(ip);
  if (answer.presence != GvcpPresence::present) return not_there(name, answer.presence);
  if (!answer.controlled) return {};
  std::this_thread::sleep_for(gvcp_heartbeat_timeout(ip) + std::chrono::milliseconds(300));
  answer = probe_gvcp(ip);
  if (answer.presence != GvcpPresence::present) return not_there(name, answer.presence);
  if (answer.controlled) return fail("held by another program", "camera " + name, "close the other program");
  return {};
}

}  // namespace

Result<std::unique_ptr<Camera>> open_aravis_camera(const CameraSettings& settings) {
  const Result<std::string> ip = look_up(settings.address);
  if (!ip) return tl::unexpected(ip.error());
  if (Status is_free = await_free(*ip, settings.address); !is_free) return tl::unexpected(is_free.error());

  GFault fault;
  CameraHandle handle(arv_camera_new(ip->c_str(), fault.out()));
  if (!handle)
    return fail("cannot be opened (" + fault.text() + ")", "camera " + settings.address, "switch it off and on");
  ArvDevice* const device = arv_camera_get_device(handle.get());
  if (!ARV_IS_GV_DEVICE(device) || !arv_gv_device_is_controller(ARV_GV_DEVICE(device)))
    return fail("held by another program", "camera " + settings.address, "close the other program");
  auto camera = std::make_unique<AravisCamera>(std::move(handle), *ip, settings);
  if (Status started = camera->start(); !started) return tl::unexpected(started.error());
  return camera;
}

std::vector<DeviceReport> find_aravis_cameras() {
  std::vector<DeviceReport> reports;
  arv_update_device_list();
  for (guint i = 0; i < arv_get_n_devices(); ++i) {
    DeviceReport report;
    report.role = "camera";
    report.name = text_or_empty(arv_get_device_vendor(i)) + " " + text_or_empty(arv_get_device_model(i)) + " " +
                  text_or_empty(arv_get_device_serial_nbr(i));
    report.address = text_or_empty(arv_get_device_address(i));
    const GvcpAnswer answer = probe_gvcp(report.address);
    if (text_or_empty(arv_get_device_protocol(i)) != "GigEVision") {
      report.reason = "it does not speak GigE Vision";
      report.remedy = "use a GigE Vision camera";
    } else if (answer.presence != GvcpPresence::present) {
      report.reason = "it answers the discovery, but cannot be reached";
      report.remedy = "give it an address in the subnet of this computer's network card";
    } else if (answer.controlled) {
      report.reason = "held by another program";
      report.remedy = "close the other program";
    } else {
      report.usable = true;
    }
    reports.push_back(std::move(report));
  }
  return reports;
}

}  // namespace lumifield
