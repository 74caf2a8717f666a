#include "acquisition/stages/grbl_dialogue.h"

#include <algorithm>
#include <thread>

#include "luminaire/wording.h"

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int baud = 115200;
constexpr milliseconds wake_time(3000);  // a board that restarts on opening runs its boot loader for up to 2 s
constexpr milliseconds wake_period(250);
constexpr milliseconds wake_reset_after(2000);  // in a critical alarm `?` stays unanswered until a reset
/// Silence is believed on the second wait only: one that began before the whole machine was held up would end at once.
constexpr int answer_waits = 2;
constexpr milliseconds reset_time(2000);
constexpr milliseconds stop_time(3000);  // even slow stages brake from full speed in less
constexpr int unreadable_limit = 3;
constexpr int work_offset_period = 40;  // reports; GRBL sends WCO at least every 30th
constexpr double mm_per_inch = 25.4, s_per_min = 60;

constexpr int required_settings[] = {100, 101, 110, 111, 120, 121, 130, 131};

milliseconds left_until(Clock::time_point deadline) {
  return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(deadline - Clock::now()));
}

bool is_moving(const GrblStatus& status) {
  return status.state == GrblState::run || status.state == GrblState::jog ||
         (status.state == GrblState::hold && status.sub_state != 0);
}

bool is_known_chatter(std::string_view line) {
  return line.empty() || line == "ok" || line.front() == '[' || line.front() == '>' || line.starts_with("error:") ||
         parse_grbl_status(line).has_value();
}

}  // namespace

Result<std::unique_ptr<GrblDialogue>> GrblDialogue::open(const std::string& path) {
  Result<std::unique_ptr<SerialLink>> link = SerialLink::open(path, baud);
  if (!link) return tl::unexpected(link.error());
  std::unique_ptr<GrblDialogue> dialogue(new GrblDialogue(std::move(*link)));
  if (Status awake = dialogue->wake(); !awake) return tl::unexpected(awake.error());
  if (Status known = dialogue->read_identity(); !known) return tl::unexpected(known.error());
  return dialogue;
}

Result<GrblFound> GrblDialogue::listen(const std::string& path) {
  Result<std::unique_ptr<SerialLink>> link = SerialLink::open(path, baud);
  if (!link) return tl::unexpected(link.error());
  GrblDialogue dialogue(std::move(*link));
  const Result<std::string> greeting = dialogue.await_greeting(std::nullopt);
  if (!greeting) return tl::unexpected(greeting.error());
  const auto status = parse_grbl_status(*greeting);
  if (status && status->state != GrblState::idle && status->state != GrblState::alarm)
    return GrblFound{"Grbl controller", "busy: not asked what it can"};
  if (Status known = dialogue.read_identity(); !known) return tl::unexpected(known.error());
  const auto slower = [&](int x) { return std::min(dialogue.setting(x), dialogue.setting(x + 1)); };
  return GrblFound{dialogue.firmware(), "travel " + say(dialogue.setting(130)) + " by " + say(dialogue.setting(131)) +
                                            " mm; up to " + say(slower(110) / s_per_min) + " mm/s, " +
                                            say(slower(120)) + " mm/s²"};
}

Status GrblDialogue::wake() {
  const Result<std::string> greeting = await_greeting(wake_reset_after);
  if (!greeting) return tl::unexpected(greeting.error());
  // A former owner may have left it moving.
  const auto status = parse_grbl_status(*greeting);
  return status && is_moving(*status) ? stop_and_reset() : reset();
}

Result<std::string> GrblDialogue::await_greeting(std::optional<milliseconds> reset_after) {
  const Clock::time_point start = Clock::now();
  while (Clock::now() < start + wake_time) {
    send_now(reset_after && Clock::now() >= start + *reset_after ? reset_byte : '?');
    const Clock::time_point next = Clock::now() + wake_period;
    while (left_until(next) > milliseconds(0)) {
      const LinkResult<std::string> line = link_->read_line(left_until(next));
      if (!line && line.error() == LinkFault::hang_up) return link_error(line.error());
      if (!line && line.error() == LinkFault::overlong) unreadable_line_ = "no line end";
      if (!line) continue;
      if (parse_grbl_status(*line) || is_grbl_banner(*line)) return *line;
      if (Status noted = note(*line); !noted && unreadable_lines_ >= unreadable_limit)
        return tl::unexpected(noted.error());
    }
  }
  return silent("3 s");
}

Status GrblDialogue::read_identity() {
  if (Status known = command("$I"); !known) return known;
  if (!firmware_.starts_with("1.1"))
    return fail("its firmware is \"" + printable(firmware_) + "\", not GRBL 1.1", path(), "flash GRBL 1.1");
  firmware_ = "Grbl " + firmware_;
  if (Status known = command("$$"); !known) return known;
  for (const int number : required_settings)
    if (!(setting_or(number, 0) > 0))
      return fail("it does not report a usable setting $" + std::to_string(number), path(), "set it on the controller");
  return {};
}

double GrblDialogue::setting_or(int number, double otherwise) const {
  const auto found = settings_.find(number);
  return found == settings_.end() ? otherwise : found->second;
}

Status GrblDialogue::command(std::string_view line, Milliseconds timeout) {
  if (Status sent = send(line); !sent) return sent;
  for (int wait = 0; wait < answer_waits; ++wait) {
    const Result<bool> done = await_ok(timeout);
    if (!done) return tl::unexpected(done.error());
    if (*done) return {};
  }
  return silent("5 s");
}

Status GrblDialogue::send(std::string_view line) {
  if (Status noted = note_pending(); !noted) return noted;
  if (const auto sent = link_->write(std::string(line) + "\n"); !sent) return link_error(sent.error());
  return {};
}

Result<bool> GrblDialogue::await_ok(Milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  do {
    const Result<std::string> line = read_line(left_until(deadline));
    if (!line) return tl::unexpected(line.error());
    if (*line == "ok") {
      forget_noise();
      return true;
    }
    if (const auto code = parse_grbl_code(*line, "error:")) return tl::unexpected(grbl_error(*code, path()));
    if (Status noted = note(*line); !noted) return tl::unexpected(noted.error());
  } while (Clock::now() < deadline);
  return false;
}

Result<GrblStatus> GrblDialogue::status() {
  if (Status noted = note_pending(); !noted) return tl::unexpected(noted.error());
  if (alarm_) return tl::unexpected(grbl_alarm(*alarm_, path()));
  for (int reports = 0; reports < work_offset_period; ++reports) {
    Result<GrblStatus> status = ask();
    if (!status) return status;
    if (!status->machine_position && !work_offset_) continue;
    if (!status->machine_position) status->position += *work_offset_;
    if (setting_or(13, 0) != 0) status->position *= mm_per_inch;
    status->machine_position = true;
    return status;
  }
  return fail("it reports work positions without their offset (WCO)", path(), "set $10=1 on the controller");
}

Result<GrblStatus> GrblDialogue::ask() {
  for (int wait = 0; wait < answer_waits; ++wait) {
    const Result<std::optional<GrblStatus>> status = ask_once();
    if (!status) return tl::unexpected(status.error());
    if (*status) return **status;
  }
  return silent("5 s");
}

Result<std::optional<GrblStatus>> GrblDialogue::ask_once() {
  if (const auto sent = link_->write("?"); !sent) return link_error(sent.error());
  const Clock::time_point deadline = Clock::now() + answer_time;
  do {
    const Result<std::string> line = read_line(left_until(deadline));
    if (!line) return tl::unexpected(line.error());
    if (const auto status = parse_grbl_status(*line)) {
      forget_noise();
      if (status->work_offset) work_offset_ = status->work_offset;
      return *status;
    }
    if (Status noted = note(*line); !noted) return tl::unexpected(noted.error());
  } while (Clock::now() < deadline);
  return std::nullopt;
}

Status GrblDialogue::stop_and_reset() {
  send_now(hold);
  const Clock::time_point deadline = Clock::now() + stop_time;
  while (Clock::now() < deadline) {
    const Result<GrblStatus> status = ask();
    if (!status) return tl::unexpected(status.error());
    if (!is_moving(*status)) return reset();
    std::this_thread::sleep_for(milliseconds(5));
  }
  return fail("it does not stop on a feed hold", path(), "switch the stage off");
}

Status GrblDialogue::reset() {
  link_->discard_input();
  send_now(reset_byte);
  const Clock::time_point deadline = Clock::now() + reset_time;
  do {
    const Result<std::string> line = read_line(left_until(deadline));
    if (!line) return tl::unexpected(line.error());
    if (!is_grbl_banner(*line)) continue;
    alarm_.reset();
    work_offset_.reset();
    forget_noise();
    return {};
  } while (Clock::now() < deadline);
  return silent("2 s");
}

void GrblDialogue::send_now(char character) {
  // The next read tells the owner of a link that is gone; here is nobody to tell.
  static_cast<void>(link_->write({&character, 1}));
}

void GrblDialogue::forget_noise() {
  unreadable_lines_ = 0;
  unreadable_line_.clear();
}

Status GrblDialogue::note(const std::string& line) {
  if (const auto code = parse_grbl_code(line, "ALARM:")) {
    alarm_ = code;
    return tl::unexpected(grbl_alarm(*code, path()));
  }
  if (is_grbl_banner(line))
    return fail("the controller restarted; its position is lost", path(), "check its supply, then home");
  if (line.starts_with("[VER:")) firmware_ = line.substr(5, line.find(':', 5) - 5);
  if (const auto setting = parse_grbl_setting(line)) {
    settings_.insert_or_assign(setting->first, setting->second);
  } else if (!is_known_chatter(line)) {
    unreadable_line_ = line;
    if (++unreadable_lines_ >= unreadable_limit) return unreadable();
  }
  return {};
}

Status GrblDialogue::note_pending() {
  while (true) {
    const LinkResult<std::string> line = link_->read_line(milliseconds(0));
    if (!line && line.error() == LinkFault::timeout) return {};
    if (!line) return link_error(line.error());
    if (Status noted = note(*line); !noted) return noted;
  }
}

Result<std::string> GrblDialogue::read_line(Milliseconds timeout) {
  LinkResult<std::string> line = link_->read_line(timeout);
  if (line) return std::move(*line);
  if (line.error() == LinkFault::timeout) return std::string();
  return link_error(line.error());
}

tl::unexpected<Error> GrblDialogue::silent(std::string_view duration) const {
  if (!unreadable_line_.empty()) return unreadable();
  return fail("no answer within " + std::string(duration), path(), "check power and cable, and that it is the stage");
}

tl::unexpected<Error> GrblDialogue::unreadable() const {
  return fail("unreadable answers (\"" + printable(unreadable_line_) + "\")", path(),
              "check that this is a GRBL stage at 115200 baud, and its cable");
}

tl::unexpected<Error> GrblDialogue::link_error(LinkFault fault) const {
  switch (fault) {
    case LinkFault::hang_up:
      return fail("the stage was unplugged or switched off", path(), "plug it in, then home");
    case LinkFault::timeout:
      return fail("it takes no bytes", path(), "check power and cable");
    case LinkFault::overlong:
      break;
  }
  return fail("unreadable answers (no line end)", path(), "check that this is a GRBL stage at 115200 baud");
}

}  // namespace lumifield
