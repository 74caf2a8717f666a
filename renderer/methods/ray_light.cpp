#include "renderer/methods/ray_light.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

double half_box_of(const Basis& basis) {
  return std::sqrt(3 * basis.moment(2, -basis.half_support(), basis.half_support()));
}

RayLight::RayLight(const LightField& light_field, bool with_levels)
    : geometry_(light_field.geometry()),
      basis_(geometry_.sampling.basis),
      half_box_(half_box_of(basis_)),
      by_number_(static_cast<std::size_t>(geometry_.sampling.cells()), -1) {
  for (MeasuredCell& each : measured_cells(light_field)) {
    by_number_[each.number] = static_cast<int>(cells_.size());
    Cell cell{std::move(each), {}};
    const CellImage& image = *cell.image.image;
    if (with_levels)
      for (int c = 0; c < image.channels; ++c)
        cell.levels.push_back(coarse_levels(image.channel(c), image.width_px, image.height_px));
    cells_.push_back(std::move(cell));
  }
}

double RayLight::width(const ReceiverView& view, const Vec2& u, double width_mm) {
  const Vec3& p = view.receiver().p_mm;
  return std::min(width_mm, 0.5 * std::hypot(u.x() - p.x(), u.y() - p.y(), p.z()));
}

double RayLight::widened_by(int axis, double width_mm) const {
  const double a = geometry_.sampling.spacing_mm[axis];
  return width_mm > a ? std::sqrt(width_mm * width_mm - a * a) / a : 0;
}

RayLight::Range RayLight::range(int axis, double u_mm, double width_mm) const {
  const Sampling& s = geometry_.sampling;
  const double reach = basis_.half_support() + widened_by(axis, width_mm) / 2;
  const double at = (u_mm - s.cell_center_mm({0, 0})[axis]) / s.spacing_mm[axis];
  const double cells = axis == 0 ? s.columns : s.rows;
  return {static_cast<int>(std::clamp(std::ceil(at - reach), 0.0, cells)),
          static_cast<int>(std::clamp(std::floor(at + reach) + 1, 0.0, cells))};
}

RayLight::Reach RayLight::reach(int axis, double u_mm, double u_m_mm, double width_mm) const {
  const double a = geometry_.sampling.spacing_mm[axis], tau = (u_mm - u_m_mm) / a;
  const double by = widened_by(axis, width_mm);
  if (by == 0) return {basis_(tau), u_mm, width_mm};
  const double low = tau - by / 2, high = tau + by / 2;
  const double side = width_mm / a / 2;
  const double from = std::clamp(tau - side, -half_box_, half_box_), to = std::clamp(tau + side, -half_box_, half_box_);
  return {basis_.moment(0, low, high) / by, u_m_mm + a * (from + to) / 2, a * (to - from)};
}

void RayLight::part(const ReceiverView& view, const Cell& cell, const Vec2& u, double width_mm, Part& part) const {
  const Vec2& u_m = cell.image.u_mm;
  const Reach x = reach(0, u.x(), u_m.x(), width_mm), y = reach(1, u.y(), u_m.y(), width_mm);
  const Vec2 center(x.center_mm, y.center_mm), tau = (center - u_m).cwiseQuotient(geometry_.sampling.spacing_mm);
  const Vec2 on_s = view.on_s_px(u_m, tau);
  const double r = view.delta_mm() / view.receiver().p_mm.z();
  const double area = r * r * x.size_mm * y.size_mm / geometry_.measurement.pixel_mm.prod();
  const double level = area > 1 ? 0.5 * std::log2(area) : 0;
  part.number = cell.image.number;
  const Vec3& p = view.receiver().p_mm;
  const double delta = geometry_.planes.separation_mm;
  const auto slant2 = [&](const Vec2& at) { return 1 + ((at - p.head<2>()) / p.z()).squaredNorm(); };  // 1/cos²θ
  const double here = slant2(center), spread = center == u ? 1 : std::pow(slant2(u) / here, 1.5);
  part.factor = delta * delta * here * here * spread * x.phi * y.phi *
                view.seen(geometry_.sampling.index(static_cast<int>(cell.image.number)), tau);
  part.value.resize(static_cast<std::size_t>(cell.image.image->channels));
  for (std::size_t c = 0; c < part.value.size(); ++c) part.value[c] = value(cell, c, on_s, level);
}

double RayLight::value(const Cell& cell, std::size_t channel, const Vec2& on_s, double level) const {
  const int coarsest = cell.levels.empty() ? 0 : static_cast<int>(cell.levels[channel].size());
  const int below = std::min(static_cast<int>(level), coarsest);
  const double share = below < coarsest ? level - below : 0;
  const double at_level = texel(cell, channel, on_s, below);
  return share > 0 ? at_level + share * (texel(cell, channel, on_s, below + 1) - at_level) : at_level;
}

double RayLight::texel(const Cell& cell, std::size_t channel, const Vec2& on_s, int level) const {
  const CellImage& image = *cell.image.image;
  if (level == 0) {
    if (!(on_s.x() >= 0 && on_s.x() < image.width_px && on_s.y() >= 0 && on_s.y() < image.height_px)) return 0;
    return image.at(static_cast<int>(channel), static_cast<int>(on_s.x()), static_cast<int>(on_s.y()));
  }
  const ImageLevel& coarse = cell.levels[channel][static_cast<std::size_t>(level - 1)];
  const Vec2 at = on_s * std::ldexp(1.0, -level) - Vec2(0.5, 0.5);
  if (!(at.x() > -1 && at.x() < coarse.width_px && at.y() > -1 && at.y() < coarse.height_px)) return 0;
  const double i = std::floor(at.x()), j = std::floor(at.y()), x = at.x() - i, y = at.y() - j;
  const auto one = [&](double column, double row) {
    if (column < 0 || column >= coarse.width_px || row < 0 || row >= coarse.height_px) return 0.0;
    return coarse.value[static_cast<std::size_t>(row) * static_cast<std::size_t>(coarse.width_px) +
                        static_cast<std::size_t>(column)];
  };
  return (1 - y) * ((1 - x) * one(i, j) + x * one(i + 1, j)) + y * ((1 - x) * one(i, j + 1) + x * one(i + 1, j + 1));
}

std::vector<double> RayLight::radiance(const ReceiverView& view, const Vec2& u, double width_mm) const {
  std::vector<double> light(geometry_.channels.size(), 0.0);
  over_parts(view, u, width_mm, [&](const Part& part) {
    for (std::size_t c = 0; c < light.size(); ++c) light[c] += part.factor * part.value[c];
  });
  return light;
}

}  // namespace lumifield
