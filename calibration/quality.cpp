#include "calibration/quality.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>

#include "calibration/bracket_merge.h"
#include "luminaire/median.h"

namespace lumifield {
namespace {

/// At most 200 characters.
[[gnu::format(printf, 1, 2)]] std::string words(const char* format, ...) {
  char text[201];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

/// Share of pixels for which `fault(channel offset + pixel)` holds in any, or in every, channel.
template <class Fault>
double share(const CellImage& image, bool every, Fault fault) {
  std::size_t count = 0;
  for (std::size_t p = 0; p < image.plane(); ++p) {
    int channels = 0;
    for (int c = 0; c < image.channels; ++c) channels += fault(static_cast<std::size_t>(c) * image.plane() + p);
    count += channels >= (every ? image.channels : 1);
  }
  return static_cast<double>(count) / static_cast<double>(image.plane());
}

/// NaN without a reference reading.
double reference_value(const RawCell& raw, const Bench& bench, int channel) {
  const RawPass& pass = raw.passes.front();
  if (pass.bracket.empty() || !(raw.reference_dn_per_s > 0)) return std::numeric_limits<double>::quiet_NaN();
  const double electrons_per_s = raw.reference_dn_per_s / dn_per_electron(bench.sensor, pass.bracket.back());
  const double responsivity = bench.sensor.responsivity[static_cast<std::size_t>(channel)];
  return bench.filter.passes.front().scale * electrons_per_s / (responsivity * bench.filter.spacing_mm.prod());
}

/// value/σ of the lit pixels of one channel; empty when it is dark.
std::vector<float> lit_snr(std::span<const float> value, std::span<const float> variance, double reference) {
  const bool by_itself = std::isnan(reference);
  const double least =
      by_itself ? lit_share * *std::max_element(value.begin(), value.end()) : lit_reference_share * reference;
  std::vector<float> snr;
  for (std::size_t p = 0; p < value.size(); ++p) {
    const float sigma = std::sqrt(variance[p]);
    if (value[p] > least && sigma > 0 && (!by_itself || value[p] > lit_sigmas * sigma)) snr.push_back(value[p] / sigma);
  }
  if (static_cast<double>(snr.size()) < least_lit_share * static_cast<double>(value.size())) snr.clear();
  return snr;
}

double median_snr(const CellImage& image, const RawCell& raw, const Bench& bench) {
  std::vector<float> all;
  for (int c = 0; c < image.channels; ++c) {
    const std::span variance(image.variance.data() + static_cast<std::size_t>(c) * image.plane(), image.plane());
    const std::vector<float> snr = lit_snr({image.channel(c), image.plane()}, variance, reference_value(raw, bench, c));
    all.insert(all.end(), snr.begin(), snr.end());
  }
  if (all.empty()) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(median_of(std::move(all)));
}

}  // namespace

Quality judge(const CellImage& image, const ScreenFaults& faults, const RawCell& raw, double dark_dn,
              const Bench& bench, const Plan& plan) {
  // Measure
  Quality q;
  const double frames = static_cast<double>(bench.filter.passes.size());
  const float read_noise = static_cast<float>(bench.sensor.read_noise_e * std::sqrt(frames));
  q.saturated_share = share(image, false, [&](std::size_t i) { return faults.valid_share[i] < least_valid_share; });
  q.starved_share = share(image, true, [&](std::size_t i) {
    return faults.valid_share[i] >= least_valid_share && faults.electrons[i] <= read_noise;
  });
  q.median_snr = median_snr(image, raw, bench);
  q.position_error_mm = raw.position_error_mm;
  q.drift = raw.drift;
  q.dark_dn = dark_dn;
  for (const RawPass& pass : raw.passes)
    if (pass.bracket.size() != plan.exposures_s.size())
      for (const RawImage& frame : pass.bracket) q.exposures_s[pass.name].push_back(frame.exposure_s);

  // Compare with the limits
  if (!raw.dark)
    q.warnings.push_back("no dark set: only the black level was subtracted, dark current and hot pixels remain");
  if (q.saturated_share > plan.limits.saturated_share)
    q.warnings.push_back(words("%.3g %% of the pixels are saturated in every exposure, above the plan's %.3g %%",
                               100 * q.saturated_share, 100 * plan.limits.saturated_share));
  if (q.median_snr < plan.limits.median_snr)
    q.warnings.push_back(
        words("median SNR %.3g of the lit pixels is below the plan's %.3g: longer exposures are needed", q.median_snr,
              plan.limits.median_snr));
  if (q.position_error_mm > bench.tolerance_mm)
    q.warnings.push_back(words("the stage stood %.3g mm off, above the bench's tolerance of %.3g mm",
                               q.position_error_mm, bench.tolerance_mm));
  if (std::abs(q.drift) > plan.reference.limit)
    q.warnings.push_back(words("the reference cell has drifted by %.3g %%, above the plan's %.3g %%", 100 * q.drift,
                               100 * plan.reference.limit));
  return q;
}

}  // namespace lumifield
