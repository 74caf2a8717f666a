#include "acquisition/virtual/bench_devices.h"

#include "acquisition/virtual/apt_controller.h"
#include "acquisition/virtual/usb3_camera.h"

namespace lumifield::virtual_bench {
namespace {

/// The bench's camera, of the kind and with the world that the options name, and how the bench file names it. Switched
/// off and on again it is another one at the same place, with the same serial number; one on USB is unplugged.
Status start_camera(DeviceOptions& options, Devices& devices, const std::filesystem::path& folder,
                    CameraSettings& settings) {
  const WorldOptions& world = options.world;
  const std::string serial = "LF" + std::to_string(world.seed % 1'000'000);
  const auto look_at_world = [&](auto& camera) {
    camera.pixel_format = world.pixel_format, camera.serial = serial;
    camera.width_px = world.width_px, camera.height_px = world.height_px;
  };
  look_at_world(options.camera.genicam);
  options.camera.genicam.automatics = true;
  look_at_world(options.video);
  options.video.folder = folder / "video";
  const Sight sight{.stage_mm = [&] { return devices.exposed_at(); },
                    .wait_ready = [&](const Vec2& at) { devices.world->wait_ready(at); },
                    .expose =
                        [&](const Exposure& e, std::span<std::uint16_t> dn) {
                          devices.world->expose(e.stage_mm, e.exposure_s, e.gain_db, e.width_px, e.height_px,
                                                e.offset_x_px, e.offset_y_px, dn);
                        }};
  if (options.camera_kind == "usb3") {
    auto camera = Usb3Camera::start(*devices.usb, {.genicam = options.camera.genicam}, sight);
    if (!camera) return tl::unexpected(camera.error());
    settings.address = serial;
    devices.switch_camera = [camera = camera->get()](bool off) {
      if (off) camera->unplug();
      return off ? Status() : camera->plug();
    };
    devices.camera = std::move(*camera);
    return {};
  }
  settings.address = options.camera.address;
  if (options.camera_kind == "v4l2") settings.kind = "v4l2", settings.address = options.video.folder / "video0";
  devices.switch_camera = [&options, &devices, sight](bool off) -> Status {
    devices.camera.reset();
    if (off) return {};
    const auto keep = [&](auto camera) -> Status {
      if (!camera) return tl::unexpected(camera.error());
      devices.camera = std::move(*camera);
      return {};
    };
    return options.camera_kind == "v4l2" ? keep(V4l2Camera::start(options.video, sight))
                                         : keep(GigeCamera::start(options.camera, sight));
  };
  return devices.switch_camera(false);
}

/// The stage that the options name, and how the bench file names it.
Status start_stage(DeviceOptions& options, Devices& devices, const std::filesystem::path& folder, Bench& bench) {
  const auto prepare = [&devices](const Vec2& at) { devices.world->prepare(at); };
  // The stage reads 0 … travel, which holds the bench's limits.
  options.stage.travel_mm = bench.limits.high_mm;
  if (options.stage_kind == "grbl") {
    if (options.stage.path.empty()) options.stage.path = folder / "stage";
    auto stage = GrblController::start(options.stage, prepare);
    if (!stage) return tl::unexpected(stage.error());
    bench.stage.path = options.stage.path;
    devices.stage = std::move(*stage);
    return {};
  }
  AptOptions apt;
  if (options.stage_kind == "apt-rack") apt.kind = AptOptions::Kind::stepper_rack;
  if (options.stage_kind == "apt-servo-rack") apt.kind = AptOptions::Kind::servo_rack;
  apt.travel_mm = options.stage.travel_mm;
  apt.rapid_mm_s = options.stage.rapid_mm_s;
  apt.acceleration_mm_s2 = options.stage.acceleration_mm_s2;
  auto stage = AptController::start(*devices.usb, apt, prepare);
  if (!stage) return tl::unexpected(stage.error());
  bench.stage.kind = "apt";
  bench.stage.apt = {(*stage)->serials(), (*stage)->controller(), Vec2::Constant((*stage)->counts_per_mm()), Vec2(1, 1),
                     apt.travel_mm};
  devices.stage = std::move(*stage);
  return {};
}

}  // namespace

Result<Bench> start_devices(DeviceOptions& options, Devices& devices, const std::filesystem::path& folder) {
  auto world = World::create(options.world);
  if (!world) return tl::unexpected(world.error());
  devices.world = std::move(*world);
  Bench bench = devices.world->bench();
  if (options.has_usb()) {
    auto usb = UsbBus::create();
    if (!usb) return tl::unexpected(usb.error());
    devices.usb = std::move(*usb);
  }
  if (Status stage = start_stage(options, devices, folder, bench); !stage) return tl::unexpected(stage.error());
  if (Status camera = start_camera(options, devices, folder, bench.camera); !camera)
    return tl::unexpected(camera.error());
  return bench;
}

KnobPanel make_knobs(Devices& bench) {
  const auto fault = [](const char* values, auto act) {
    return Knob{values, [act](double value) { return act(value), Status(); }, {}};
  };
  KnobPanel knobs{
      {"lost_steps", fault("mm per move", [&](double value) { bench.stage->lose_steps(value); })},
      {"backlash", fault("mm", [&](double value) { bench.stage->set_backlash(value); })},
      {"stuck_stage", fault("0|1", [&](double value) { bench.stage->stick(value != 0); })},
      {"silent_stage", fault("0|1", [&](double value) { bench.stage->silence(value != 0); })},
      {"stage_alarm", fault("1", [&](double value) { value != 0 ? bench.stage->trip_limit() : void(); })},
      {"unplugged_stage",
       {"0|1, of a stage on USB", [&](double value) { return bench.stage->unplug(value != 0); }, {}}},
      {"frozen_camera", fault("0|1", [&](double value) { bench.camera ? bench.camera->freeze(value != 0) : void(); })},
      {"camera_off", {"0|1", [&](double value) { return bench.switch_camera(value != 0); }, {}}},
      {"frames", {"read only", {}, [&] { return std::to_string(bench.camera ? bench.camera->frames_sent() : 0); }}},
      {"lamp_light",
       {"read only, 1 without drift and warm-up", {}, [&] { return std::to_string(bench.world->light()); }}},
      {"worst_off",
       {"read only, mm: farthest that the stage truly stood from its reading in an exposure since last read",
        {},
        [&] { return std::to_string(bench.worst_off_mm.exchange(0)); }}},
      {"true_position", {"read only, mm", {}, [&] {
                           const Vec2 at = bench.stage->true_position_mm();
                           return std::to_string(at.x()) + " " + std::to_string(at.y());
                         }}}};
  for (const auto& [name, values] :
       {std::pair{"noise", "0|1"},
        {"optics", "0|1"},
        {"filter", "0|1, 0: no slide"},
        {"slide", "0|1|2, 0: the one with both filters, 1: with the positive, 2: the negative"},
        {"lamp_drift", "relative change per hour"},
        {"lamp_warm_up", "relative excess of its light, from now on fading"},
        {"lamp_warm_up_s", "time constant of that, from now on"}})
    knobs[name] = {values, [&bench, name = name](double value) { return bench.world->set(name, value); }, {}};
  return knobs;
}

}  // namespace lumifield::virtual_bench
