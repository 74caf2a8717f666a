#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lumifield::virtual_bench {

/// Begins each packet to the host: modem and line status, nothing amiss.
inline constexpr std::uint8_t ftdi_status[2] = {0x01, 0x60};

/// What a virtual FT232's control requests ask for and act on. Thread-bound.
struct FtdiLine {
  std::string product, serial;
  std::vector<std::uint8_t> received, to_send;  ///< by the device behind the chip
  int latency_ms = 16;                          ///< after which a packet goes to the host that is not full
};

/// Answers a control request: its setup packet, and room for the answer behind it. The answer's length, or an errno
/// less than 0. Sources: USB 2.0 chapter 9 (strings); libftdi1 (vendor requests).
int answer_control(FtdiLine& line, std::uint8_t* setup);

}  // namespace lumifield::virtual_bench
