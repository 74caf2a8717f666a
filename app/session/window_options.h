#pragma once

#include <string>

namespace lumifield {

/// What the command line asks of the window; empty: not said.
struct WindowOptions {
  std::string luminaire;         ///< dataset folder to open
  std::string bench, plan, out;  ///< files and dataset folder of a scan
  std::string scene;             ///< scene file
  bool start = false;            ///< the scan begins by itself
};

}  // namespace lumifield
