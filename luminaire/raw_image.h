#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/geometry.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// Colour filter of each photosite; RGGB: even row even column R, even row odd column G, odd row odd column B.
enum class SensorPattern { mono, rggb, grbg, gbrg, bggr };

/// One complete frame as the sensor gave it. Only complete frames become one. Row-major, top row first, DN
/// right-aligned in 16 bits. Value type, moved.
struct RawImage {
  int width_px = 0, height_px = 0;
  int bits = 12;
  SensorPattern pattern = SensorPattern::mono;
  std::vector<std::uint16_t> dn;
  double exposure_s = 0;  ///< as the camera reports it
  double gain = 0;        ///< dB, of cameras that tell it so; else 0, and the sensor's figures are of the gain in use
  Vec2 stage_mm{0, 0};    ///< stage reading q while it was exposed
  std::uint64_t frame_id = 0;
};

/// The exposures of one stage position, ascending exposure time.
using Bracket = std::vector<RawImage>;

/// The bracket behind the opaque patch, subtracted from all cells of its block.
struct DarkSet {
  Bracket bracket;
  int block = 0;
};

/// One stage offset of a cell: the cell seen through the positive or the negative filter.
struct RawPass {
  std::string name;
  Bracket bracket;
  Vec2 stage_mm{0, 0};                       ///< read back while exposing
  std::shared_ptr<const DarkSet> dark = {};  ///< its own, where the passes were not taken together; null: the cell's
};

/// Everything measured for one cell: all its passes in the bench's order, so that a stored cell is complete; or one of
/// them, where the operator changes the pass.
struct RawCell {
  CellIndex cell;
  int generation = 1;
  std::vector<RawPass> passes;
  std::shared_ptr<const DarkSet> dark;
  double position_error_mm = 0;  ///< worst |read back − commanded| over the passes
  double drift = 0;              ///< last reference reading over the first, minus 1
  double reference_dn_per_s = std::numeric_limits<double>::quiet_NaN();  ///< the first reading; NaN = none was taken
};

/// How the lamp's stabilisation ended (Plan::stabilisation).
struct StabilisationEnd {
  double watched_s = 0;
  double spread = 0;    ///< of the last readings, (largest − smallest)/smallest
  bool steady = false;  ///< false: the operator went on without
};

/// One visit to the reference cell.
struct ReferenceReading {
  int cells_done = 0;
  double signal_dn_per_s = 0;  ///< mean dark-subtracted DN/s of the chosen exposure of the first pass
  double drift = 0;            ///< against the first reading of the scan, or of the dataset that it resumes
  double exposure_s = 0;       ///< the chosen one
  int pass = 0;                ///< through which it was read; drift is against the first reading through the same
  std::optional<StabilisationEnd> stabilised = {};  ///< before it; of the first reading of a scan that waited
};

}  // namespace lumifield
