#include "acquisition/stages/apt_stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

#include "acquisition/stages/apt_axis.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
using std::chrono::milliseconds;

constexpr milliseconds stop_time(3000);  // even slow stages brake from full speed in less
constexpr milliseconds poll_period(5);

/// Of another kind speeds have other units, and questions no answer.
Status check_controller(const AptHardware& hardware, const AptSettings& settings) {
  const std::string controller = apt_controller(hardware.model);
  if (controller.empty() || controller == settings.controller) return {};
  return fail("is a " + hardware.model + ", which the bench file calls " + settings.controller,
              std::to_string(hardware.serial), "set stage.apt.controller to \"" + controller + "\"");
}

class AptStage final : public Stage {
 public:
  AptStage(std::vector<std::unique_ptr<AptUnit>> units, const AptSettings& settings);

  Status prepare(const StageSettings& settings);

  const StageInfo& info() const override { return info_; }
  Status home(std::stop_token stop) override;
  Status move_to(const Vec2& target_mm, std::stop_token stop) override;
  Result<Vec2> position() override;
  void halt() override;

 private:
  tl::unexpected<Error> stopped() const;
  Status await(Seconds allowed, const std::string& remedy, std::stop_token stop);
  Status stop_moving(Error why);
  Status await_standing();
  Status check_reach(const Vec2& target_mm) const;

  std::vector<std::unique_ptr<AptUnit>> units_;
  AptSettings settings_;
  std::vector<AptAxis> axes_;
  StageInfo info_;
};

AptStage::AptStage(std::vector<std::unique_ptr<AptUnit>> units, const AptSettings& settings)
    : units_(std::move(units)), settings_(settings) {
  const bool is_cube = settings.controller == "kdc101", has_bays = units_.size() == 1;
  for (int axis : {0, 1}) {
    AptAxis::Setup setup;
    setup.name = "xy"[axis];
    if (!is_cube) setup.address = static_cast<std::uint8_t>(apt_first_bay + (has_bays ? axis : 0));
    setup.is_stepper = settings.controller == "bsc20x";
    setup.scale = apt_scale(settings.controller).value();
    setup.counts_per_mm = settings.counts_per_mm[axis];
    setup.direction = settings.direction[axis];
    setup.travel_mm = settings.travel_mm[axis];
    axes_.emplace_back(*units_[has_bays ? 0 : static_cast<std::size_t>(axis)], std::move(setup));
  }
  for (const std::string& serial : settings.serials) info_.path += (info_.path.empty() ? "" : ", ") + serial;
  info_.travel_mm = settings.travel_mm;
}

Status AptStage::prepare(const StageSettings& settings) {
  for (const auto& unit : units_) {
    const Result<AptHardware> hardware = unit->identify();
    if (!hardware) return tl::unexpected(hardware.error());
    if (Status fits = check_controller(*hardware, settings.apt); !fits) return fits;
    info_.firmware += (info_.firmware.empty() ? "" : ", ") + hardware->model + " " + hardware->firmware;
  }
  halt();
  if (Status standing = await_standing(); !standing) return standing;
  for (AptAxis& axis : axes_) {
    if (Status ready = axis.prepare(settings.rapid_mm_s, settings.acceleration_mm_s2); !ready) return ready;
    if (settings.home) continue;
    if (const Result<double> ready = axis.ready(); !ready) return tl::unexpected(ready.error());
  }
  info_.rapid_mm_s = std::min(axes_[0].speed_mm_s(), axes_[1].speed_mm_s());
  info_.acceleration_mm_s2 = std::min(axes_[0].acceleration_mm_s2(), axes_[1].acceleration_mm_s2());
  return {};
}

tl::unexpected<Error> AptStage::stopped() const {
  return tl::unexpected<Error>({"stopped by the operator", info_.path, {}, ErrorKind::stopped});
}

Status AptStage::home(std::stop_token stop) {
  if (stop.stop_requested()) return stopped();
  Seconds allowed(0);
  for (AptAxis& axis : axes_) {
    const Result<Seconds> longest = axis.start_home();
    if (!longest) return stop_moving(longest.error());
    allowed = std::max(allowed, *longest);
  }
  return await(allowed, "check the switches and the homing velocity", stop);
}

Status AptStage::check_reach(const Vec2& target_mm) const {
  const Vec2 far = settings_.direction.cwiseProduct(settings_.travel_mm);
  const Vec2 low = far.cwiseMin(Vec2::Zero()), high = far.cwiseMax(Vec2::Zero());
  if ((target_mm.array() >= low.array()).all() && (target_mm.array() <= high.array()).all()) return {};
  return fail("the target " + say(target_mm) + " mm lies beyond the travel, " + say(low) + " to " + say(high) + " mm",
              info_.path, "correct the plan, limits_mm or travel_mm");
}

Status AptStage::move_to(const Vec2& target_mm, std::stop_token stop) {
  if (stop.stop_requested()) return stopped();
  if (Status within = check_reach(target_mm); !within) return within;
  Seconds predicted(0);
  for (int axis : {0, 1}) {
    const Result<Seconds> time = axes_[static_cast<std::size_t>(axis)].start_move(target_mm[axis]);
    if (!time) return axis == 0 ? tl::unexpected(time.error()) : stop_moving(time.error());
    predicted = std::max(predicted, *time);
  }
  return await(2 * predicted + Seconds(2), "check its load and the controller's speeds", stop);
}

Status AptStage::await(Seconds allowed, const std::string& remedy, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  while (Clock::now() < start + allowed) {
    if (stop.stop_requested()) return stop_moving(stopped().value());
    bool ended = true;
    for (AptAxis& axis : axes_) {
      const Result<bool> well = axis.watch();
      if (!well) return stop_moving(well.error());
      ended = ended && *well;
    }
    if (ended) return {};
  }
  char text[64];
  std::snprintf(text, sizeof text, "did not arrive within %.1f s", allowed.count());
  return stop_moving({text, info_.path, remedy});
}

Status AptStage::stop_moving(Error why) {
  halt();
  // What is the reason is told once.
  if (Status standing = await_standing(); !standing && standing.error().what != why.what)
    return fail(why.what + "; and then: " + standing.error().what, why.where, standing.error().remedy);
  return tl::unexpected(std::move(why));
}

Status AptStage::await_standing() {
  const Clock::time_point deadline = Clock::now() + stop_time;
  while (Clock::now() < deadline) {
    bool standing = true;
    for (AptAxis& axis : axes_) {
      const Result<bool> stands = axis.stands();
      if (!stands) return tl::unexpected(stands.error());
      standing = standing && *stands;
    }
    if (standing) return {};
    std::this_thread::sleep_for(poll_period);
  }
  return fail("it does not stop", info_.path, "switch the stage off");
}

Result<Vec2> AptStage::position() {
  Vec2 at;
  for (int axis : {0, 1}) {
    const Result<double> mm = axes_[static_cast<std::size_t>(axis)].position();
    if (!mm) return tl::unexpected(mm.error());
    at[axis] = *mm;
  }
  return at;
}

void AptStage::halt() {
  for (AptAxis& axis : axes_) axis.stop_now();
}

/// `known`: its name, as far as USB tells it. `settings`: of a bench file, where one names it.
DeviceReport ask(const std::string& serial, const std::string& known, const AptSettings* settings = nullptr) {
  const Result<std::unique_ptr<AptUnit>> unit = AptUnit::open(serial);
  const Result<AptHardware> hardware = unit ? (*unit)->identify() : tl::unexpected(unit.error());
  if (!hardware) return {"stage", known, serial, false, hardware.error().what, hardware.error().remedy};
  DeviceReport report{"stage", "Thorlabs " + hardware->model + " " + std::to_string(hardware->serial), serial, true, {},
                      {}};
  report.serial = serial;
  report.capabilities = "firmware " + hardware->firmware + "; channels: " + std::to_string(hardware->channels);
  if (const std::string controller = apt_controller(hardware->model); !controller.empty())
    report.capabilities += "; controller " + controller;
  const Status fits = settings != nullptr ? check_controller(*hardware, *settings) : Status();
  if (!fits) report.usable = false, report.reason = fits.error().what, report.remedy = fits.error().remedy;
  return report;
}

}  // namespace

Result<std::unique_ptr<Stage>> open_apt_stage(const StageSettings& settings) {
  if (settings.apt.serials.empty() || !apt_scale(settings.apt.controller))
    return fail("does not say which controllers", "stage.apt", "name their serials and kind in the bench file");
  if (settings.check_home)
    return fail("cannot look for its home switches", "stage.check_home",
                "set it to false in the bench file; a servo's readings show lost steps");
  std::vector<std::unique_ptr<AptUnit>> units;
  for (const std::string& serial : settings.apt.serials) {
    Result<std::unique_ptr<AptUnit>> unit = AptUnit::open(serial);
    if (!unit) return tl::unexpected(unit.error());
    units.push_back(std::move(*unit));
  }
  auto stage = std::make_unique<AptStage>(std::move(units), settings.apt);
  if (Status prepared = stage->prepare(settings); !prepared) return tl::unexpected(prepared.error());
  return stage;
}

std::vector<DeviceReport> find_apt_stages(const std::string&) {
  std::vector<DeviceReport> reports;
  for (const FtdiDevice& device : FtdiLink::find(apt_usb_id)) {
    if (device.closed)
      reports.push_back(
          {"stage", device.product, device.closed->where, false, device.closed->what, device.closed->remedy});
    else
      reports.push_back(ask(device.serial, device.product));
  }
  return reports;
}

DeviceReport probe_apt_stage(const StageSettings& settings) {
  DeviceReport both{"stage", {}, {}, true, {}, {}};
  const auto add = [](std::string& list, const std::string& text, const char* between) {
    list.append(list.empty() ? "" : between).append(text);
  };
  for (const std::string& serial : settings.apt.serials) {
    const DeviceReport one = ask(serial, {}, &settings.apt);
    if (!one.usable) return one;
    add(both.name, one.name, ", "), add(both.address, serial, ", ");
    if (one.capabilities != both.capabilities) add(both.capabilities, one.capabilities, " | ");
    add(both.serial, serial, ", ");
  }
  return both;
}

}  // namespace lumifield
