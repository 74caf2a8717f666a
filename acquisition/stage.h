#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "acquisition/camera.h"
#include "luminaire/bench.h"
#include "luminaire/error.h"

namespace lumifield {

struct StageInfo {
  std::string firmware;  ///< as the controller names itself
  std::string path;
  double rapid_mm_s = 0, acceleration_mm_s2 = 0;  ///< of the slower axis, as the controller reports them
  Vec2 travel_mm{0, 0};                           ///< as the controller reports it
};

/// The role of a two-axis stage. Positions are stage readings q in mm. Thread-bound to the bench thread but for halt().
class Stage {
 public:
  virtual ~Stage() = default;

  virtual const StageInfo& info() const = 0;

  /// Finds the reference switches. Blocks until done.
  virtual Status home(std::stop_token stop = {}) = 0;

  /// Moves and blocks until the controller says that it stands still. A requested stop halts the motion and returns an
  /// Error. Errors: alarm, limit, no answer, target refused.
  virtual Status move_to(const Vec2& target_mm, std::stop_token stop = {}) = 0;

  /// Reads the position back from the controller.
  virtual Result<Vec2> position() = 0;

  /// How far the carriage stands from where the controller believes since it was homed, told by the home switches: each
  /// is gone to until it closes, to within 0.01 mm, and left again for the place where homing ends. Tells up to 2 mm.
  /// Errors: those of move_to; a stage that cannot tell, or was not homed with StageSettings::check_home.
  virtual Result<Vec2> slipped_mm(std::stop_token stop = {});

  /// Decelerates to a stand-still as fast as the controller can without losing its position. Thread-safe.
  virtual void halt() = 0;
};

/// Opens the stage that a bench file names. One owner per port (TIOCEXCL and flock) or USB interface (claimed).
/// Errors: path or serial missing, busy, silent, garbage, an alarm that homing does not clear, kind unknown.
Result<std::unique_ptr<Stage>> open_stage(const StageSettings& settings);

/// That the kind of stage is known. Pure. Errors: it is not, with those that are.
Status check_stage_kind(const StageSettings& settings);

/// Serial ports that look like a stage (/dev/tty{USB,ACM}*), `path` if given, and controllers on USB, usable or not;
/// none is stopped or reset.
std::vector<DeviceReport> find_stages(const std::string& path = {});

/// The stage that a bench file names, answering or not; it is neither stopped nor reset.
DeviceReport probe_stage(const StageSettings& settings);

}  // namespace lumifield
