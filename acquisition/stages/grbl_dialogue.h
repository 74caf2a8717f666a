#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/links/serial_link.h"
#include "acquisition/stages/grbl_report.h"

namespace lumifield {

/// A controller that was only asked. Value type.
struct GrblFound {
  std::string name;
  std::string capabilities;  ///< its travel and speed, in words; that it was not asked, where it is busy
};

/// Question and answer with a GRBL 1.1 controller: commands that end in `ok`, `?` reports, resets; and whatever the
/// controller says unasked in between: alarms, a banner that tells of a restart, noise. Every fault comes out as an
/// Error at the next call. Thread-bound, but send_now().
class GrblDialogue {
 public:
  using Milliseconds = std::chrono::milliseconds;
  /// Waited for twice. Controllers answer within milliseconds; on a busy machine the kernel hands the bytes on up to
  /// 0.6 s late.
  static constexpr Milliseconds answer_time{2500};

  static constexpr char hold = '!', reset_byte = 0x18;

  /// Opens the port and waits until the controller answers, 3 s at most; stops what still moves, resets, reads firmware
  /// and settings. Errors: as SerialLink::open; silent; unreadable; not GRBL 1.1; a setting missing.
  static Result<std::unique_ptr<GrblDialogue>> open(const std::string& path);

  /// Opens the port and asks `?` until a GRBL controller shows itself, 3 s at most, then, if it stands idle or locked,
  /// firmware and settings, so that it goes on with what it does; boards that restart when the port is opened still do.
  /// Errors: as open(), and a controller in a critical alarm, which answers nothing but a reset, counts as silent.
  static Result<GrblFound> listen(const std::string& path);

  const std::string& path() const { return link_->path(); }
  const std::string& firmware() const { return firmware_; }
  /// `$number` as read on opening; it is there for every number in `required_settings`.
  double setting(int number) const { return settings_.at(number); }
  double setting_or(int number, double otherwise) const;

  /// Sends a line and waits for its `ok`.
  Status command(std::string_view line, Milliseconds timeout = answer_time);

  /// The two halves of command(), for those that take long. await_ok: true = `ok` has come, false = not yet.
  Status send(std::string_view line);
  Result<bool> await_ok(Milliseconds timeout);

  /// A fresh report, the position as machine position in mm. Errors: an alarm since the last reset; no answer in 5 s.
  Result<GrblStatus> status();

  /// Stops without losing the position, then resets: feed hold, stand-still, reset.
  Status stop_and_reset();

  /// Resets and waits for the banner. While it moves, this loses the position.
  Status reset();

  /// A real-time character. Thread-safe. A link that is gone is reported by the next call of another function.
  void send_now(char character);

 private:
  explicit GrblDialogue(std::unique_ptr<SerialLink> link) : link_(std::move(link)) {}

  Status wake();
  /// Asks `?`, after `reset_after`, if given, resets instead; the first report or banner that comes.
  Result<std::string> await_greeting(std::optional<Milliseconds> reset_after);
  Status read_identity();
  /// Takes note of a line that answers nothing.
  Status note(const std::string& line);
  Status note_pending();
  void forget_noise();
  Result<std::string> read_line(Milliseconds timeout);  ///< an empty line at the deadline
  Result<GrblStatus> ask();
  /// Empty when no answer came in time.
  Result<std::optional<GrblStatus>> ask_once();
  tl::unexpected<Error> silent(std::string_view duration) const;
  tl::unexpected<Error> unreadable() const;
  tl::unexpected<Error> link_error(LinkFault fault) const;

  std::unique_ptr<SerialLink> link_;
  std::string firmware_;
  GrblSettings settings_;
  std::optional<int> alarm_;         ///< since the last reset
  std::optional<Vec2> work_offset_;  ///< in the report unit; unknown after a reset
  int unreadable_lines_ = 0;         ///< since the last answer
  std::string unreadable_line_;      ///< the last of them
};

}  // namespace lumifield
