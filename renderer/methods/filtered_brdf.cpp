#include "renderer/methods/filtered_brdf.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/seen_tiles.h"

namespace lumifield {

std::optional<RayStart> ray_start(const ReceiverView& view, const Vec3& direction) {
  if (!(direction.z() < 0)) return std::nullopt;
  const Vec3& p = view.receiver().p_mm;
  const double distance = -p.z() / direction.z();
  return RayStart{p.head<2>() + distance * direction.head<2>(), distance / std::sqrt(-direction.z())};
}

FilteredBrdf::FilteredBrdf(const LightField& light_field, const MethodSettings& settings)
    : settings_(settings),
      rays_(light_field, settings.filter),
      diffuse_(lobe_points(settings.sequence, samples(), settings.seed, LobeDraws::diffuse)),
      glossy_(lobe_points(settings.sequence, samples(), settings.seed, LobeDraws::glossy)) {}

int FilteredBrdf::samples() const { return whole_samples(settings_.samples); }

void FilteredBrdf::add(const ReceiverView& view, const LobeDistribution& draws, std::uint32_t number, LobeDraws kind,
                       std::span<double> values) const {
  const std::vector<LobePoint>& points = kind == LobeDraws::diffuse ? diffuse_ : glossy_;
  const std::size_t first = first_point(settings_.sequence, points.size(), number, settings_.seed, kind);
  const LobeTurn turn = lobe_turn(number, settings_.seed, kind);
  const int n = samples();
  for (int k = 0; k < n; ++k) {
    const LobeDraw draw = draws.sample(turned(points[(first + static_cast<std::size_t>(k)) % points.size()], turn));
    if (draw.weight[0] == 0 && draw.weight[1] == 0 && draw.weight[2] == 0) continue;
    const auto start = ray_start(view, draw.direction);
    if (!start) continue;
    const double width = settings_.filter ? start->side_mm / std::sqrt(n * draw.pdf) : 0;
    over_reflected(values.size(), draw.weight, rays_.radiance(view, start->u_mm, width),
                   [&](std::size_t c, double value) { values[c] += value / n; });
  }
}

Result<std::vector<double>> FilteredBrdf::light(const Receiver& receiver, std::uint32_t number,
                                                const Look& look) const {
  const ReceiverView view(rays_.geometry(), rays_.basis(), receiver, look);
  std::vector<double> values(view.values(), 0.0);
  if (!view.in_front() || rays_.empty()) return values;
  const std::size_t channels = rays_.geometry().channels.size();
  const Vec3& n = view.receiver().n;
  add(view, {{}, n}, number, LobeDraws::diffuse, std::span(values).first(channels));
  if (const LobeDistribution lobe(look.lobe, n); view.values() > channels && lobe.shines())
    add(view, lobe, number, LobeDraws::glossy, std::span(values).subspan(channels));
  return values;
}

void FilteredBrdf::add_stated(const ReceiverView& view, const LobeDistribution& draws, std::span<double> stated) const {
  const int n = samples();
  // ∫ F dω, ∫ F²/pdf dω.
  std::vector<double> light(stated.size(), 0.0), squares(stated.size(), 0.0);
  const auto fine = [&](const Vec3& direction) {
    return 0.5 * std::max(draws.width(), draws.angle_from_axis(direction));
  };
  over_seen_tiles(view, fine, [&](const Vec2& u, const Vec3& direction, double solid_angle) {
    const double part = draws.pdf(direction) * solid_angle;
    if (!(part > 0)) return;
    over_reflected(stated.size(), draws.weight(direction), rays_.radiance(view, u, 0),
                   [&](std::size_t c, double value) {
                     light[c] += part * value;
                     squares[c] += part * value * value;
                   });
  });
  if (!settings_.filter) {
    for (std::size_t c = 0; c < stated.size(); ++c) stated[c] = std::sqrt(squares[c] / n);
    return;
  }
  const std::vector<LobePoint> points = judging_points(n);
  const auto many = static_cast<double>(points.size());
  std::vector<double> mean(stated.size(), 0.0);
  std::ranges::fill(squares, 0.0);
  for (const LobePoint& xi : points) {
    const LobeDraw draw = draws.sample(xi);
    const auto start = ray_start(view, draw.direction);
    if (!start) continue;
    over_reflected(stated.size(), draw.weight,
                   rays_.radiance(view, start->u_mm, start->side_mm / std::sqrt(n * draw.pdf)),
                   [&](std::size_t c, double value) {
                     mean[c] += value / many;
                     squares[c] += value * value / many;
                   });
  }
  for (std::size_t c = 0; c < stated.size(); ++c) stated[c] = std::sqrt(squares[c] / n) + std::abs(mean[c] - light[c]);
}

Result<Estimate> FilteredBrdf::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  auto value = light(receiver, number, look);
  if (!value) return tl::unexpected(value.error());
  const ReceiverView view(rays_.geometry(), rays_.basis(), receiver, look);
  Estimate result{std::move(*value), std::vector<double>(view.values(), 0.0)};
  if (!view.in_front() || rays_.empty()) return result;
  const std::size_t channels = rays_.geometry().channels.size();
  const Vec3& n = view.receiver().n;
  const std::span<double> stated = result.stated_error;
  add_stated(view, {{}, n}, stated.first(channels));
  if (const LobeDistribution lobe(look.lobe, n); view.values() > channels && lobe.shines())
    add_stated(view, lobe, stated.subspan(channels));
  return result;
}

}  // namespace lumifield
