#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// Signal of one pixel: DN = black + g (e + dark·t + noise), g = gain_dn_per_e · 10^(gain_dB/20), e = rate · t.
///
/// Noise-weighted mean of the rate over the exposures of a bracket, after the dark set was subtracted exposure by
/// exposure:
///
///     n_k = (DN_k − D_k)/g,   V_k = rate·t_k + 2 (dark·t_k + read² + 1/(12 g²)),   rate = Σ w_k n_k/t_k / Σ w_k
///     w_k = h_k t_k²/V_k
///
/// V_k is the model's variance at one pooled rate per pixel, not at each reading: a weight made from the reading itself
/// follows its noise and pulls the mean down (Σ n/Σ t, then the weighted mean itself; the best linear estimate is
/// uncorrelated with the differences between exposures, so what it weights stays unbiased). dark is pooled likewise
/// over the dark set, with weights t, since read noise rules there. An exposure counts while DN and D are unsaturated;
/// h_k fades a longer exposure out below saturation, by the pooled rate, so that which readings count does not hang on
/// their own noise either. Negative values are kept.
///
/// Pure functions; value types.

/// What a dark set says about each photosite.
class DarkModel {
 public:
  DarkModel(std::shared_ptr<const DarkSet> set, const Sensor& sensor);

  const Bracket& bracket() const { return set_->bracket; }
  const std::shared_ptr<const DarkSet>& set() const { return set_; }
  /// Index of the dark frame of that exposure (to 1e-3) and gain.
  std::optional<std::size_t> match(const RawImage& light) const;
  /// Pooled dark current, e⁻/s; an estimate, so it may be negative.
  std::span<const float> rate() const { return rate_; }
  /// Mean of the longest exposure.
  double mean_dn() const { return mean_dn_; }

 private:
  std::shared_ptr<const DarkSet> set_;
  std::vector<float> rate_;
  double mean_dn_ = 0;
};

/// One pass: its bracket, the factor with which its rate enters the sum, and its dark set where it has one of its own.
struct WeightedBracket {
  const Bracket* bracket = nullptr;
  double scale = 1;
  const DarkModel* dark = nullptr;
};

/// Σ scale · rate of one photosite, times the photosite's factor.
///
/// Without an unsaturated exposure in some pass `valid` is 0, and the shortest exposure stands for that pass: a lower
/// bound of its rate. Its standard deviation is then the full scale of that exposure, which a clipped value equals.
struct PhotositeSignal {
  float value = 0;
  float variance = 0;
  float valid = 0;      ///< 1 or 0
  float electrons = 0;  ///< signal of the longest exposure, summed over the passes, e⁻
};

/// Photosites [begin, end) of one sensor row.
struct RowSpan {
  int begin = 0, end = 0;
};

/// Merges the brackets of passes that see S in the same place. All frames have one size; every exposure has its dark
/// frame, of its pass' own dark set or else of `dark`, unless both are null, when black_level_dn is subtracted instead
/// and dark current stays in. The noise of a dark frame is common to neighbouring passes that share it and enters their
/// sum once, with its sign. `factor`: per photosite, `out`: per
/// photosite; only those in `rows` are read and written.
void merge_brackets(std::span<const WeightedBracket> passes, const DarkModel* dark, const Sensor& sensor,
                    std::span<const float> factor, std::span<const RowSpan> rows, std::span<PhotositeSignal> out);

/// g, DN per electron of a frame.
double dn_per_electron(const Sensor& sensor, const RawImage& frame);

}  // namespace lumifield
