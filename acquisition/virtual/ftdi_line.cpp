#include "acquisition/virtual/ftdi_line.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include "acquisition/virtual/usb_device.h"

namespace lumifield::virtual_bench {

namespace {

constexpr std::uint8_t vendor_out = 0x40, vendor_in = 0xc0;
constexpr std::uint8_t reset = 0, get_modem_status = 5, set_latency = 9, get_latency = 10;
constexpr int purge_received = 1, purge_to_send = 2;

}  // namespace

int answer_control(FtdiLine& line, std::uint8_t* setup) {
  const std::uint8_t type = setup[0], request = setup[1];
  const int value = setup[2] | setup[3] << 8, length = setup[6] | setup[7] << 8;
  std::uint8_t* const answer = setup + 8;
  if (asks_for_usb_string(setup))
    return tell_usb_string(std::array{std::string("Thorlabs"), line.product, line.serial}, setup);
  if (type == vendor_out) {
    if (request == set_latency) line.latency_ms = value & 0xff;
    if (request == reset && value == purge_received) line.received.clear();
    if (request == reset && value == purge_to_send) line.to_send.clear();
    return length;
  }
  if (type != vendor_in) return -EPIPE;
  std::fill_n(answer, length, std::uint8_t{0xff});  // an empty memory
  if (request == get_latency) *answer = static_cast<std::uint8_t>(line.latency_ms);
  if (request == get_modem_status) std::copy_n(ftdi_status, 2, answer);
  return request == get_latency ? 1 : request == get_modem_status ? 2 : length;
}

}  // namespace lumifield::virtual_bench
