#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <string>
#include <string_view>
#include <termios.h>
#include <unistd.h>

namespace lumifield {

/// Both ends of a pseudo-terminal, the far one for the test. The near end is held open too, as a real line stays there
/// between two owners. Thread-bound.
class Pty {
 public:
  Pty() : far_(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (far_ < 0 || grantpt(far_) != 0 || unlockpt(far_) != 0) ADD_FAILURE() << "no pseudo-terminal";
    path_ = ptsname(far_);
    near_ = ::open(path_.c_str(), O_RDWR | O_NOCTTY);
    termios line{};
    tcgetattr(near_, &line);
    cfmakeraw(&line);
    tcsetattr(near_, TCSANOW, &line);
  }
  ~Pty() { unplug(); }
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  const std::string& path() const { return path_; }

  void send(std::string_view bytes) const {
    EXPECT_EQ(::write(far_, bytes.data(), bytes.size()), ssize_t(bytes.size()));
  }

  /// What the near side has written, waiting `timeout_ms` for the first byte.
  std::string receive(int timeout_ms) const {
    pollfd line{far_, POLLIN, 0};
    if (poll(&line, 1, timeout_ms) <= 0) return {};
    char bytes[4096];
    const ssize_t count = ::read(far_, bytes, sizeof bytes);
    return {bytes, count > 0 ? std::size_t(count) : 0};
  }

  void unplug() {
    if (near_ >= 0) ::close(near_);
    if (far_ >= 0) ::close(far_);
    near_ = far_ = -1;
  }

 private:
  int far_, near_ = -1;
  std::string path_;
};

}  // namespace lumifield
