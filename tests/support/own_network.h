#pragma once

#include <arpa/inet.h>
#include <cstdio>
#include <cstring>
#include <net/if.h>
#include <netinet/in.h>
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

/// Gives that network another address, such as 127.0.0.2, so that a second server can have a port of its own.
inline bool add_own_address(const char* address) {
  ifreq alias{};
  std::snprintf(alias.ifr_name, sizeof alias.ifr_name, "lo:%s", std::strrchr(address, '.') + 1);
  sockaddr_in name{};
  name.sin_family = AF_INET;
  inet_pton(AF_INET, address, &name.sin_addr);
  std::memcpy(&alias.ifr_addr, &name, sizeof name);
  const int any_socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_added = ioctl(any_socket, SIOCSIFADDR, &alias) == 0;
  close(any_socket);
  return is_added;
}

}  // namespace lumifield
