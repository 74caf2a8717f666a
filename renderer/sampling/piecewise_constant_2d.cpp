#include "renderer/sampling/piecewise_constant_2d.h"

namespace lumifield {

PiecewiseConstant2D::PiecewiseConstant2D(const SummedAreaTable& image) {
  std::vector<double> sums, column(static_cast<std::size_t>(image.height_px()));
  for (int i = 0; i < image.width_px(); ++i) {
    for (int j = 0; j < image.height_px(); ++j) column[static_cast<std::size_t>(j)] = image.value(i, j);
    columns_.emplace_back(column);
    sums.push_back(columns_.back().integral());
  }
  marginal_ = PiecewiseConstant1D(sums);
}

PixelBox PiecewiseConstant2D::whole() const {
  return {0, static_cast<double>(marginal_.pieces()), 0, static_cast<double>(columns_.front().pieces())};
}

int PiecewiseConstant2D::column_at(double x) const {
  return std::clamp(static_cast<int>(x), 0, marginal_.pieces() - 1);
}

std::optional<PixelPoint> PiecewiseConstant2D::sample(double xi1, double xi2, const PixelBox& box, Inversion inversion,
                                                      int depth) const {
  const auto x = marginal_.sample(xi1, box.x0, box.x1, inversion, depth);
  if (!x) return std::nullopt;
  const int i = column_at(*x);
  const auto y = column(i).sample(xi2, box.y0, box.y1, inversion, depth);
  if (!y) return std::nullopt;
  return PixelPoint{*x, *y, i, std::min(static_cast<int>(*y), column(i).pieces() - 1)};
}

double PiecewiseConstant2D::pdf(double x, double y, const PixelBox& box) const {
  return marginal_.pdf(x, box.x0, box.x1) * column(column_at(x)).pdf(y, box.y0, box.y1);
}

BoxDistribution::Unit PiecewiseConstant2D::invert(double x, double y, const PixelBox& box) const {
  return {marginal_.invert(x, box.x0, box.x1), column(column_at(x)).invert(y, box.y0, box.y1)};
}

}  // namespace lumifield
