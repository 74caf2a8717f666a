// Runs a command on a network of its own, where nobody else has a camera's port; on this one where that is not allowed.
//   own_network COMMAND...

#include "tests/support/own_network.h"

#include <cerrno>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  lumifield::enter_own_network();
  execvp(argv[1], argv + 1);
  std::fprintf(stderr, "own_network: %s: %s\n", argv[1], std::strerror(errno));
  return 127;
}
