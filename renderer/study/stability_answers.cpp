#include <algorithm>
#include <cmath>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/study/definition_quadrature.h"
#include "renderer/study/stability_judge.h"

namespace lumifield {

namespace {

/// Of a kernel: as many runs as tell a draw that rounding moved from a wrong kernel.
constexpr int kernel_seeds = 4, host_seeds = 16, large_seeds = 3;

MethodSettings settings_of(Method method, const StabilityCase& each, int seed) {
  const double k = method == Method::precomputed_lights ? 10 * each.samples : each.samples;
  return {.method = method, .lod = each.lod, .samples = k, .seed = static_cast<std::uint32_t>(seed)};
}

Status add_host(const StabilityCase& each, const LightField& light_field, const MethodSettings& settings,
                StabilityAnswers& answers) {
  if (const Status finite = check_finite(each.receivers); !finite) return finite;
  const auto form = make_host_method(light_field, settings);
  if (!form) return tl::unexpected(form.error());
  std::vector<Estimate> estimates;
  for (std::size_t k = 0; k < each.receivers.size(); ++k) {
    auto one = (*form)->estimate(each.receivers[k], static_cast<std::uint32_t>(k));
    if (!one) return tl::unexpected(one.error());
    estimates.push_back(std::move(*one));
  }
  answers.host.push_back(std::move(estimates));
  return {};
}

Status add_kernel(const StabilityCase& each, const LightField& light_field, Method method, int seeds,
                  StabilityAnswers& answers) {
  const MethodSettings settings = settings_of(method, each, 1);
  auto device = make_device_method(light_field.geometry(), settings);
  if (!device) return tl::unexpected(device.error());
  if (const Status set = (*device)->set_cells(light_field); !set) return set;
  if (const Status set = (*device)->set_receivers(each.receivers); !set) return set;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (const Status set = (*device)->set_samples(settings.samples, static_cast<std::uint32_t>(seed)); !set) return set;
    if (const auto done = (*device)->evaluate(HUGE_VAL); !done) return tl::unexpected(done.error());
    std::vector<double> e;
    if (const Status read = (*device)->read(e); !read) return read;
    answers.kernel.push_back(std::move(e));
  }
  return {};
}

}  // namespace

StabilityTruth stability_truth(const StabilityCase& each, const LightField& light_field) {
  const Sampling& sampling = each.geometry.sampling;
  const double half = Basis(sampling.basis).half_support();
  StabilityTruth truth;
  for (const Receiver& r : each.receivers) {
    const DefinitionValue value = definition_quadrature(light_field, r.p_mm, r.n);
    truth.irradiance.push_back(value.irradiance[0]);
    truth.light.push_back(value.magnitude[0]);
    double most = 0;
    for (int flat = 0; flat < sampling.cells(); ++flat) {
      const Vec2 u_m = sampling.cell_center_mm(sampling.index(flat));
      most = std::max(most, r.n.cwiseAbs().dot((Vec3(u_m.x(), u_m.y(), 0) - r.p_mm).cwiseAbs()));
    }
    most += half * sampling.spacing_mm.dot(r.n.head<2>().cwiseAbs());
    // That of a receiver parallel to U has no other term than its height.
    const double facing = definition_quadrature(light_field, r.p_mm, {0, 0, -1}).magnitude[0];
    truth.terms.push_back(facing > 0 ? most * facing / r.p_mm.z() : 0);
  }
  return truth;
}

StabilityAnswers stability_answers(Method method, const StabilityCase& each, const LightField& light_field) {
  StabilityAnswers answers;
  const bool large = each.geometry.measurement.pixels() > 1 << 20;
  const int seeds = !is_sampler(method) ? 1 : large ? large_seeds : host_seeds;
  for (int seed = 1; seed <= seeds && answers.host_refuses.empty(); ++seed)
    if (const Status added = add_host(each, light_field, settings_of(method, each, seed), answers); !added)
      answers = {{}, {}, added.error().message(), {}};
  if (const Status added = add_kernel(each, light_field, method, std::min(seeds, kernel_seeds), answers); !added) {
    answers.kernel.clear();
    answers.kernel_refuses = added.error().message();
  }
  return answers;
}

}  // namespace lumifield
