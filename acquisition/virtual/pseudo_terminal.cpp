#include "acquisition/virtual/pseudo_terminal.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

namespace lumifield::virtual_bench {

PseudoTerminal::~PseudoTerminal() {
  if (!link_.empty()) unlink(link_.c_str());
  if (device_ >= 0) close(device_);
  if (host_ >= 0) close(host_);
}

Status PseudoTerminal::open(const std::filesystem::path& link) {
  char name[64];
  if (openpty(&device_, &host_, nullptr, nullptr, nullptr) != 0 || ttyname_r(host_, name, sizeof name) != 0)
    return fail(std::string("no pseudo-terminal: ") + std::strerror(errno), link.string(), "mount /dev/pts");
  termios raw{};
  tcgetattr(host_, &raw);
  cfmakeraw(&raw);
  tcsetattr(host_, TCSANOW, &raw);
  fcntl(device_, F_SETFL, O_NONBLOCK);
  for (const int end : {device_, host_}) fcntl(end, F_SETFD, FD_CLOEXEC);
  if (symlink(name, link.c_str()) != 0)
    return fail(std::string("the link to the terminal cannot be made: ") + std::strerror(errno), link.string(),
                "give another --serial-path, or remove what is there");
  link_ = link;
  return {};
}

std::string PseudoTerminal::read(int timeout_ms) {
  pollfd ready{device_, POLLIN, 0};
  char bytes[256];
  if (poll(&ready, 1, timeout_ms) <= 0) return {};
  const ssize_t count = ::read(device_, bytes, sizeof bytes);
  return count > 0 ? std::string(bytes, std::size_t(count)) : std::string();
}

void PseudoTerminal::write(const std::string& text) {
  [[maybe_unused]] const ssize_t taken = ::write(device_, text.data(), text.size());
}

}  // namespace lumifield::virtual_bench
