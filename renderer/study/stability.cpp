#include "renderer/study/stability.h"

#include <cmath>
#include <cstdio>

#include "renderer/methods/host_method.h"
#include "renderer/study/ladder.h"

namespace lumifield {

namespace {

/// Deviations of a mean that chance does not reach in some thousand trials.
constexpr double sigmas = 5;
/// Rounding, of Σ_m ∫|C_m Φ_m| max(0, ·): of the closed form's kernel, but at cut horizons; of the others, whose
/// weights are floats.
constexpr double closed_form_rounding = 1e-5, kernel_rounding = 1e-3, host_rounding = 1e-9;

std::string percent_of_light(double share) {
  char text[64];
  std::snprintf(text, sizeof text, "states an error of %.3g %% of the light", 100 * share);
  return text;
}

StabilityRow row_of(Method method, const StabilityCase& each) {
  return {method, each.name, StabilityOutcome::failed, std::nan(""), {}};
}

StabilityRow refusal(Method method, const StabilityCase& each, const std::string& why) {
  StabilityRow row = row_of(method, each);
  row.outcome = StabilityOutcome::refused;
  row.reason = why;
  return row;
}

Result<LightField> luminaire_of(const StabilityCase& each) {
  LightField field(each.geometry);
  for (std::size_t k = 0; k < each.cells.size(); ++k)
    if (!each.cells[k].value.empty())
      if (Status added = field.add(each.geometry.sampling.index(static_cast<int>(k)), each.cells[k]); !added)
        return tl::unexpected(added.error());
  return field;
}

/// Σ_m ∫|C_m Φ_m| max(0, ·), what errors are measured against.
std::vector<double> magnitudes(const StabilityCase& each) {
  StabilityCase positive = each;
  for (CellImage& cell : positive.cells)
    for (float& v : cell.value) v = std::abs(v);
  const ClosedForm form(luminaire_of(positive).value());
  std::vector<double> all;
  for (const Receiver& r : each.receivers) all.push_back(form.irradiance(r)[0]);
  return all;
}

struct Truth {
  std::vector<double> irradiance, magnitude;
};

/// Judges one value; true while the row stands.
bool judge(StabilityRow& row, double value, double stated, double truth, double magnitude, const char* form) {
  if (!std::isfinite(value) || !std::isfinite(stated)) {
    row.reason = std::string(form) + ": not finite";
    row.rel_error = HUGE_VAL;
    return false;
  }
  const double off = std::abs(value - truth);
  const double relative = magnitude > 0 ? off / magnitude : off > 0 ? HUGE_VAL : 0;
  row.rel_error = std::isnan(row.rel_error) ? relative : std::max(row.rel_error, relative);
  if (off <= stated) return true;
  row.reason =
      std::string(form) + ": off by " + std::to_string(relative) + " of the light, more than the method states";
  return false;
}

/// Deterministic methods repeat themselves.
bool is_random(Method method) {
  return method != Method::closed_form && method != Method::far_field && method != Method::reference;
}

StabilityRow try_host(Method method, const StabilityCase& each, const LightField& field, const Truth& truth) {
  StabilityRow row = row_of(method, each);
  const bool large = each.geometry.measurement.pixels() > 1 << 20;
  const int seeds = !is_random(method) ? 1 : large ? 3 : 16;
  std::vector<double> mean(each.receivers.size(), 0.0), stated(mean);
  for (int seed = 1; seed <= seeds; ++seed) {
    MethodSettings settings{.method = method, .lod = each.lod, .samples = each.samples, .seed = std::uint32_t(seed)};
    if (method == Method::precomputed_lights) settings.samples *= 10;
    const auto form = make_host_method(field, settings);
    if (!form) return refusal(method, each, form.error().message());
    for (std::size_t k = 0; k < each.receivers.size(); ++k) {
      const auto one = (*form)->estimate(each.receivers[k], static_cast<std::uint32_t>(k));
      if (!one) return refusal(method, each, one.error().message());
      mean[k] += one->irradiance[0] / seeds;
      stated[k] = one->stated_error[0];
    }
  }
  for (std::size_t k = 0; k < each.receivers.size(); ++k) {
    // A deviation as large as the light itself: no answer of use.
    if (stated[k] > truth.magnitude[k] && truth.magnitude[k] > 0)
      return refusal(method, each, percent_of_light(stated[k] / truth.magnitude[k]));
    const double allowed = (is_random(method) ? sigmas * stated[k] / std::sqrt(seeds) : stated[k]) +
                           (method == Method::position_dependent_printed ? stated[k] : 0);
    if (!judge(row, mean[k], allowed + host_rounding * truth.magnitude[k], truth.irradiance[k], truth.magnitude[k],
               "host"))
      return row;
  }
  row.outcome = StabilityOutcome::ok;
  return row;
}

/// The kernel must be as near as its host form states for one run.
StabilityRow try_kernel(StabilityRow row, const StabilityCase& each, const LightField& field, const Truth& truth) {
  MethodSettings settings{.method = row.method, .lod = each.lod, .samples = each.samples};
  if (row.method == Method::precomputed_lights) settings.samples *= 10;
  const auto fail_with = [&](const Error& error) {
    row.outcome = StabilityOutcome::failed;
    row.reason = "kernel: " + error.message();
    return row;
  };
  auto method = make_device_method(field.geometry(), settings);
  if (!method) return fail_with(method.error());
  if (const Status set = (*method)->set_cells(field); !set) return fail_with(set.error());
  if (const Status set = (*method)->set_receivers(each.receivers); !set) return fail_with(set.error());
  if (const auto done = (*method)->evaluate(HUGE_VAL); !done) return fail_with(done.error());
  std::vector<double> e;
  if (const Status read = (*method)->read(e); !read) return fail_with(read.error());
  const auto host = make_host_method(field, settings).value();
  for (std::size_t k = 0; k < e.size(); ++k) {
    const double stated = host->estimate(each.receivers[k], static_cast<std::uint32_t>(k)).value().stated_error[0];
    const bool fine = row.method == Method::closed_form && !each.cut_horizon;
    const double allowed = (is_random(row.method) ? sigmas : 1) * stated +
                           (fine ? closed_form_rounding : kernel_rounding) * truth.magnitude[k];
    StabilityRow kernel = row;
    if (!judge(kernel, e[k], allowed, truth.irradiance[k], truth.magnitude[k], "kernel")) {
      kernel.outcome = StabilityOutcome::failed;
      return kernel;
    }
    // One run of a sampler says less than the mean over seeds.
    if (!is_random(row.method)) row.rel_error = kernel.rel_error;
  }
  return row;
}

}  // namespace

std::vector<StabilityRow> try_case(const StabilityCase& each) {
  std::vector<StabilityRow> rows;
  const auto field = luminaire_of(each);
  if (!field) {
    for (const MethodInfo& method : methods()) rows.push_back(refusal(method.method, each, field.error().message()));
    return rows;
  }
  for (const Receiver& r : each.receivers)
    if (!r.p_mm.allFinite() || !r.n.allFinite()) {
      // What a kernel's caller is told.
      for (const MethodInfo& method : methods()) {
        const auto device = make_device_method(
            each.geometry, {.method = method.method == Method::reference ? Method::closed_form : method.method});
        const Status set = device ? (*device)->set_receivers(each.receivers) : Status(tl::unexpected(device.error()));
        rows.push_back(set ? row_of(method.method, each) : refusal(method.method, each, set.error().message()));
      }
      return rows;
    }
  Truth truth{{}, magnitudes(each)};
  const ClosedForm reference(*field);
  for (const Receiver& r : each.receivers) truth.irradiance.push_back(reference.irradiance(r)[0]);
  for (const MethodInfo& method : methods()) {
    StabilityRow row = try_host(method.method, each, *field, truth);
    if (row.outcome == StabilityOutcome::ok && method.method != Method::reference)
      row = try_kernel(std::move(row), each, *field, truth);
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<std::vector<StabilityRow>> stability_table(const StudyProgress& progress) {
  std::vector<StabilityRow> rows;
  const std::vector<StabilityCase> cases = stability_cases();
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (!progress(static_cast<double>(k) / static_cast<double>(cases.size()), "stability: " + cases[k].name))
      return study_stopped();
    for (StabilityRow& row : try_case(cases[k])) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace lumifield
