#pragma once

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "acquisition/links/ftdi_link.h"
#include "acquisition/stages/apt_messages.h"
#include "luminaire/error.h"

namespace lumifield {

inline constexpr UsbId apt_usb_id{0x0403, 0xfaf0};

/// Question and answer with one Thorlabs controller on USB, whose bays, if it has such, share the line: what comes from
/// each is kept for the one who asks for it. Every status message is acknowledged, which keeps the controller telling.
///
/// Errors of every call: gone (unplugged, switched off); takes no bytes; unreadable answers; a fault that the
/// controller tells. Thread-bound, but send_now().
class AptUnit {
 public:
  using Milliseconds = std::chrono::milliseconds;
  /// Silence is believed on the second wait only: one that began before the whole machine was held up would end at
  /// once.
  static constexpr Milliseconds answer_time{1000};
  static constexpr int answer_waits = 2;

  /// Neither stops what moves nor resets anything but the USB chip. Errors: as FtdiLink::open.
  static Result<std::unique_ptr<AptUnit>> open(const std::string& serial);

  const std::string& serial() const { return link_->serial(); }

  Status send(const AptMessage& message);
  /// Without a word of failure, which the next call of another function tells. Thread-safe.
  void send_now(const AptMessage& message);

  /// The next message of this source; none when none came in time.
  Result<std::optional<AptMessage>> receive(std::uint8_t source, Milliseconds timeout);
  /// So many more of these answers are still to come (−1: one came).
  void owes(std::uint8_t source, AptId answer, int more) {
    owed_[source] = {answer, std::max(owed_[source].count + more, 0)};
  }
  /// Waits for the answers owed, until twice 1 s were silent, then they are lost; forgets what came from this source.
  /// Messages have no number: a late answer would pass for that to a later question.
  Status settle(std::uint8_t source);

  /// Settles, sends a request and waits for its answer, twice 1 s at most; other messages of that source are forgotten.
  Result<AptMessage> ask(const AptMessage& request, AptId answer);

  tl::unexpected<Error> silent(std::uint8_t source, const std::string& duration) const;
  /// Model, serial and firmware as the controller names itself.
  Result<AptHardware> identify();

 private:
  explicit AptUnit(std::unique_ptr<FtdiLink> link) : link_(std::move(link)) {}
  Result<std::optional<AptMessage>> await(std::uint8_t source, AptId answer, Milliseconds timeout);
  Status take(AptMessage message);
  Status read(Milliseconds timeout);
  tl::unexpected<Error> link_error(LinkFault fault) const;

  std::unique_ptr<FtdiLink> link_;
  AptReader reader_;
  std::map<std::uint8_t, std::deque<AptMessage>> inbox_;  ///< by source
  struct Owed {
    AptId answer;
    int count = 0;
  };
  std::map<std::uint8_t, Owed> owed_;  ///< by source
  std::size_t dropped_before_ = 0;     ///< bytes that were unreadable up to the last message
};

/// "bay 1" of a source, "" of a unit.
std::string apt_place(std::uint8_t source);

}  // namespace lumifield
