#pragma once

#include <cstring>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace lumifield {

/// Gives the calling thread, and those it starts from now on, a network of their own with nothing but 127.0.0.1, so
/// that a camera server meets no other. Where that is not allowed false comes back and everything stays as it is: then
/// the tests' resource lock keeps them apart. Call it before other threads run.
inline bool enter_own_network() {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  const int any_socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq loopback{};
  std::strcpy(loopback.ifr_name, "lo");
  loopback.ifr_flags = IFF_UP | IFF_RUNNING;
  const bool is_up = ioctl(any_socket, SIOCSIFFLAGS, &loopback) == 0;
  close(any_socket);
  return is_up;
}

}  // namespace lumifield
