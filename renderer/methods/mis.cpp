#include "renderer/methods/mis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "renderer/methods/mis_shared.h"
#include "renderer/methods/position_dependent.h"
#include "renderer/methods/seen_tiles.h"

namespace lumifield {

MisCounts mis_counts(double samples) {
  const auto whole = [&](double share) { return static_cast<int>(std::min(share * samples, most_samples)); };
  return {samples, samples / 2, samples * 7 / 8, whole(0.5), whole(4)};
}

/// What all samples of a receiver have in common.
class Mis::Mixture {
 public:
  Mixture(const Mis& mis, const ReceiverView& at)
      : view(at), diffuse({}, at.receiver().n), glossy(at.look().lobe, at.receiver().n), mis_(mis) {
    const Sampling& s = view.geometry().sampling;
    const Vec2 reach = view.half_support() * s.spacing_mm;
    low_ = s.cell_center_mm({0, 0}) - reach;
    high_ = s.cell_center_mm({s.rows - 1, s.columns - 1}) + reach;
    shines_ = view.look().lobe.kind != LOBE_NONE && glossy.shines();
    gloss = shines_ && lamp_shown(glossy) >= MIS_SHOWS;
    const MisCounts& counts = mis.counts_;
    count = gloss ? counts.glossy : lamp_shown(diffuse) >= MIS_SHOWS ? counts.diffuse : 0;
    points = gloss ? &mis.glossy_ : &mis.diffuse_;
    filtered = gloss && mis.settings_.filter;
    split = filtered && glossy.width() <= MIS_SPLITS;
    const double n_light = split ? counts.light_apart : gloss ? counts.light_beside : counts.light;
    balance = mis.lights_.balance(view, n_light);
    const double all = std::accumulate(balance.a.begin(), balance.a.end(), 0.0);
    per_area_ = all > 0 ? n_light / all / s.spacing_mm.prod() : 0;
    even_ = n_light / MIS_WORTH / (high_ - low_).prod();
  }

  /// A ray from u and what both kinds of samples weigh it by.
  struct Ray {
    Vec2 u;
    Vec3 direction;
    double length, area;             ///< |u−p|; of U by solid angle, mm²/sr
    double facing;                   ///< max(0, n·ω)
    std::array<double, 3> shines{};  ///< f n·ω
    double lobes = 0;                ///< b
  };
  Ray ray(const Vec2& u) const {
    const Vec3& p = view.receiver().p_mm;
    const Vec3 to(u.x() - p.x(), u.y() - p.y(), -p.z());
    const double length = to.norm();
    Ray ray{u, to / length, length, length * length * length / p.z(), 0, {}, 0};
    ray.facing = std::max(view.receiver().n.dot(ray.direction), 0.0);
    if (shines_) {
      const double pdf = glossy.pdf(ray.direction);
      ray.shines = glossy.weight(ray.direction);
      for (double& f : ray.shines) f *= pdf;
    }
    ray.lobes = count * lobe().pdf(ray.direction);
    return ray;
  }
  /// Empty where it does not come from U, or nothing is reflected.
  std::optional<Ray> ray_of(const LobeDraw& draw) const {
    if (!(draw.direction.z() < 0)) return std::nullopt;
    const Vec3& p = view.receiver().p_mm;
    const Ray one = ray(p.head<2>() - p.z() / draw.direction.z() * draw.direction.head<2>());
    return one.facing > 0 && one.lobes > 0 ? std::optional(one) : std::nullopt;
  }

  /// q_m.
  double light(const Ray& ray, const SampledCell& cell, double importance) const {
    return ray.area * per_area_ * (balance.on_u ? mean_importance(view, cell) : importance);
  }
  /// The same as weights have it.
  double weighed_light(const Ray& ray, const SampledCell& cell, double importance) const {
    return filtered ? even(ray) : light(ray, cell, importance);
  }
  double even(const Ray& ray) const { return ray.area * even_ * on_lamp(ray.u, footprint(ray)); }
  /// Calls visit(q_m, F) for each cell that a ray meets, F: L f n·ω by value of the receiver.
  template <class Visit>
  void over_cells(const Ray& ray, const Visit& visit) const {
    std::vector<double> values(view.values());
    mis_.rays_.over_parts(view, ray.u, 0, [&](const RayLight::Part& part) {
      double importance = 0;
      for (const double c : part.value) importance += std::abs(c);
      if (!(importance > 0)) return;
      over_values(ray, part.value, [&](std::size_t k, double value) { values[k] = part.factor * value; });
      visit(light(ray, mis_.cell(part.number), importance), values);
    });
  }
  /// Calls visit(k, value) with a lobe sample's part of each of the receiver's values.
  template <class Visit>
  void over_lobe_sample(const Ray& ray, const Visit& visit) const {
    if (filtered) {
      const double weight = 1 / ((split ? 0 : even(ray)) + ray.lobes);
      over_values(ray, mis_.rays_.radiance(view, ray.u, footprint(ray)), [&](std::size_t k, double value) {
        if (!split || is_gloss(k)) visit(k, weight * value);
      });
      return;
    }
    over_cells(ray, [&](double q, const std::vector<double>& values) {
      for (std::size_t k = 0; k < values.size(); ++k) visit(k, values[k] / (q + ray.lobes));
    });
  }
  bool is_gloss(std::size_t value) const { return value >= view.geometry().channels.size(); }
  /// What a light sample counts for, of one of the receiver's values.
  double light_share(const Ray& ray, double q, std::size_t value) const {
    if (split) return is_gloss(value) ? 0 : 1;
    return ray.lobes > 0 ? q / (q + ray.lobes) : 1;
  }
  /// Of the lobe samples.
  const LobeDistribution& lobe() const { return gloss ? glossy : diffuse; }

  const ReceiverView& view;
  LobeDistribution diffuse, glossy;
  bool gloss, filtered;                  ///< lobe samples are of the glossy lobe; and averaged
  bool split;                            ///< they alone make gloss, and light samples alone what is diffuse
  int count;                             ///< N
  const std::vector<LobePoint>* points;  ///< of them
  LightSamples::Balance balance{};

 private:
  template <class Visit>
  void over_values(const Ray& ray, const std::vector<double>& light, const Visit& visit) const {
    const std::size_t channels = light.size();
    for (std::size_t k = 0; k < view.values(); ++k)
      visit(k, k < channels ? ray.facing * light[k]
                            : ray.shines[(k - channels) % 3] * light[channels == 1 ? 0 : k - channels]);
  }
  static double footprint(const Ray& ray) { return std::min(std::sqrt(ray.area / ray.lobes), 0.5 * ray.length); }
  /// Share of a square about u that is on the lamp.
  double on_lamp(const Vec2& u, double width) const {
    const Vec2 half(width / 2, width / 2);
    return ((u + half).cwiseMin(high_) - (u - half).cwiseMax(low_)).cwiseMax(0.0).prod() / (width * width);
  }
  /// Of the square by which a lobe is told.
  double lamp_shown(const LobeDistribution& lobe) const {
    const Vec3 &p = view.receiver().p_mm, &axis = lobe.axis();
    if (!(axis.z() < 0)) return 0;
    const double length = p.z() / -axis.z();
    return on_lamp(p.head<2>() + length * axis.head<2>(), MIS_REACH * lobe.width() * length / std::sqrt(-axis.z()));
  }

  const Mis& mis_;
  bool shines_;
  Vec2 low_, high_;         ///< the lamp's part of U
  double per_area_, even_;  ///< of q_m on U by importance, 1/mm²; K_L over the lamp's part
};

Mis::Mis(const LightField& light_field, const MethodSettings& settings, std::optional<MisCounts> counts)
    : settings_(settings),
      counts_(counts.value_or(mis_counts(settings.samples))),
      rays_(light_field, settings.filter),
      lights_(light_field, settings),
      by_number_(static_cast<std::size_t>(light_field.geometry().sampling.cells()), 0),
      diffuse_(lobe_points(settings.sequence, counts_.diffuse, settings.seed, LobeDraws::diffuse)),
      glossy_(lobe_points(settings.sequence, counts_.glossy, settings.seed, LobeDraws::glossy)) {
  for (std::size_t m = 0; m < lights_.cells().size(); ++m) by_number_[lights_.cells()[m].number] = m;
}

void Mis::add_light_samples(const Mixture& mix, std::uint32_t number, std::vector<double>& values) const {
  const std::vector<int> counts = lights_.counts(mix.balance, number);
  const Vec2& spacing = rays_.geometry().sampling.spacing_mm;
  const double support = 4 * mix.view.half_support() * mix.view.half_support();
  for (std::size_t m = 0; m < counts.size(); ++m) {
    if (counts[m] == 0) continue;
    const SampledCell& cell = lights_.cells()[m];
    const bool on_u = mix.balance.on_u;
    const double scale = (on_u ? support : mix.balance.a[m]) / mix.balance.kappa[m];
    lights_.over_draws(mix.view, number, cell, on_u, counts[m], [&](const Vec2& tau, int i, int j) {
      const Mixture::Ray ray = mix.ray(cell.u_mm + spacing.cwiseProduct(tau));
      const double importance = cell.importance.value(i, j), q = mix.weighed_light(ray, cell, importance);
      const double share = mix.light_share(ray, q, 0);
      add_sample(mix.view, cell, tau, i, j, share * (on_u ? scale * importance : scale), values);
    });
  }
  if (mix.split)
    for (std::size_t k = 0; k < values.size(); ++k)
      if (mix.is_gloss(k)) values[k] = 0;
}

void Mis::add_lobe_samples(const Mixture& mix, std::uint32_t number, std::vector<double>& values) const {
  if (mix.count == 0) return;
  const std::vector<LobePoint>& points = *mix.points;
  const LobeDraws kind = mix.gloss ? LobeDraws::glossy : LobeDraws::diffuse;
  const std::size_t first = first_point(settings_.sequence, points.size(), number, settings_.seed, kind);
  const LobeTurn turn = lobe_turn(number, settings_.seed, kind);
  for (int k = 0; k < mix.count; ++k) {
    const LobePoint& point = points[(first + static_cast<std::size_t>(k)) % points.size()];
    if (const auto ray = mix.ray_of(mix.lobe().sample(turned(point, turn))))
      mix.over_lobe_sample(*ray, [&](std::size_t c, double value) { values[c] += value; });
  }
}

Result<std::vector<double>> Mis::light(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  const ReceiverView view(rays_.geometry(), rays_.basis(), receiver, look);
  std::vector<double> values(view.values(), 0.0);
  if (!view.in_front()) return values;
  const Mixture mix(*this, view);
  if (std::ranges::none_of(mix.balance.a, [](double a) { return a > 0; })) return values;
  add_light_samples(mix, number, values);
  add_lobe_samples(mix, number, values);
  return values;
}

Mis::Weights Mis::weights(const Receiver& receiver, const Look& look, CellIndex cell, const Vec2& u_mm) const {
  const ReceiverView view(rays_.geometry(), rays_.basis(), receiver, look);
  const Mixture mix(*this, view);
  const Mixture::Ray ray = mix.ray(u_mm);
  Weights weights{0, 0};
  const auto number = static_cast<std::uint32_t>(rays_.geometry().sampling.flat(cell));
  rays_.over_parts(view, u_mm, 0, [&](const RayLight::Part& part) {
    double importance = 0;
    for (const double c : part.value) importance += std::abs(c);
    if (part.number != number || !(importance > 0)) return;
    const double q = mix.weighed_light(ray, this->cell(number), importance);
    const double light = mix.light_share(ray, q, view.values() - 1);
    weights = {light, 1 - light};
  });
  return weights;
}

/// Sums over one pass of all that is seen: ∫ F dω, the light samples' part of it, and ∫ F²/density.
struct Mis::Moments {
  std::vector<double> all, mean, squares;
};

void Mis::add_filtered_lobes(const Mixture& mix, Moments& sums) const {
  const std::vector<LobePoint> points = judging_points(mix.count);
  const auto n = static_cast<double>(mix.count), many = static_cast<double>(points.size());
  for (const LobePoint& xi : points)
    if (const auto ray = mix.ray_of(mix.lobe().sample(xi)))
      mix.over_lobe_sample(*ray, [&](std::size_t k, double value) {
        sums.mean[k] += n / many * value;
        sums.squares[k] += n / many * value * value;
      });
}

std::vector<double> Mis::stated(const Mixture& mix) const {
  const std::size_t values = mix.view.values();
  const std::vector<double> none(values, 0.0);
  Moments sums{none, none, none};
  const auto fine = [&](const Vec3& direction) {
    const auto one = [&](const LobeDistribution& lobe) {
      return 0.5 * std::max(lobe.width(), lobe.angle_from_axis(direction));
    };
    return values > rays_.geometry().channels.size() && mix.glossy.shines()
               ? std::min(one(mix.diffuse), one(mix.glossy))
               : one(mix.diffuse);
  };
  std::vector<double> together(values);
  over_seen_tiles(mix.view, fine, [&](const Vec2& u, const Vec3&, double solid_angle) {
    const Mixture::Ray ray = mix.ray(u);
    if (!(ray.facing > 0)) return;
    const double even = mix.filtered && ray.lobes > 0 ? mix.even(ray) : 1;
    std::ranges::fill(together, 0.0);
    mix.over_cells(ray, [&](double q, const std::vector<double>& of_cell) {
      for (std::size_t k = 0; k < values; ++k) {
        const double share = mix.light_share(ray, mix.filtered ? even : q, k);
        sums.all[k] += solid_angle * of_cell[k];
        sums.mean[k] += solid_angle * share * of_cell[k];
        sums.squares[k] += solid_angle * share * share * of_cell[k] * of_cell[k] / q;
        together[k] += of_cell[k] / (q + ray.lobes);
      }
    });
    if (mix.filtered) return;
    for (std::size_t k = 0; k < values; ++k) sums.squares[k] += solid_angle * ray.lobes * together[k] * together[k];
  });
  if (mix.filtered) add_filtered_lobes(mix, sums);
  std::vector<double> stated(values);
  for (std::size_t k = 0; k < values; ++k)
    stated[k] = std::sqrt(sums.squares[k]) + (mix.filtered ? std::abs(sums.mean[k] - sums.all[k]) : 0);
  return stated;
}

Result<Estimate> Mis::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(rays_.geometry(), rays_.basis(), receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front()) return result;
  const Mixture mix(*this, view);
  if (std::ranges::any_of(mix.balance.a, [](double a) { return a > 0; })) result.stated_error = stated(mix);
  return result;
}

}  // namespace lumifield
