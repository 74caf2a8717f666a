#include "renderer/methods/closed_form.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/axis_weights.h"
#include "renderer/methods/horizon.h"

namespace lumifield {

struct ClosedForm::Impl {
  struct Cell {
    Vec2 u_mm;
    std::shared_ptr<const CellImage> image;
  };
  LuminaireGeometry geometry;
  Basis basis;
  std::vector<Cell> cells;

  void add(const Receiver& receiver, const Cell& cell, std::vector<double>& sum) const;
  double weight(const HorizonPlane& g, const AxisWeights::Pixel& x, const AxisWeights::Pixel& y, bool above) const;
};

ClosedForm::ClosedForm(const LightField& light_field)
    : impl_(new Impl{light_field.geometry(), Basis(light_field.geometry().sampling.basis), {}}) {
  const Sampling& sampling = impl_->geometry.sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const CellIndex index = sampling.index(flat);
    if (auto image = light_field.cell(index))
      impl_->cells.push_back({sampling.cell_center_mm(index), std::move(image)});
  }
}

ClosedForm::~ClosedForm() = default;

/// ∬ φφ max(0, n·(u−p)) over one pixel's part of the support.
double ClosedForm::Impl::weight(const HorizonPlane& g, const AxisWeights::Pixel& x, const AxisWeights::Pixel& y,
                                bool above) const {
  const BasisRectangle rectangle{x.low, x.high, y.low, y.high};
  if (above || lowest(g, rectangle) >= 0) return g.k * x.w0 * y.w0 + g.x * x.w1 * y.w0 + g.y * x.w0 * y.w1;
  return clipped_integral(basis, g, rectangle);
}

void ClosedForm::Impl::add(const Receiver& receiver, const Cell& cell, std::vector<double>& sum) const {
  // Classify the support against the receiver's horizon.
  const Sampling& sampling = geometry.sampling;
  const Vec2 a = sampling.spacing_mm;
  const Vec3 &p = receiver.p_mm, &n = receiver.n;
  const double half = basis.half_support();
  const HorizonPlane g{n.x() * (cell.u_mm.x() - p.x()) + n.y() * (cell.u_mm.y() - p.y()) - n.z() * p.z(), n.x() * a.x(),
                       n.y() * a.y()};
  const BasisRectangle support{-half, half, -half, half};
  if (highest(g, support) <= 0) return;
  const bool above = lowest(g, support) >= 0;

  // Weights of both axes.
  const Measurement& m = geometry.measurement;
  const double delta = geometry.planes.separation_mm;
  const AxisWeights x =
      axis_weights(basis, {delta, p.z(), p.x()}, {cell.u_mm.x(), a.x(), m.corner_mm().x(), m.pixel_mm.x(), m.width_px});
  const AxisWeights y = axis_weights(basis, {delta, p.z(), p.y()},
                                     {cell.u_mm.y(), a.y(), m.corner_mm().y(), m.pixel_mm.y(), m.height_px});

  // Sum rows, then the cell.
  std::vector<double> total(sum.size(), 0.0), row(sum.size());
  for (std::size_t j = 0; j < y.pixels.size(); ++j) {
    std::fill(row.begin(), row.end(), 0.0);
    for (std::size_t i = 0; i < x.pixels.size(); ++i) {
      if (x.pixels[i].w0 == 0 || y.pixels[j].w0 == 0) continue;
      const double w = weight(g, x.pixels[i], y.pixels[j], above);
      for (std::size_t c = 0; c < row.size(); ++c)
        row[c] += w * cell.image->at(int(c), x.first + int(i), y.first + int(j));
    }
    for (std::size_t c = 0; c < row.size(); ++c) total[c] += row[c];
  }
  const double scale = delta * delta * a.x() * a.y() / (p.z() * p.z() * p.z());
  for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += scale * total[c];
}

std::vector<double> ClosedForm::irradiance(const Receiver& receiver) const {
  std::vector<double> sum(impl_->geometry.channels.size(), 0.0);
  if (!(receiver.p_mm.z() > 0)) return sum;
  for (const Impl::Cell& cell : impl_->cells) impl_->add(receiver, cell, sum);
  return sum;
}

}  // namespace lumifield
