#pragma once

#include <filesystem>
#include <string>

#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// The device's end of a serial line: a raw pseudo-terminal whose other end a host opens through a symbolic link. Both
/// ends are kept open here, so that hosts come and go. Without flow control: what the host does not take is lost.
/// Thread-bound but for write().
class PseudoTerminal {
 public:
  PseudoTerminal() = default;
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  /// Makes the terminal and the link. Errors: no pseudo-terminals here, `link` exists or its folder cannot be written.
  Status open(const std::filesystem::path& link);

  /// What came, after waiting for at most that long for it; may be empty.
  std::string read(int timeout_ms);
  void write(const std::string& text);

 private:
  std::filesystem::path link_;
  int device_ = -1, host_ = -1;
};

}  // namespace lumifield::virtual_bench
