#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/methods/method.h"

namespace lumifield {

/// One method at one cost: how long the picture takes and how far off it is. Value type.
struct StudyPoint {
  Method method = Method::closed_form;
  std::string luminaire;
  double cost = 0;         ///< in the method's MethodCost: T (0 exact), K, lights; 0 where it has none
  double time_ms = 0;      ///< median kernel time of the picture, by the device's own profiling
  double rel_rmse = 0;     ///< RMS error over the mean irradiance, at the stratified receivers
  double lab_delta_e = 0;  ///< mean CIE 1976 ΔE of the tone-mapped pictures
  std::string device{};
  int width_px = 0, height_px = 0;  ///< of the picture that was timed
};

/// ok: within what the method says of itself; refused: it says that it has no answer, or none of use; failed: neither.
enum class StabilityOutcome { ok, refused, failed };
std::string_view to_string(StabilityOutcome outcome);

/// One method in one case in which methods fail.
struct StabilityRow {
  Method method = Method::closed_form;
  std::string case_name;
  StabilityOutcome outcome = StabilityOutcome::failed;
  /// Largest error over the receivers, of Σ_m ∫|C_m Φ_m| max(0, ·): of samplers that of the host form's mean over
  /// seeds. NaN where refused.
  double rel_error = 0;
  std::string reason;  ///< of a refusal or a failure
};

/// One number of the paper and ours beside it.
struct FigureRow {
  std::string figure;     ///< "Fig. 5"
  std::string luminaire;  ///< of ours
  std::string what;       ///< "modified secant, depth 3, K = 200"
  std::string quantity;   ///< with its unit: "mean Lab ΔE", "time, ms"
  double ours = 0;
  double paper = 0;  ///< NaN where the paper gives none
};

/// A part that a study has not, since it failed.
struct StudyOmission {
  std::string part;  ///< "Table 1", "bike, mis"
  std::string reason;
};

/// What a study found, as it is written to and read from study.json.
struct Study {
  std::string scene;
  bool quick = false;
  std::vector<StudyPoint> points;
  std::vector<StabilityRow> stability;
  std::vector<FigureRow> figures;
  std::vector<StudyOmission> omissions;
};

}  // namespace lumifield
