#include "calibration/quality.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>

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

bool holds_light(const float* value, const float* variance, std::size_t pixels) {
  std::size_t above = 0;
  for (std::size_t p = 0; p < pixels; ++p) above += value[p] > lit_sigmas * std::sqrt(variance[p]);
  return static_cast<double>(above) >= least_lit_share * static_cast<double>(pixels);
}

double median_snr(const CellImage& image) {
  std::vector<float> snr;
  for (int c = 0; c < image.channels; ++c) {
    const float* value = image.channel(c);
    const float* variance = image.variance.data() + static_cast<std::size_t>(c) * image.plane();
    const float least = lit_share * *std::max_element(value, value + image.plane());
    if (!(least > 0) || !holds_light(value, variance, image.plane())) continue;
    for (std::size_t p = 0; p < image.plane(); ++p)
      if (value[p] > least && variance[p] > 0) snr.push_back(value[p] / std::sqrt(variance[p]));
  }
  if (snr.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = snr.begin() + static_cast<std::ptrdiff_t>(snr.size() / 2);
  std::nth_element(snr.begin(), middle, snr.end());
  return static_cast<double>(*middle);
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
  q.median_snr = median_snr(image);
  q.position_error_mm = raw.position_error_mm;
  q.drift = raw.drift;
  q.dark_dn = dark_dn;

  // Compare with the limits
  if (!raw.dark)
    q.warnings.push_back("no dark set: only the black level was subtracted, dark current and hot pixels remain");
  if (q.saturated_share > plan.limits.saturated_share)
    q.warnings.push_back(words("%.3g %% of the pixels are saturated in every exposure, above the plan's %.3g %%",
                               100 * q.saturated_share, 100 * plan.limits.saturated_share));
  if (q.median_snr < plan.limits.median_snr)
    q.warnings.push_back(words("median SNR %.3g is below the plan's %.3g", q.median_snr, plan.limits.median_snr));
  if (q.position_error_mm > bench.tolerance_mm)
    q.warnings.push_back(words("the stage stood %.3g mm off, above the bench's tolerance of %.3g mm",
                               q.position_error_mm, bench.tolerance_mm));
  if (std::abs(q.drift) > plan.reference.limit)
    q.warnings.push_back(words("the reference cell has drifted by %.3g %%, above the plan's %.3g %%", 100 * q.drift,
                               100 * plan.reference.limit));
  return q;
}

}  // namespace lumifield
