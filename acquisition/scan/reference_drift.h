#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "luminaire/error.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// The lamp's steadiness, watched on one cell: signal = mean over the frame of (DN − dark DN)/exposure, at the longest
/// exposure of the first visit with less than 0.1 % of its pixels at or above saturation; drift = signal / first − 1.
/// The first visit may be that of an earlier scan, so that a dataset made in several has one drift.
/// Value type.
class ReferenceDrift {
 public:
  ReferenceDrift() = default;
  /// Goes on from the first reading of an earlier scan: its signal and its exposure.
  explicit ReferenceDrift(const ReferenceReading& first)
      : earlier_exposure_s_(first.exposure_s), first_dn_per_s_(first.signal_dn_per_s) {}

  /// `dark`: the dark frame of each frame of `lit`.
  /// Errors: every exposure saturates, no light above five standard errors, frames that do not fit the dark set's, none
  /// at the exposure of the earlier scan.
  Result<ReferenceReading> read(const Bracket& lit, std::span<const RawImage> dark, double saturation_dn,
                                int cells_done);

  /// Of the last reading; 0 before the first.
  double drift() const { return drift_; }
  /// To which the drift refers; 0 before the first.
  double first_dn_per_s() const { return first_dn_per_s_; }

 private:
  std::optional<std::size_t> exposure_;  ///< index into the bracket
  std::optional<double> earlier_exposure_s_;
  double first_dn_per_s_ = 0, drift_ = 0;
};

}  // namespace lumifield
