#include "acquisition/stages/grbl_stage.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>

#include "acquisition/stages/grbl_dialogue.h"

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using Seconds = std::chrono::duration<double>;

constexpr milliseconds poll_period(5);
constexpr milliseconds start_time(300);                // an accepted move has started by then, or never will
constexpr double farthest_mm = 1e5;                    // keeps the command within GRBL's line of 80 characters
constexpr double feed_per_s = 60;                      // GRBL's rates are mm/min
constexpr double look_mm = 0.1, close_look_mm = 0.01;  // steps in which a home switch is gone to
constexpr double farthest_slip_mm = 2;                 // is looked for beyond a home switch

tl::unexpected<Error> stopped(const std::string& path) {
  return tl::unexpected<Error>({"stopped by the operator", path, {}, ErrorKind::stopped});
}

/// Duration of a move over `delta` that starts and ends at rest, the axes keeping one straight line.
double trapezoid_s(const Vec2& delta, const Vec2& speed, const Vec2& acceleration) {
  const double distance = delta.norm();
  if (distance == 0) return 0;

  // Speed and acceleration along the line: the axis that reaches its limit first decides.
  double v = INFINITY, a = INFINITY;
  for (int axis = 0; axis < 2; ++axis) {
    const double share = std::abs(delta[axis]) / distance;
    if (share == 0) continue;
    v = std::min(v, speed[axis] / share);
    a = std::min(a, acceleration[axis] / share);
  }
  return distance >= v * v / a ? distance / v + v / a : 2 * std::sqrt(distance / a);
}

class GrblStage final : public Stage {
 public:
  GrblStage(std::unique_ptr<GrblDialogue> dialogue, bool check_home);

  const StageInfo& info() const override { return info_; }
  Status home(std::stop_token stop) override;
  Status move_to(const Vec2& target_mm, std::stop_token stop) override;
  Result<Vec2> position() override;
  Result<Vec2> slipped_mm(std::stop_token stop) override;
  void halt() override { dialogue_->send_now(homing_ ? GrblDialogue::reset_byte : GrblDialogue::hold); }

  /// Standing still and not locked. Ends a feed hold that came before.
  Result<GrblStatus> ready();
  /// That nothing stands in the way of looking for the switches.
  Status can_check_home() const;

 private:
  Vec2 setting_xy(int number) const { return {dialogue_->setting(number), dialogue_->setting(number + 1)}; }
  Seconds homing_time() const;
  Status await_homed(std::stop_token stop);
  Status find_switches(std::stop_token stop);
  Result<Vec2> find_closing(std::stop_token stop);
  Result<Vec2> find_closing(const Vec2& from_mm, double step_mm, std::stop_token stop);
  double reach_mm() const { return dialogue_->setting_or(27, 1) + farthest_slip_mm; }
  Status await_arrival(const Vec2& target_mm, Seconds predicted, std::stop_token stop);
  Status stop_moving(Error why);
  Error not_moving_error(const GrblStatus& status) const;

  std::unique_ptr<GrblDialogue> dialogue_;
  StageInfo info_;
  Vec2 speed_mm_s_, acceleration_mm_s2_, resolution_mm_;
  const bool check_home_;
  Vec2 home_mm_{0, 0};              ///< where homing ends
  Vec2 to_switch_{1, 1};            ///< per axis, the direction in which homing seeks
  std::optional<Vec2> closing_mm_;  ///< where the switches close; unknown since homing failed
  std::atomic<bool> homing_ = false;
};

GrblStage::GrblStage(std::unique_ptr<GrblDialogue> dialogue, bool check_home)
    : dialogue_(std::move(dialogue)),
      speed_mm_s_(setting_xy(110) / feed_per_s),
      acceleration_mm_s2_(setting_xy(120)),
      resolution_mm_(setting_xy(100).cwiseInverse()),
      check_home_(check_home) {
  info_.firmware = dialogue_->firmware();
  info_.path = dialogue_->path();
  info_.rapid_mm_s = speed_mm_s_.minCoeff();
  info_.acceleration_mm_s2 = acceleration_mm_s2_.minCoeff();
  info_.travel_mm = setting_xy(130);

  // Reports are rounded to 0.001 mm, or 0.0001 inch.
  resolution_mm_.array() += dialogue_->setting_or(13, 0) != 0 ? 0.0013 : 0.0006;

  // A bit of $23 turns an axis' homing to its low end.
  const int turned = static_cast<int>(dialogue_->setting_or(23, 0));
  for (int axis : {0, 1})
    if ((turned & (1 << axis)) != 0) to_switch_[axis] = -1;
}

Error GrblStage::not_moving_error(const GrblStatus& status) const {
  switch (status.state) {
    case GrblState::alarm:
      return {"locked by an alarm; its position is unknown", info_.path, "home the stage"};
    case GrblState::door:
      return {"the safety door is open", info_.path, "close the door, then home"};
    case GrblState::hold:
      return {"put on hold", info_.path, "release the hold button"};
    default:
      return {"busy with something else", info_.path, "switch the stage off and on, then home"};
  }
}

Result<GrblStatus> GrblStage::ready() {
  Result<GrblStatus> status = dialogue_->status();
  if (status && status->state == GrblState::hold) {
    if (Status left = dialogue_->stop_and_reset(); !left) return tl::unexpected(left.error());
    status = dialogue_->status();
  }
  if (status && status->state != GrblState::idle) return tl::unexpected(not_moving_error(*status));
  return status;
}

Seconds GrblStage::homing_time() const {
  // Each axis may search 1.5 times its travel, then finds the switch again slowly over a few pull-offs.
  const double travel = setting_xy(130).sum() + dialogue_->setting_or(132, 0);
  const double seek = std::max(1., dialogue_->setting_or(25, 500)) / feed_per_s;
  const double feed = std::max(1., dialogue_->setting_or(24, 25)) / feed_per_s;
  const double pull_off = dialogue_->setting_or(27, 1);
  return Seconds(2 * (1.5 * travel / seek + 3 * 10 * pull_off / feed) + 10);
}

Status GrblStage::home(std::stop_token stop) {
  if (stop.stop_requested()) return stopped(info_.path);
  closing_mm_.reset();
  if (Status clear = dialogue_->reset(); !clear) return clear;
  homing_ = true;
  Status homed = dialogue_->send("$H");
  if (homed) homed = await_homed(stop);
  homing_ = false;
  if (!homed) return homed;
  const Result<GrblStatus> status = ready();
  if (!status) return tl::unexpected(status.error());
  home_mm_ = status->position;
  return check_home_ ? find_switches(stop) : Status{};
}

Status GrblStage::await_homed(std::stop_token stop) {
  const Clock::time_point deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(homing_time());
  while (Clock::now() < deadline) {
    const Result<bool> done = dialogue_->await_ok(milliseconds(20));
    if (!done) return tl::unexpected(done.error());
    if (*done) return {};
    if (!stop.stop_requested()) continue;
    if (Status reset = dialogue_->reset(); !reset) return reset;
    return stopped(info_.path);
  }
  if (Status reset = dialogue_->reset(); !reset) return reset;
  return fail("homing did not end within " + std::to_string(std::lround(homing_time().count())) + " s", info_.path,
              "check the switches and the homing speeds $24, $25");
}

Status GrblStage::move_to(const Vec2& target_mm, std::stop_token stop) {
  if (stop.stop_requested()) return stopped(info_.path);
  if (!(target_mm.array().abs() < farthest_mm).all())
    return fail("the target is not a position within 100 m", info_.path, "correct the plan");
  const Result<GrblStatus> from = ready();
  if (!from) return tl::unexpected(from.error());
  const Seconds predicted(trapezoid_s(target_mm - from->position, speed_mm_s_, acceleration_mm_s2_));

  // G53: machine coordinates, whatever work offset is set.
  char line[96];
  std::snprintf(line, sizeof line, "G21 G90 G53 G0 X%.4f Y%.4f", target_mm.x(), target_mm.y());
  if (Status accepted = dialogue_->command(line); !accepted) return accepted;
  return await_arrival(target_mm, predicted, stop);
}

Status GrblStage::await_arrival(const Vec2& target_mm, Seconds predicted, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  const Seconds allowed = 2 * predicted + Seconds(2);
  bool has_moved = false;
  while (Clock::now() < start + allowed) {
    if (stop.stop_requested()) return stop_moving(stopped(info_.path).value());
    const Result<GrblStatus> status = dialogue_->status();
    if (!status) return tl::unexpected(status.error());

    if (status->state == GrblState::run) {
      has_moved = true;
    } else if (status->state != GrblState::idle) {
      const Error why = stop.stop_requested() ? stopped(info_.path).value() : not_moving_error(*status);
      return status->state == GrblState::hold ? stop_moving(why) : tl::unexpected(why);
    } else if (((status->position - target_mm).cwiseAbs().array() <= resolution_mm_.array()).all()) {
      return {};
    } else if (has_moved || Clock::now() > start + start_time) {
      char text[128];
      std::snprintf(text, sizeof text, "stands at (%.3f, %.3f) mm instead of (%.3f, %.3f) mm", status->position.x(),
                    status->position.y(), target_mm.x(), target_mm.y());
      return fail(text, info_.path, "check for a halt at the controller, then try again");
    }
    std::this_thread::sleep_for(poll_period);
  }
  char text[64];
  std::snprintf(text, sizeof text, "did not arrive within %.1f s", allowed.count());
  return stop_moving({text, info_.path, "check speed overrides and $110, $111, $120, $121"});
}

Status GrblStage::find_switches(std::stop_token stop) {
  const Result<Vec2> closing = find_closing(stop);
  if (!closing) return tl::unexpected(closing.error());
  for (int axis : {0, 1}) {
    const double way = std::abs((*closing)[axis] - home_mm_[axis]);
    const std::string name = std::string("the home switch of axis ") + "xy"[axis];
    if (way < close_look_mm / 2) return fail(name + " is closed where homing ends", info_.path, "raise $27");
    if (way >= reach_mm())
      return fail(name + " is not seen to close by its reports", info_.path,
                  "set \"check_home\" to false in the bench file, or check the switch");
  }
  closing_mm_ = *closing;
  return {};
}

/// Roughly, then closely from a step before, always from where homing ends so that backlash lies on the same side.
Result<Vec2> GrblStage::find_closing(std::stop_token stop) {
  const Result<Vec2> rough = find_closing(home_mm_, look_mm, stop);
  if (!rough) return rough;
  if (Status left = move_to(home_mm_, stop); !left) return tl::unexpected(left.error());
  const Vec2 way = ((*rough - home_mm_).cwiseProduct(to_switch_) - Vec2::Constant(look_mm)).cwiseMax(Vec2::Zero());
  const double step_mm = std::max(close_look_mm, 2 * resolution_mm_.maxCoeff());
  const Result<Vec2> closing = find_closing(home_mm_ + way.cwiseProduct(to_switch_), step_mm, stop);
  if (!closing) return closing;
  if (Status left = move_to(home_mm_, stop); !left) return tl::unexpected(left.error());
  return closing;
}

/// Both axes step by step towards their switches, each until it closes or nothing is left of the reach.
Result<Vec2> GrblStage::find_closing(const Vec2& from_mm, double step_mm, std::stop_token stop) {
  Vec2 at = from_mm;
  bool found[2] = {};
  while (true) {
    if (Status moved = move_to(at, stop); !moved) return tl::unexpected(moved.error());
    const Result<GrblStatus> status = dialogue_->status();
    if (!status) return tl::unexpected(status.error());
    const bool closed[2] = {status->x_closed, status->y_closed};
    for (int axis : {0, 1}) {
      found[axis] = found[axis] || closed[axis] || std::abs(at[axis] - home_mm_[axis]) >= reach_mm();
      if (!found[axis]) at[axis] += to_switch_[axis] * step_mm;
    }
    if (found[0] && found[1]) return at;
  }
}

Result<Vec2> GrblStage::slipped_mm(std::stop_token stop) {
  if (!closing_mm_)
    return fail("where its home switches close is not known", info_.path,
                "home it with \"check_home\" in the bench file");
  const Result<Vec2> closing = find_closing(stop);
  if (!closing) return closing;
  return Vec2(*closing_mm_ - *closing);
}

Status GrblStage::can_check_home() const {
  constexpr std::pair<int, std::string_view> in_the_way[] = {{20, "soft limits, which end before the home switches"},
                                                             {21, "hard limits, which make a closed switch an alarm"}};
  for (const auto& [number, what] : in_the_way)
    if (dialogue_->setting_or(number, 0) != 0)
      return fail("the home switches cannot be looked for: the controller has " + std::string(what), info_.path,
                  "set $" + std::to_string(number) +
                      "=0 (limits_mm still keeps every target inside), or \"check_home\" to false in the bench file");
  return {};
}

Status GrblStage::stop_moving(Error why) {
  if (Status at_rest = dialogue_->stop_and_reset(); !at_rest)
    return fail(why.what + "; and then: " + at_rest.error().what, info_.path, at_rest.error().remedy);
  return tl::unexpected(std::move(why));
}

Result<Vec2> GrblStage::position() {
  const Result<GrblStatus> status = dialogue_->status();
  if (!status) return tl::unexpected(status.error());
  if (status->state == GrblState::alarm) return tl::unexpected(not_moving_error(*status));
  return status->position;
}

}  // namespace

Result<std::unique_ptr<Stage>> open_grbl_stage(const StageSettings& settings) {
  Result<std::unique_ptr<GrblDialogue>> dialogue = GrblDialogue::open(settings.path);
  if (!dialogue) return tl::unexpected(dialogue.error());
  auto stage = std::make_unique<GrblStage>(std::move(*dialogue), settings.check_home);
  if (settings.check_home)
    if (Status possible = stage->can_check_home(); !possible) return tl::unexpected(possible.error());
  if (settings.home) return stage;

  // Homing would clear an alarm; without it the stage has to be ready now.
  if (const Result<GrblStatus> status = stage->ready(); !status) return tl::unexpected(status.error());
  return stage;
}

}  // namespace lumifield
