#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "luminaire/reader_notes.h"

namespace lumifield {

enum class ScanOrder { serpentine, coarse_to_fine };

struct ReferenceCell {
  CellIndex cell;
  int every = 0;        ///< cells between visits; 0 = only first and last
  double limit = 0.01;  ///< |drift| above is reported
};

struct QualityLimits {
  double saturated_share = 0.001;
  double median_snr = 20;  ///< of the lit pixels: those above 1 % of the reference cell's mean (calibration/quality.h)
};

/// Of one stage position: sizes are bounded before memory is taken.
inline constexpr std::size_t most_exposures = 64;

/// Between which exposures a scan may choose by itself; both ends included.
struct ExposureLimits {
  double shortest_s = 0, longest_s = 0;
};

/// When a lamp counts as steady: its readings over the last `over_s` spread by no more than `within`, (largest −
/// smallest)/smallest. The form of CIE S 025, where it is 0.005 over 900 s (its text was not at hand).
struct Stabilisation {
  double within = 0;   ///< 0 < within < 1
  double over_s = 0;   ///< 1 s … 1 day
  double limit_s = 0;  ///< the longest wait, over_s … 1 day
};
inline constexpr double longest_stabilisation_s = 86'400, shortest_stabilisation_s = 1;

/// The plan file ("format": "lumifield-plan", version 1): what to scan and how carefully. Value type.
struct Plan {
  std::string name;
  int columns = 0, rows = 0;
  Vec2 center_mm{0, 0};
  ScanOrder order = ScanOrder::serpentine;
  Measurement measurement;
  std::vector<double> exposures_s;  ///< ascending
  /// Where a cell saturates or starves, exposures beyond the plan's are taken within these, in their ratio
  /// (acquisition/scan/exposure_ladder.h); absent: the plan's alone. What lamp, camera and patience stand is the
  /// operator's to say: scan_rules.h
  std::optional<ExposureLimits> exposure_limits_s;
  double settle_s = 0.15;
  int dark_every_cells = 0;  ///< 0 = one dark set, at the start
  ReferenceCell reference;
  double warm_up_s = 0;
  /// After the warm-up the reference cell is watched until the lamp is steady, before the first cell; absent: it is
  /// not.
  std::optional<Stabilisation> stabilisation;
  QualityLimits limits;
};

/// Defaults taken for absent members, and members that are not known or have no effect, are told in `notes`, one text
/// each.
Result<Plan> read_plan(const std::filesystem::path& file, std::vector<std::string>* notes = nullptr,
                       ReaderNotes kind = ReaderNotes::all);
Result<Plan> parse_plan(std::string_view json, std::string_view name, std::vector<std::string>* notes = nullptr,
                        ReaderNotes kind = ReaderNotes::all);
std::string to_json(const Plan& plan);

}  // namespace lumifield
