#include "acquisition/stages/apt_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace lumifield {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds listen_time(5), status_period(50);
constexpr milliseconds rest_time(500);  // a motion has started by then, or ended
constexpr double arrival_mm = 0.05;     // a servo has settled to within less
constexpr double rounding = 1e-3;       // relative, of speeds read back; half a word more
constexpr std::uint8_t enable = 1, profiled = 2;

std::string mm(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f mm", value);
  return text;
}

Result<std::int32_t> to_word(double value, const std::string& where) {
  const double rounded = std::round(value);
  if (rounded >= 1 && rounded <= std::numeric_limits<std::int32_t>::max()) return static_cast<std::int32_t>(rounded);
  return fail("a speed or acceleration cannot be said to the controller", where,
              "correct rapid_mm_s, acceleration_mm_s2 and counts_per_mm");
}

}  // namespace

AptMessage AptAxis::message(AptId id, std::uint8_t param1, std::uint8_t param2) const {
  return {id, param1, param2, setup_.address, apt_host, {}};
}

AptMessage AptAxis::message(AptId id, std::vector<std::uint8_t> data) const {
  return {id, 0, 0, setup_.address, apt_host, std::move(data)};
}

tl::unexpected<Error> AptAxis::trouble(const std::string& what, const std::string& remedy) const {
  return fail("axis " + setup_.name + " " + what, unit_.serial(), remedy);
}

Result<AptStatus> AptAxis::status() {
  const Result<AptMessage> told = unit_.ask(status_question(), status_answer());
  if (!told) return tl::unexpected(told.error());
  const std::optional<AptStatus> status = parse_apt_status(*told);
  if (!status) return trouble("sends a short status message", "check the controller's firmware");
  return *status;
}

Status AptAxis::prepare(double speed_mm_s, double acceleration_mm_s2) {
  for (const AptMessage& order : {message(AptId::hw_stop_updates, 0), message(AptId::resume_end_of_move),
                                  message(AptId::set_channel_enabled, 1, enable)})
    if (Status sent = unit_.send(order); !sent) return sent;
  const auto ask = [this]() -> Result<AptVelocity> {
    const Result<AptMessage> told = unit_.ask(message(AptId::req_velocity), AptId::get_velocity);
    if (!told) return tl::unexpected(told.error());
    const std::optional<AptVelocity> velocity = parse_apt_velocity(*told);
    if (!velocity || velocity->most <= 0 || velocity->acceleration <= 0)
      return trouble("reports no usable velocity", "set rapid_mm_s and acceleration_mm_s2 in the bench file");
    return *velocity;
  };
  const double per_mm_s = setup_.scale.velocity * setup_.counts_per_mm;
  const double per_mm_s2 = setup_.scale.acceleration * setup_.counts_per_mm;
  Result<AptVelocity> velocity = ask();
  if (!velocity) return tl::unexpected(velocity.error());
  AptVelocity wanted = *velocity;
  for (const auto& [value, factor, word] :
       {std::tuple{speed_mm_s, per_mm_s, &wanted.most}, {acceleration_mm_s2, per_mm_s2, &wanted.acceleration}}) {
    if (value == 0) continue;
    const Result<std::int32_t> number = to_word(value * factor, unit_.serial());
    if (!number) return tl::unexpected(number.error());
    *word = *number;
  }
  if (Status sent = unit_.send(message(AptId::set_velocity, apt_velocity_data(wanted))); !sent) return sent;
  velocity = ask();
  if (!velocity) return tl::unexpected(velocity.error());
  speed_mm_s_ = velocity->most / per_mm_s;
  acceleration_mm_s2_ = velocity->acceleration / per_mm_s2;
  const auto other = [](double took, double asked) { return std::abs(took - asked) > rounding * asked + 1; };
  if (other(velocity->most, wanted.most) || other(velocity->acceleration, wanted.acceleration)) {
    char text[128];
    std::snprintf(text, sizeof text, "took %.4g mm/s and %.4g mm/s² instead of %.4g and %.4g", speed_mm_s_,
                  acceleration_mm_s2_, wanted.most / per_mm_s, wanted.acceleration / per_mm_s2);
    return trouble(text, "ask for less by rapid_mm_s and acceleration_mm_s2");
  }
  return {};
}

Result<double> AptAxis::ready() {
  const Result<AptStatus> now = status();
  if (!now) return tl::unexpected(now.error());
  if (now->motion_error()) return stopped_short(*now);
  if (!now->homed()) return trouble("is not homed; its position is unknown", "home the stage");
  if (!now->enabled()) return trouble("is disabled", "enable it on the controller, then home");
  return to_mm(now->position);
}

Result<double> AptAxis::position() {
  const Result<AptStatus> now = status();
  if (!now) return tl::unexpected(now.error());
  return to_mm(now->position);
}

Status AptAxis::begin(const AptMessage& order, AptId ends_with, double target_mm) {
  ends_with_ = ends_with, target_mm_ = target_mm;
  ended_ = false, unanswered_ = 0;
  if (Status settled = unit_.settle(setup_.address); !settled) return settled;
  moved_ = asked_ = Clock::now();
  return unit_.send(order);
}

Result<AptAxis::Seconds> AptAxis::start_home() {
  if (Status enabled = unit_.send(message(AptId::set_channel_enabled, 1, enable)); !enabled)
    return tl::unexpected(enabled.error());
  const Result<AptMessage> told = unit_.ask(message(AptId::req_home_params), AptId::get_home_params);
  if (!told) return tl::unexpected(told.error());
  const double speed_mm_s = parse_apt_home_velocity(*told).value_or(0) / (setup_.scale.velocity * setup_.counts_per_mm);
  if (!(speed_mm_s > 0)) return trouble("reports no homing velocity", "set it on the controller");
  if (Status begun = begin(message(AptId::move_home), AptId::homed, 0); !begun) return tl::unexpected(begun.error());
  return Seconds(2 * 1.5 * setup_.travel_mm / speed_mm_s + 10);
}

Result<AptAxis::Seconds> AptAxis::start_move(double target_mm) {
  const Result<double> from = ready();
  if (!from) return tl::unexpected(from.error());
  const double counts = std::round(setup_.direction * target_mm * setup_.counts_per_mm);
  if (std::abs(counts) > std::numeric_limits<std::int32_t>::max())
    return trouble("cannot count to " + mm(target_mm), "correct counts_per_mm or travel_mm");
  const AptMessage order = message(AptId::move_absolute, apt_position_data(static_cast<std::int32_t>(counts)));
  if (Status begun = begin(order, AptId::move_completed, target_mm); !begun) return tl::unexpected(begun.error());
  const double way = std::abs(target_mm - *from), v = speed_mm_s_, a = acceleration_mm_s2_;
  return Seconds(way >= v * v / a ? way / v + v / a : 2 * std::sqrt(way / a));
}

Status AptAxis::ask_again() {
  const Clock::time_point now = Clock::now();
  if (now < asked_ + (unanswered_ == 0 ? status_period : AptUnit::answer_time)) return {};
  if (unanswered_ == AptUnit::answer_waits) return unit_.silent(setup_.address, "2 s");
  ++unanswered_;
  asked_ = now;
  if (Status asked = unit_.send(status_question()); !asked) return asked;
  unit_.owes(setup_.address, status_answer(), 1);
  return {};
}

Result<bool> AptAxis::watch() {
  if (ended_) return true;
  const Result<std::optional<AptMessage>> came = unit_.receive(setup_.address, listen_time);
  if (!came) return tl::unexpected(came.error());
  if (*came && (*came)->id == status_answer()) {
    unanswered_ = 0;
    unit_.owes(setup_.address, status_answer(), -1);
  }
  const Result<bool> well = *came ? judge(**came) : false;
  if (!well) return well;
  ended_ = *well;
  if (ended_) return true;
  if (Status asked = ask_again(); !asked) return tl::unexpected(asked.error());
  return false;
}

/// A motion has ended by its message, or when the axis stands for a while where it was sent.
Result<bool> AptAxis::judge(const AptMessage& message) {
  const bool is_homing = ends_with_ == AptId::homed;
  if (is_homing && message.id == AptId::homed) return true;
  const std::optional<AptStatus> status = parse_apt_status(message);
  if (!status) return false;
  if (status->moving()) moved_ = Clock::now();
  if (status->motion_error() || message.id == AptId::move_stopped) return stopped_short(*status);
  if (message.id != ends_with_ && Clock::now() < moved_ + rest_time) return false;
  if (is_homing && status->homed()) return false;  // from before, or the message is on its way
  if (!is_homing && std::abs(to_mm(status->position) - target_mm_) <= arrival_mm) return true;
  return stopped_short(*status);
}

tl::unexpected<Error> AptAxis::stopped_short(const AptStatus& status) const {
  if (status.motion_error())
    return trouble(std::string("has a motion error: its carriage does not follow") +
                       (status.over_current() ? ", at the limit of the motor's current" : ""),
                   "free its way and check its cable, then home");
  if (status.at_limit())
    return trouble("was stopped by a limit switch at " + mm(to_mm(status.position)),
                   "check limits_mm and travel_mm in the bench file, then home");
  if (ends_with_ == AptId::homed)
    return trouble("stopped homing before it was homed", "check for a halt at the controller and its switches");
  return trouble("stands at " + mm(to_mm(status.position)) + " instead of " + mm(target_mm_),
                 "check for a halt at the controller, then try again");
}

Result<bool> AptAxis::stands() {
  const Result<AptStatus> now = status();
  if (!now) return tl::unexpected(now.error());
  return !now->moving();
}

void AptAxis::stop_now() { unit_.send_now(message(AptId::move_stop, 1, profiled)); }

}  // namespace lumifield
