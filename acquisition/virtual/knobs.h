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
  std::string values;                 ///< for people: "0|1"
  std::function<Status(double)> set;  ///< either may be absent
  std::function<std::string()> get;
};
using KnobPanel = std::map<std::string, Knob>;

/// Does what a line says, and returns the answer: `name value` sets a knob and is answered `ok`, `get name` is answered
/// with its value, everything else with `error: …`.
std::string turn(const KnobPanel& knobs, const std::string& line);

/// Says a line to the knobs of a bench that runs, and returns the answer. Errors: nobody listens at that socket.
Result<std::string> say_to_knobs(const std::filesystem::path& socket, const std::string& line);

/// A Unix stream socket that takes such lines. Any number of clients; own thread.
class Knobs {
 public:
  /// Errors: the socket cannot be made (path taken, too long, folder missing).
  static Result<std::unique_ptr<Knobs>> start(const std::filesystem::path& socket, KnobPanel knobs);
  ~Knobs();

 private:
  struct Impl;
  explicit Knobs(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield::virtual_bench
