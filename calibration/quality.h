#pragma once

#include <span>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/light_field.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// What is wrong with the pixels of S, per channel and pixel.
struct ScreenFaults {
  std::vector<float> valid_share;  ///< of what covers the pixel, worst pass
  std::vector<float> electrons;    ///< mean signal of the longest exposure, summed over the passes
};

/// Below this share of valid photosites a pixel of S has no value of its own.
inline constexpr float least_valid_share = 0.5f;
/// A pixel is lit when its value is above this share of the reference value: what the reference cell would have as its
/// value if its mean signal, read at the start of the scan, lay in front of the camera's axis and came through the
/// first pass alone. What is darker adds next to nothing to the luminaire, and its SNR says nothing about the exposure;
/// where all of the scan is starved, this share itself lies in the noise and the SNR is low.
inline constexpr double lit_reference_share = 0.01;
/// Without a reference reading a pixel is lit above this share of the cell's largest value and this many σ.
inline constexpr float lit_share = 0.05f;
inline constexpr float lit_sigmas = 5;
/// A channel of which a smaller share is lit is dark: a cell beside the lamp is, and its noise is no signal.
inline constexpr double least_lit_share = 0.001;

/// The figures of one cell and the plan's limits that it breaks, in words.
///
/// saturated_share: pixels of S with less than half of what covers them valid, in any channel. starved_share: pixels
/// whose mean signal in the longest exposure is within the read noise, in every channel. median_snr: median of value/σ
/// over the lit pixels of all channels; NaN for a dark cell, which is no fault. dark_dn: `dark_dn`, NaN without a dark
/// set, which is a warning too. exposures_s: of the passes that have more or fewer than the plan. Pure.
Quality judge(const CellImage& image, const ScreenFaults& faults, const RawCell& raw, double dark_dn,
              const Bench& bench, const Plan& plan);

}  // namespace lumifield
