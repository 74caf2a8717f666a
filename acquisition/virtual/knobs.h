#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "luminaire/error.h"

namespace lumifield::virtual_bench {

/// A thing that a test turns or reads while the bench runs. Both functions are called on the knobs' thread.
struct Knob {
  std::function<Status(double)> set;
  std::function<std::string()> get;  ///< may be absent
};

/// A Unix stream socket that takes lines: `name value` sets a knob and is answered `ok`, `get name` is answered with
/// its value, everything else with `error: …`. Any number of clients; own thread.
class Knobs {
 public:
  /// Errors: the socket cannot be made (path taken, too long, folder missing).
  static Result<std::unique_ptr<Knobs>> start(const std::filesystem::path& socket, std::map<std::string, Knob> knobs);
  ~Knobs();

 private:
  struct Impl;
  explicit Knobs(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
