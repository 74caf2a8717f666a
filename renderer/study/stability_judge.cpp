#include "renderer/study/stability_judge.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "renderer/methods/receiver_view.h"

namespace lumifield {

namespace {

/// Deviations that chance does not reach in some million trials.
constexpr double sigmas = 5;
/// Of a receiver's light: a stated error above it is no answer of use.
constexpr double most_stated = 0.25;

StabilityRow failure(StabilityRow row, std::string why) {
  row.outcome = StabilityOutcome::failed;
  row.reason = std::move(why);
  if (std::isnan(row.rel_error)) row.rel_error = HUGE_VAL;
  return row;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * share);
  return text;
}

double share_of(double off, double light) { return light > 0 ? off / light : off > 0 ? HUGE_VAL : 0; }

/// Of sums in double: rows, columns and cells are added one after the other, the few dozen operations of a weight round
/// once each, and so does n·(u−p).
double host_rounding(const StabilityCase& each, const StabilityTruth& truth, std::size_t k) {
  const Measurement& m = each.geometry.measurement;
  const double additions = m.width_px + m.height_px + each.geometry.sampling.cells();
  return std::numeric_limits<double>::epsilon() * ((additions + 64) * truth.light[k] + 4 * truth.terms[k]);
}

/// Of weights in float. τ rounds in two steps of the support's width, 8 half steps of 2⁻²⁴ at most, and ∫|φ′| = 2 ∫φ:
/// 16 an axis of two; as many operations once more. A sampler's runs scatter about the light.
double kernel_rounding(const StabilityTruth& truth, std::size_t k, double host) {
  return 0x1p-24 * (64 * std::max(truth.light[k], std::abs(host)) + 4 * truth.terms[k] + 64 * truth.lobe[k]);
}

/// Runs in which rounding may move a draw across a pixel's edge: as many as chance passes once in 10⁵. A cdf in float
/// is off by half a step of 2⁻²⁴ at each edge of the columns that a support shows; directions are drawn in double.
int most_strays(Method method, const StabilityCase& each, const StabilityAnswers& answers) {
  if (method == Method::filtered_brdf) return 0;
  const Basis basis(each.geometry.sampling.basis);
  const auto runs = static_cast<int>(answers.kernel.size() * each.receivers.size());
  double expected = 0;
  for (const Receiver& r : each.receivers) {
    const ReceiverView view(each.geometry, basis, r);
    const double columns =
        std::min<double>(2 * view.half_support() * std::abs(view.rate().x()), each.geometry.measurement.width_px);
    expected += static_cast<double>(answers.kernel.size()) * each.samples * (columns + 2) * 0x1p-25;
  }
  double term = std::exp(-expected), more = 1 - term;
  int k = 0;
  for (; k < runs && more > 1e-5; more -= term) term *= expected / ++k;
  return k;
}

bool finite(const StabilityAnswers& answers) {
  const auto estimate = [](const Estimate& one) {
    return std::isfinite(one.irradiance[0]) && std::isfinite(one.stated_error[0]);
  };
  const auto number = [](double e) { return std::isfinite(e); };
  return std::ranges::all_of(answers.host, [&](const auto& run) { return std::ranges::all_of(run, estimate); }) &&
         std::ranges::all_of(answers.kernel, [&](const auto& run) { return std::ranges::all_of(run, number); });
}

/// Of what one run states, what the mean over seeds may be off by beyond rounding. A stated bias stays in the mean, so
/// it is never less than one run's.
double allowed(Method method, const StabilityCase& each, std::size_t seeds) {
  const bool exact = method == Method::reference || (method == Method::closed_form && each.lod == 0);
  if (exact && each.appearance.gloss.empty()) return 0;
  return is_sampler(method) ? std::max(1.0, sigmas / std::sqrt(static_cast<double>(seeds))) : 1;
}

/// Both judges say what is wrong, or nothing, and keep the largest share of the light that an answer is off by.
std::string judge_host(Method method, const StabilityCase& each, const StabilityTruth& truth,
                       const StabilityAnswers& answers, double& worst) {
  const std::size_t seeds = answers.host.size();
  for (std::size_t k = 0; k < truth.irradiance.size(); ++k) {
    double mean = 0;
    for (const auto& run : answers.host) mean += run[k].irradiance[0] / static_cast<double>(seeds);
    const double off = std::abs(mean - truth.irradiance[k]), share = share_of(off, truth.light[k]);
    worst = std::max(worst, share);
    if (off > allowed(method, each, seeds) * answers.host[0][k].stated_error[0] + host_rounding(each, truth, k))
      return "host form: off by " + percent(share) + " of the light, more than it states";
  }
  return {};
}

std::string judge_kernel(Method method, const StabilityCase& each, const StabilityTruth& truth,
                         const StabilityAnswers& answers, double& worst) {
  int strays = 0;
  for (std::size_t seed = 0; seed < answers.kernel.size(); ++seed)
    for (std::size_t k = 0; k < truth.irradiance.size(); ++k) {
      const Estimate& host = answers.host[seed][k];
      const double e = answers.kernel[seed][k], off = std::abs(e - host.irradiance[0]);
      // One run of a sampler says less than the mean.
      if (!is_sampler(method)) worst = std::max(worst, share_of(std::abs(e - truth.irradiance[k]), truth.light[k]));
      if (off <= kernel_rounding(truth, k, host.irradiance[0])) continue;
      ++strays;
      if (!is_sampler(method) || off > sigmas * host.stated_error[0] || strays > most_strays(method, each, answers))
        return "kernel: off by " + percent(share_of(off, truth.light[k])) + " of the light from its host form";
    }
  return {};
}

/// Why the stated errors make an answer of no use, or nothing.
std::string no_use(const StabilityTruth& truth, const StabilityAnswers& answers) {
  for (std::size_t k = 0; k < truth.light.size(); ++k) {
    const double share = share_of(answers.host[0][k].stated_error[0], truth.light[k]);
    if (share > most_stated)
      return truth.light[k] > 0 ? "states an error of " + percent(share) + " of the light"
                                : "states an error though there is no light";
  }
  return {};
}

}  // namespace

bool is_sampler(Method method) {
  return method != Method::closed_form && method != Method::far_field && method != Method::shift_invariant &&
         method != Method::reference;
}

StabilityRow judged(Method method, const StabilityCase& each, const StabilityTruth& truth,
                    const StabilityAnswers& answers) {
  StabilityRow row{method, each.name, StabilityOutcome::refused, std::nan(""), answers.host_refuses};
  if (!answers.host_refuses.empty())
    return answers.kernel_refuses.empty()
               ? failure(row, "kernel: answers where its host form says: " + answers.host_refuses)
               : row;
  if (!finite(answers)) return failure(row, "not finite");

  double worst = 0;
  std::string wrong = judge_host(method, each, truth, answers, worst);
  if (wrong.empty()) wrong = judge_kernel(method, each, truth, answers, worst);
  row.reason = no_use(truth, answers);
  if (wrong.empty() && row.reason.empty() && !answers.kernel_refuses.empty())
    wrong = "kernel: " + answers.kernel_refuses;
  if (wrong.empty() && !row.reason.empty()) return row;
  row.rel_error = worst;
  if (!wrong.empty()) return failure(row, std::move(wrong));
  row.outcome = StabilityOutcome::ok;
  return row;
}

}  // namespace lumifield
