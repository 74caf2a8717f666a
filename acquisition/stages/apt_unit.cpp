#include "acquisition/stages/apt_unit.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int baud = 115200;
constexpr milliseconds listen_time(5);
constexpr std::size_t unreadable_limit = 256, most_waiting = 64;

milliseconds left_until(Clock::time_point deadline) {
  return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(deadline - Clock::now()));
}

std::string printable(const std::vector<std::uint8_t>& data, std::size_t from) {
  std::string text;
  for (std::size_t k = from; k < data.size() && data[k] != 0; ++k)
    text += data[k] >= ' ' && data[k] < 127 ? static_cast<char>(data[k]) : '?';
  return text;
}

}  // namespace

std::string apt_place(std::uint8_t source) {
  return source >= apt_first_bay && source < apt_unit ? "bay " + std::to_string(source - apt_first_bay + 1) : "";
}

Result<std::unique_ptr<AptUnit>> AptUnit::open(const std::string& serial) {
  Result<std::unique_ptr<FtdiLink>> link = FtdiLink::open(apt_usb_id, serial, baud);
  if (!link) return tl::unexpected(link.error());
  return std::unique_ptr<AptUnit>(new AptUnit(std::move(*link)));
}

Status AptUnit::send(const AptMessage& message) {
  if (const auto sent = link_->write(encode(message)); !sent) return link_error(sent.error());
  return {};
}

void AptUnit::send_now(const AptMessage& message) { static_cast<void>(link_->write(encode(message))); }

Status AptUnit::read(Milliseconds timeout) {
  const LinkResult<std::vector<std::uint8_t>> bytes = link_->read(timeout);
  if (!bytes && bytes.error() == LinkFault::timeout) return {};
  if (!bytes) return link_error(bytes.error());
  reader_.append(*bytes);
  while (std::optional<AptMessage> message = reader_.next()) {
    dropped_before_ = reader_.bytes_dropped();
    if (Status taken = take(std::move(*message)); !taken) return taken;
  }
  if (reader_.bytes_dropped() - dropped_before_ >= unreadable_limit)
    return fail("unreadable answers", serial(), "check that this is a controller that speaks APT, and its cable");
  return {};
}

Status AptUnit::take(AptMessage message) {
  if (message.id == AptId::hw_response || message.id == AptId::hw_rich_response) {
    const std::string note = printable(message.data, 4);
    return fail("the controller reports a fault" + (note.empty() ? "" : ": " + note), serial(),
                "see its display and manual, then switch it off and on and home");
  }
  if (!inbox_.contains(message.source)) return {};  // of whom nothing is asked
  if (parse_apt_status(message)) {
    AptMessage alive{AptId::ack_status};
    alive.destination = message.source;
    if (Status acknowledged = send(alive); !acknowledged) return acknowledged;
  }
  std::deque<AptMessage>& inbox = inbox_[message.source];
  inbox.push_back(std::move(message));
  if (inbox.size() > most_waiting) inbox.pop_front();
  return {};
}

Result<std::optional<AptMessage>> AptUnit::receive(std::uint8_t source, Milliseconds timeout) {
  std::deque<AptMessage>& inbox = inbox_[source];
  const Clock::time_point deadline = Clock::now() + timeout;
  while (inbox.empty()) {
    if (Status came = read(left_until(deadline)); !came) return tl::unexpected(came.error());
    if (inbox.empty() && Clock::now() >= deadline) return std::nullopt;
  }
  AptMessage message = std::move(inbox.front());
  inbox.pop_front();
  return message;
}

Result<std::optional<AptMessage>> AptUnit::await(std::uint8_t source, AptId answer, Milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  do {
    Result<std::optional<AptMessage>> message = receive(source, left_until(deadline));
    if (!message || (*message && (*message)->id == answer)) return message;
  } while (Clock::now() < deadline);
  return std::nullopt;
}

Status AptUnit::settle(std::uint8_t source) {
  if (Status came = read(milliseconds(0)); !came) return came;
  Owed owed = std::exchange(owed_[source], {});
  for (int waits = 0; owed.count > 0 && waits < answer_waits;) {
    const Result<std::optional<AptMessage>> late = await(source, owed.answer, answer_time);
    if (!late) {
      owed_[source] = owed;
      return tl::unexpected(late.error());
    }
    *late ? --owed.count : ++waits;
  }
  inbox_[source].clear();
  return {};
}

Result<AptMessage> AptUnit::ask(const AptMessage& request, AptId answer) {
  if (Status settled = settle(request.destination); !settled) return tl::unexpected(settled.error());
  for (int wait = 0; wait < answer_waits; ++wait) {
    if (Status sent = send(request); !sent) return tl::unexpected(sent.error());
    Result<std::optional<AptMessage>> message = await(request.destination, answer, answer_time);
    if (!message) {
      owes(request.destination, answer, wait + 1);
      return tl::unexpected(message.error());
    }
    if (!*message) continue;
    owes(request.destination, answer, wait);
    return std::move(**message);
  }
  owes(request.destination, answer, answer_waits);
  return silent(request.destination, "2 s");
}

Result<AptHardware> AptUnit::identify() {
  constexpr std::uint8_t places[] = {apt_unit, apt_rack};  // one of which answers
  for (int wait = 0; wait < answer_waits; ++wait) {
    for (const std::uint8_t place : places)
      if (Status sent = send({AptId::hw_req_info, 0, 0, place}); !sent) return tl::unexpected(sent.error());
    for (const Clock::time_point deadline = Clock::now() + answer_time; Clock::now() < deadline;) {
      for (const std::uint8_t place : places) {
        const Result<std::optional<AptMessage>> message = await(place, AptId::hw_get_info, listen_time);
        if (!message) return tl::unexpected(message.error());
        if (const auto hardware = *message ? parse_apt_hardware(**message) : std::nullopt) return *hardware;
      }
    }
  }
  return silent(apt_unit, "2 s");
}

tl::unexpected<Error> AptUnit::silent(std::uint8_t source, const std::string& duration) const {
  const std::string place = apt_place(source);
  return fail(
      "no answer within " + duration + (place.empty() ? "" : " from " + place), serial(),
      std::string("check the controller's power and its cable") + (place.empty() ? "" : ", and that the bay is used"));
}

tl::unexpected<Error> AptUnit::link_error(LinkFault fault) const {
  if (fault == LinkFault::hang_up)
    return fail("the stage is gone: unplugged or switched off", serial(), "plug it in, then home");
  return fail("it takes no bytes", serial(), "check the controller's power and its cable");
}

}  // namespace lumifield
