#include "acquisition/virtual/v4l2_camera.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <linux/videodev2.h>
#include <thread>

#include "acquisition/virtual/v4l2_device.h"
#include "acquisition/virtual/v4l2_pixels.h"
#include "acquisition/virtual/video_file.h"

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point at) { return std::chrono::duration<double>(at.time_since_epoch()).count(); }
Clock::duration duration(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

bool is_known(const std::string& pixel_format) {
  return pixel_format == "Mono12" || pixel_format == "Mono16" || pixel_format == "BayerRG12";
}

std::vector<V4l2SensorFormat> formats_of(const V4l2CameraOptions& options) {
  std::vector<V4l2SensorFormat> formats = v4l2_sensor_formats(options.pixel_format);
  if (options.formats.empty()) return formats;
  std::erase_if(formats, [&](const V4l2SensorFormat& format) { return !options.formats.contains(format.fourcc); });
  return formats;
}

constexpr double exposure_unit_s = 1e-4, gain_unit_db = 0.1;

/// What the camera does by itself while it is let.
Exposure exposure_of(const std::map<std::uint32_t, int>& controls) {
  Exposure exposure;
  exposure.exposure_s = controls.at(V4L2_CID_EXPOSURE_ABSOLUTE) * exposure_unit_s;
  exposure.gain_db = controls.at(V4L2_CID_GAIN) * gain_unit_db;
  if (controls.at(V4L2_CID_EXPOSURE_AUTO) != V4L2_EXPOSURE_MANUAL) exposure.exposure_s = 0.0125;
  if (controls.at(V4L2_CID_AUTOGAIN) != 0) exposure.gain_db = 6;
  if (controls.at(V4L2_CID_AUTO_WHITE_BALANCE) != 0) exposure.gain_db += 1;
  if (controls.at(V4L2_CID_POWER_LINE_FREQUENCY) != 0)
    exposure.exposure_s = 0.01 * std::ceil(exposure.exposure_s / 0.01);
  exposure.gain_db += controls.at(V4L2_CID_BACKLIGHT_COMPENSATION);
  return exposure;
}

void bend(std::span<std::uint16_t> dn, int bits, int gamma) {
  if (gamma == 100) return;
  const double full = (1 << bits) - 1;
  for (std::uint16_t& value : dn)
    value = static_cast<std::uint16_t>(std::lround(full * std::pow(std::min(1.0, value / full), 100.0 / gamma)));
}

}  // namespace

struct V4l2Camera::Impl {
  V4l2CameraOptions options;
  Sight sight;
  int bits;
  V4l2Device device;
  std::unique_ptr<VideoFile> file;
  std::atomic<bool> frozen = false;
  std::atomic<std::uint64_t> sent = 0;

  struct Shot {
    Exposure exposure;
    int gamma;
    bool moved;
    double begin_s;
  };
  std::deque<std::map<std::uint32_t, int>> set;  // latest controls, the last at the end
  std::deque<Shot> held;                         // shots that are late
  std::uint64_t frames = 0;
  std::jthread thread;  // the last: it uses all of them

  Impl(const V4l2CameraOptions& camera, Sight seen)
      : options(camera),
        sight(std::move(seen)),
        bits(camera.pixel_format == "Mono16" ? 16 : 12),
        device({camera.serial, formats_of(camera), camera.width_px, camera.height_px, camera.frame_interval_s,
                camera.clips_exposure, camera.stubborn, camera.missing, camera.is_for_screens}) {}

  void run(std::stop_token stop) {
    auto begin = Clock::now();
    while (!stop.stop_requested()) {
      const auto settings = device.settings();
      if (!settings) {
        held.clear();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        begin = Clock::now();
        continue;
      }
      begin = std::max(begin, Clock::now());
      begin += duration(take_frame(*settings, begin, stop));
    }
  }

  /// One frame of the free run; how long it takes.
  double take_frame(const V4l2Device::Settings& settings, Clock::time_point begin, std::stop_token stop) {
    set.push_back(settings.controls);
    while (set.size() > static_cast<std::size_t>(options.slow_controls) + 1) set.pop_front();
    Exposure exposure = exposure_of(set.front());
    if (options.clips_exposure) exposure.exposure_s = std::min(exposure.exposure_s, settings.frame_interval_s);
    exposure.width_px = options.width_px, exposure.height_px = options.height_px;
    exposure.stage_mm = sight.stage_mm();
    const auto end = begin + duration(exposure.exposure_s);
    wait_until(end, settings.stream, stop);
    const bool moved = sight.stage_mm() != exposure.stage_mm;
    const auto gamma = set.front().find(V4L2_CID_GAMMA);
    held.push_back({exposure, gamma == set.front().end() ? 100 : gamma->second, moved, seconds(begin)});
    if (held.size() > static_cast<std::size_t>(options.late_frames)) {
      const Shot shot = held.front();
      held.pop_front();
      if (!frozen) send(settings, shot);
    }
    const double taken_s = std::max(settings.frame_interval_s, exposure.exposure_s);
    wait_until(begin + duration(taken_s), settings.stream, stop);
    return taken_s;
  }

  /// Until then, or the end of the stream.
  void wait_until(Clock::time_point end, std::uint64_t stream, std::stop_token stop) const {
    while (Clock::now() < end && !stop.stop_requested() && device.streams(stream))
      std::this_thread::sleep_until(std::min(end, Clock::now() + std::chrono::milliseconds(10)));
  }

  void send(const V4l2Device::Settings& settings, const Shot& shot) {
    ++frames;
    const auto each = [this](int every) { return every > 0 && frames % static_cast<std::uint64_t>(every) == 0; };
    if (each(options.lost_every)) return device.lose_frame();
    const auto buffer = device.begin_frame(settings.stream);
    if (!buffer) return;
    std::vector<std::uint16_t> dn(static_cast<std::size_t>(options.width_px) * options.height_px);
    if (shot.moved) {
      std::ranges::fill(dn, static_cast<std::uint16_t>((1 << bits) - 1));
    } else {
      sight.wait_ready(shot.exposure.stage_mm);
      sight.expose(shot.exposure, dn);
      bend(dn, bits, shot.gamma);
    }
    std::vector<std::uint8_t> bytes(settings.buffer_bytes);
    pack(dn, bits, settings.fourcc, options.width_px, bytes);
    file->store(*buffer, bytes);
    // By the clock of the sensor, whatever this machine is busy with.
    const double late_s = shot.exposure.exposure_s + options.late_frames * settings.frame_interval_s;
    const double stamp_s = shot.begin_s + (options.late_frames > 0 ? late_s : 0);
    if (!device.end_frame(settings.stream, *buffer, stamp_s, each(options.damaged_every))) return;
    ++sent;
    file->notify();
  }
};

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::start(const V4l2CameraOptions& options, Sight sight) {
  if (!is_known(options.pixel_format))
    return fail("pixel format unknown", options.pixel_format, "give Mono12, Mono16 or BayerRG12");
  if (formats_of(options).empty())
    return fail("no format is left of those of a sensor with " + options.pixel_format, "virtual V4L2 camera", {});
  auto impl = std::make_unique<Impl>(options, std::move(sight));
  auto file = VideoFile::mount(options.folder, impl->device);
  if (!file) return tl::unexpected(file.error());
  impl->file = std::move(*file);
  impl->thread = std::jthread([self = impl.get()](std::stop_token stop) { self->run(stop); });
  return std::unique_ptr<V4l2Camera>(new V4l2Camera(std::move(impl)));
}

V4l2Camera::V4l2Camera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
V4l2Camera::~V4l2Camera() { impl_->device.unplug(); }

std::filesystem::path V4l2Camera::path() const { return impl_->file->path(); }
void V4l2Camera::freeze(bool frozen) { impl_->frozen = frozen; }
std::uint64_t V4l2Camera::frames_sent() const { return impl_->sent; }
int V4l2Camera::control(std::uint32_t id) const {
  v4l2_control control{id, 0};
  return impl_->device.answer(0, VIDIOC_G_CTRL, &control) == 0 ? control.value : -1;
}

}  // namespace lumifield::virtual_bench
