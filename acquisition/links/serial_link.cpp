#include "acquisition/links/serial_link.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_line = 1024;
constexpr unsigned first_pty_major = 136, last_pty_major = 143;  // Linux, Unix98 slaves

std::optional<speed_t> to_speed(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    default:
      return std::nullopt;
  }
}

tl::unexpected<Error> open_failure(const std::string& path, int error) {
  switch (error) {
    case ENOENT:
      return fail("there is no such device", path, "plug the device in, or correct the path");
    case EACCES:
      return fail("no permission to open it", path, "add the user to the group dialout, then log in again");
    case EBUSY:
      return fail("in use by another program", path, "close the other program");
    case ENXIO:
    case ENODEV:
    case EIO:
      return fail("no device behind this path", path, "check cable and power, or correct the path");
    case EISDIR:
      return fail("not a serial line", path, "give the path of the serial device");
    default:
      return fail(std::strerror(error), path, "check the device and its path");
  }
}

bool is_pseudo_terminal(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || !S_ISCHR(status.st_mode)) return false;
  const unsigned number = major(status.st_rdev);
  return number >= first_pty_major && number <= last_pty_major;
}

bool set_raw(int descriptor, speed_t speed) {
  termios line{};
  if (tcgetattr(descriptor, &line) != 0) return false;
  cfmakeraw(&line);
  line.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | PARENB | CRTSCTS | HUPCL);
  line.c_cflag |= CS8 | CREAD | CLOCAL;
  line.c_cc[VMIN] = 1;  // with O_NONBLOCK: nothing to read is EAGAIN, so that 0 bytes mean a hang-up
  line.c_cc[VTIME] = 0;
  if (cfsetispeed(&line, speed) != 0 || cfsetospeed(&line, speed) != 0) return false;
  if (tcsetattr(descriptor, TCSANOW, &line) != 0) return false;

  // tcsetattr succeeds when any one of the changes was made.
  termios taken{};
  return tcgetattr(descriptor, &taken) == 0 && cfgetospeed(&taken) == speed && (taken.c_lflag & (ICANON | ECHO)) == 0 &&
         (taken.c_cflag & CSIZE) == CS8;
}

}  // namespace

Result<std::unique_ptr<SerialLink>> SerialLink::open(const std::string& path, int baud) {
  const std::optional<speed_t> speed = to_speed(baud);
  if (!speed) return fail("a speed of " + std::to_string(baud) + " baud is not known", path, "use 115200");
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) return open_failure(path, errno);
  std::unique_ptr<SerialLink> link(new SerialLink(descriptor, path));

  if (isatty(descriptor) == 0) return fail("not a serial line", path, "give the path of the serial device");
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) return open_failure(path, errno == EWOULDBLOCK ? EBUSY : errno);
  if (!is_pseudo_terminal(descriptor) && ioctl(descriptor, TIOCEXCL) != 0) return open_failure(path, errno);
  if (!set_raw(descriptor, *speed))
    return fail("does not take " + std::to_string(baud) + " baud, raw, 8N1", path, "use another port");
  tcflush(descriptor, TCIOFLUSH);
  return link;
}

SerialLink::~SerialLink() { ::close(descriptor_); }

LinkResult<bool> SerialLink::wait(short events, Clock::time_point deadline) const {
  while (true) {
    const auto left = std::chrono::ceil<Milliseconds>(deadline - Clock::now());
    pollfd line{descriptor_, events, 0};
    const int ready = poll(&line, 1, static_cast<int>(std::clamp<long>(left.count(), 0, 1 << 30)));
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return false;
    // What the far side sent before it left is still to be read.
    if (ready > 0 && (line.revents & events) != 0) return true;
    return tl::unexpected(LinkFault::hang_up);
  }
}

LinkResult<void> SerialLink::write(std::string_view bytes, Milliseconds timeout) {
  const std::scoped_lock alone(writing_);
  const Clock::time_point deadline = Clock::now() + timeout;
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (count < 0 && errno != EAGAIN && errno != EINTR) {
      return tl::unexpected(LinkFault::hang_up);
    } else {
      const LinkResult<bool> ready = wait(POLLOUT, deadline);
      if (!ready) return tl::unexpected(ready.error());
      if (!*ready) return tl::unexpected(LinkFault::timeout);
    }
  }
  return {};
}

LinkResult<std::string> SerialLink::read_line(Milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  while (true) {
    if (const std::size_t end = input_.find('\n'); end != std::string::npos) {
      std::string line = input_.substr(0, end > 0 && input_[end - 1] == '\r' ? end - 1 : end);
      input_.erase(0, end + 1);
      return line;
    }
    if (input_.size() > longest_line) {
      input_.clear();
      return tl::unexpected(LinkFault::overlong);
    }
    const LinkResult<bool> ready = wait(POLLIN, deadline);
    if (!ready) return tl::unexpected(ready.error());
    if (!*ready) return tl::unexpected(LinkFault::timeout);
    std::array<char, 512> bytes;
    const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
    if (count > 0)
      input_.append(bytes.data(), static_cast<std::size_t>(count));
    else if (count == 0 || (errno != EAGAIN && errno != EINTR))
      return tl::unexpected(LinkFault::hang_up);
  }
}

void SerialLink::discard_input() {
  tcflush(descriptor_, TCIFLUSH);
  input_.clear();
}

}  // namespace lumifield
