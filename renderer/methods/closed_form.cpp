#include "renderer/methods/closed_form.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/closed_form_impl.h"

namespace lumifield {

ClosedForm::ClosedForm(const LightField& light_field, double pixels_per_support)
    : impl_(
          new Impl{light_field.geometry(), Basis(light_field.geometry().sampling.basis), pixels_per_support, {}, {}}) {
  const Sampling& sampling = impl_->geometry.sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    auto image = light_field.cell(index);
    if (!image) continue;
    Impl::Cell cell{index, sampling.cell_center_mm(index), std::move(image), {}, {}};
    const int width = cell.image->width_px, height = cell.image->height_px;
    for (int c = 0; pixels_per_support > 0 && c < cell.image->channels; ++c)
      cell.means.push_back(coarse_levels(cell.image->channel(c), width, height));
    impl_->cells.push_back(std::move(cell));
  }
}

ClosedForm::~ClosedForm() = default;

void ClosedForm::Impl::Cell::make_deviations() {
  for (std::size_t c = 0; c < means.size(); ++c)
    deviations.push_back(
        coarse_deviations(image->channel(static_cast<int>(c)), image->width_px, image->height_px, means[c]));
}

void ClosedForm::Impl::make_deviations() {
  std::call_once(deviations_made, [this] {
    for (Cell& cell : cells) cell.make_deviations();
  });
}

/// ∬ φφ max(0, n·(u−p)) over one pixel's part of the support.
double ClosedForm::Impl::weight(const HorizonPlane& g, const AxisWeights::Pixel& x, const AxisWeights::Pixel& y,
                                bool above) const {
  const BasisRectangle rectangle{x.low, x.high, y.low, y.high};
  if (above || lowest(g, rectangle) >= 0) return g.k * x.w0 * y.w0 + g.x * x.w1 * y.w0 + g.y * x.w0 * y.w1;
  return clipped_integral(basis, g, rectangle);
}

int ClosedForm::Impl::level(const Receiver& receiver) const {
  const Measurement& m = geometry.measurement;
  const double height = receiver.p_mm.z(), r = (height - geometry.planes.separation_mm) / height;
  const Vec2 per_spacing = geometry.sampling.spacing_mm.cwiseQuotient(m.pixel_mm);
  const double span = std::abs(r) * per_spacing.maxCoeff() * 2 * basis.half_support();
  return level_of_detail(pixels_per_support, span, coarsest_level(m.width_px, m.height_px));
}

HorizonPlane ClosedForm::Impl::plane(const Receiver& receiver, const Cell& cell) const {
  const Vec2 a = geometry.sampling.spacing_mm, u = cell.u_mm;
  const Vec3 &p = receiver.p_mm, &n = receiver.n;
  return {n.x() * (u.x() - p.x()) + n.y() * (u.y() - p.y()) - n.z() * p.z(), n.x() * a.x(), n.y() * a.y()};
}

std::pair<AxisWeights, AxisWeights> ClosedForm::Impl::axes(const Receiver& receiver, const Values& values) const {
  const Measurement& m = geometry.measurement;
  const Vec2 a = geometry.sampling.spacing_mm, u = values.cell.u_mm;
  const Vec3& p = receiver.p_mm;
  const double delta = geometry.planes.separation_mm;
  const double times = std::ldexp(1.0, values.level);
  const Vec2 corner = m.corner_mm(), pixel = m.pixel_mm * times;
  const int width = static_cast<int>(std::ceil(m.width_px / times));
  const int height = static_cast<int>(std::ceil(m.height_px / times));
  return {axis_weights(basis, {delta, p.z(), p.x()}, {u.x(), a.x(), corner.x(), pixel.x(), width}),
          axis_weights(basis, {delta, p.z(), p.y()}, {u.y(), a.y(), corner.y(), pixel.y(), height})};
}

double ClosedForm::Impl::factor(const Receiver& receiver) const {
  const double delta = geometry.planes.separation_mm, z = receiver.p_mm.z();
  return delta * delta * geometry.sampling.spacing_mm.prod() / (z * z * z);
}

void ClosedForm::Impl::add(const Receiver& receiver, const Values& values, std::vector<double>& sum) const {
  // Classify the support against the receiver's horizon.
  const double half = basis.half_support();
  const HorizonPlane g = plane(receiver, values.cell);
  const BasisRectangle support{-half, half, -half, half};
  if (highest(g, support) <= 0) return;
  const bool above = lowest(g, support) >= 0;

  // Sum rows, then the cell.
  const auto [x, y] = axes(receiver, values);
  std::vector<double> total(sum.size(), 0.0), row(sum.size());
  for (std::size_t j = 0; j < y.pixels.size(); ++j) {
    std::fill(row.begin(), row.end(), 0.0);
    for (std::size_t i = 0; i < x.pixels.size(); ++i) {
      if (x.pixels[i].w0 == 0 || y.pixels[j].w0 == 0) continue;
      const double w = weight(g, x.pixels[i], y.pixels[j], above);
      for (std::size_t c = 0; c < row.size(); ++c) row[c] += w * values.at(int(c), x.first + int(i), y.first + int(j));
    }
    for (std::size_t c = 0; c < row.size(); ++c) total[c] += row[c];
  }
  const double scale = factor(receiver);
  for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += scale * total[c];
}

std::vector<double> ClosedForm::Impl::sum_of(const Receiver& receiver, bool deviation) const {
  std::vector<double> sum(geometry.channels.size(), 0.0);
  const Receiver at = at_lit_height(receiver);
  if (!(at.p_mm.z() > 0)) return sum;
  const int of_receiver = level(at);
  if (deviation && of_receiver == 0) return sum;
  for (const Cell& cell : cells) add(at, {cell, of_receiver, deviation}, sum);
  return sum;
}

std::vector<double> ClosedForm::irradiance(const Receiver& receiver) const { return impl_->sum_of(receiver, false); }

std::vector<double> ClosedForm::detail_error_bound(const Receiver& receiver) const {
  impl_->make_deviations();
  return impl_->sum_of(receiver, true);
}

}  // namespace lumifield
