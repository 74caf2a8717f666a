#include <algorithm>
#include <cmath>
#include <numbers>

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
  std::vector<Estimate> estimates, by_gloss;
  for (std::size_t k = 0; k < each.receivers.size(); ++k) {
    auto one = (*form)->estimate(each.receivers[k], static_cast<std::uint32_t>(k), each.appearance.look(k));
    if (!one) return tl::unexpected(one.error());
    for (std::size_t c = 0; c < one->irradiance.size(); ++c)
      (c == 0 ? estimates : by_gloss).push_back({{one->irradiance[c]}, {one->stated_error[c]}});
  }
  estimates.insert(estimates.end(), by_gloss.begin(), by_gloss.end());
  answers.host.push_back(std::move(estimates));
  return {};
}

Status add_kernel(const StabilityCase& each, const LightField& light_field, Method method, int seeds,
                  StabilityAnswers& answers) {
  const MethodSettings settings = settings_of(method, each, 1);
  auto device = make_device_method(light_field.geometry(), settings);
  if (!device) return tl::unexpected(device.error());
  if (const Status set = (*device)->set_cells(light_field); !set) return set;
  if (const Status set = (*device)->set_receivers(each.receivers, each.appearance); !set) return set;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (const Status set = (*device)->set_samples(settings.samples, static_cast<std::uint32_t>(seed)); !set) return set;
    if (const auto done = (*device)->evaluate(HUGE_VAL); !done) return tl::unexpected(done.error());
    std::vector<double> e;
    if (const Status read = (*device)->read(e); !read) return read;
    std::vector<double> gloss;
    if (const Status read = (*device)->read_gloss(gloss); !read) return read;
    e.insert(e.end(), gloss.begin(), gloss.end());
    answers.kernel.push_back(std::move(e));
  }
  return {};
}

}  // namespace

namespace {

/// GGX as it is printed, to be compared with: D of Walter et al. 2007 (Eq. 33), Λ of Heitz 2014 (Eq. 72), Schlick's F.
double printed_ggx(const GlossLobe& lobe, const Vec3& n, const Vec3& i) {
  const Vec3 o = Vec3(lobe.eye_x, lobe.eye_y, lobe.eye_z).normalized(), h = (i + o).normalized();
  const double a = lobe.shape, ni = n.dot(i), no = n.dot(o), nh = n.dot(h);
  if (!(ni > 0 && no > 0)) return 0;
  const auto lambda = [&](double cosine) {
    return (std::sqrt(1 + a * a * (1 - cosine * cosine) / (cosine * cosine)) - 1) / 2;
  };
  const double d = a * a / (std::numbers::pi * std::pow(nh * nh * (a * a - 1) + 1, 2));
  const double f0 = lobe.r, f = f0 + (1 - f0) * std::pow(1 - h.dot(o), 5);
  return d * f / (1 + lambda(ni) + lambda(no)) / (4 * ni * no);
}

/// The tile under a point of a cell's support.
double share_at(const StabilityCase& each, std::size_t receiver, CellIndex cell, const Vec2& u) {
  const TileVisibility& visible = each.appearance.visible;
  if (visible.empty()) return 1;
  const TileGrid& grid = visible.grid;
  const Vec2 at = (u - grid.corner_mm).cwiseQuotient(grid.size_mm);
  const int column = std::clamp(static_cast<int>(at.x()), cell.column, cell.column + grid.per_support - 1);
  const int row = std::clamp(static_cast<int>(at.y()), cell.row, cell.row + grid.per_support - 1);
  return visible.share(receiver, cell, column, row);
}

/// The most that n·(u − p)'s terms make of the light.
double terms_of(const StabilityCase& each, const LightField& light_field, const Receiver& r) {
  const Sampling& sampling = each.geometry.sampling;
  const double half = Basis(sampling.basis).half_support();
  double most = 0;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const Vec2 u_m = sampling.cell_center_mm(sampling.index(flat));
    most = std::max(most, r.n.cwiseAbs().dot((Vec3(u_m.x(), u_m.y(), 0) - r.p_mm).cwiseAbs()));
  }
  most += half * sampling.spacing_mm.dot(r.n.head<2>().cwiseAbs());
  // That of a receiver parallel to U has no other term than its height.
  const double facing = definition_quadrature(light_field, r.p_mm, {0, 0, -1}).magnitude[0];
  return facing > 0 ? most * facing / r.p_mm.z() : 0;
}

}  // namespace

StabilityTruth stability_truth(const StabilityCase& each, const LightField& light_field) {
  StabilityTruth truth;
  const auto add = [&](const Receiver& r, const PointFactor& factor, double scale, double lobe) {
    const DefinitionValue value = definition_quadrature(light_field, r.p_mm, r.n, factor);
    truth.irradiance.push_back(value.irradiance[0]);
    truth.light.push_back(value.magnitude[0]);
    truth.terms.push_back(scale * terms_of(each, light_field, r));
    truth.lobe.push_back(lobe);
  };
  for (std::size_t k = 0; k < each.receivers.size(); ++k) {
    const auto share = [&](CellIndex cell, const Vec2& u) { return share_at(each, k, cell, u); };
    add(each.receivers[k], each.appearance.visible.empty() ? PointFactor{} : share, 1, 0);
  }
  for (std::size_t k = 0; k < each.appearance.gloss.size(); ++k) {
    const Receiver& r = each.receivers[k];
    const GlossLobe& lobe = each.appearance.gloss[k];
    // The lobe's peak is that of D, over 4 cosθ_o² in the mirrored direction.
    const double no = std::max(0.05, r.n.dot(Vec3(lobe.eye_x, lobe.eye_y, lobe.eye_z)));
    const double peak = 1 / (4 * std::numbers::pi * lobe.shape * lobe.shape * no * no);
    add(
        r,
        [&](CellIndex cell, const Vec2& u) {
          const Vec3 to_light = (Vec3(u.x(), u.y(), 0) - r.p_mm).normalized();
          return share_at(each, k, cell, u) * printed_ggx(lobe, r.n, to_light);
        },
        peak, peak * truth.light[k]);
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
