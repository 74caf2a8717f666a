#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "acquisition/links/link_fault.h"
#include "luminaire/error.h"

namespace lumifield {

/// A serial line carrying text: opened by path, owned alone, raw, 8 data bits, no parity, one stop bit, no flow
/// control.
///
/// Alone means flock on any line, and TIOCEXCL on real ones: on a pseudo-terminal that flag would outlive a killed
/// owner for as long as the other end is open. Modem lines are neither needed nor touched, so that lines without them
/// work. After a hang-up every call answers hang_up; open the path again.
///
/// Thread-bound, but write(), which is thread-safe.
class SerialLink {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// Errors: path missing, no permission, in use by another program, not a serial line, speed refused.
  static Result<std::unique_ptr<SerialLink>> open(const std::string& path, int baud);

  ~SerialLink();
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  const std::string& path() const { return path_; }

  /// Writes all bytes, never interleaved with those of another thread.
  LinkResult<void> write(std::string_view bytes, Milliseconds timeout = Milliseconds(1000));

  /// The next line without its end (LF, or CR LF). What came of an unfinished line is kept for the next call.
  LinkResult<std::string> read_line(Milliseconds timeout);

  /// Drops what has come so far.
  void discard_input();

 private:
  SerialLink(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}

  /// Waits until the line is ready for `events`, then returns true; false at the deadline.
  LinkResult<bool> wait(short events, std::chrono::steady_clock::time_point deadline) const;

  int descriptor_;
  std::string path_;
  std::string input_;
  std::mutex writing_;
};

}  // namespace lumifield
