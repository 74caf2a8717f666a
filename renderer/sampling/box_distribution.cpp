#include "renderer/sampling/box_distribution.h"

namespace lumifield {

BoxDistribution::BoxDistribution(const SummedAreaTable& table, const PixelBox& box)
    : table_(&table), box_(table.clipped(box)), at_x1_(table.integral(box_)) {}

double BoxDistribution::marginal(double x) const { return table_->integral({box_.x0, x, box_.y0, box_.y1}); }

double BoxDistribution::conditional(int column, double y) const {
  return table_->integral({static_cast<double>(column), column + 1.0, box_.y0, y});
}

std::optional<PixelPoint> BoxDistribution::sample(double xi1, double xi2, Inversion inversion, int depth) const {
  if (!(at_x1_ > 0)) return std::nullopt;
  const double x_target = xi1 * at_x1_;
  const CdfBracket x =
      invert_cdf([this](int i) { return marginal(i); }, {box_.x0, box_.x1, 0, at_x1_}, x_target, inversion, depth);
  const double x_at = x.position(x_target);
  const int column = std::min(static_cast<int>(x_at), table_->width_px() - 1);

  const double at_y1 = conditional(column, box_.y1);
  if (!(at_y1 > 0)) return std::nullopt;
  const double y_target = xi2 * at_y1;
  const CdfBracket y = invert_cdf([&](int j) { return conditional(column, j); }, {box_.y0, box_.y1, 0, at_y1}, y_target,
                                  inversion, depth);
  const double y_at = y.position(y_target);
  return PixelPoint{x_at, y_at, column, std::min(static_cast<int>(y_at), table_->height_px() - 1)};
}

double BoxDistribution::pdf(double x, double y) const {
  if (!(at_x1_ > 0) || x < box_.x0 || x >= box_.x1 || y < box_.y0 || y >= box_.y1) return 0;
  return table_->value(static_cast<int>(x), static_cast<int>(y)) / at_x1_;
}

BoxDistribution::Unit BoxDistribution::invert(double x, double y) const {
  const int column = std::min(static_cast<int>(x), table_->width_px() - 1);
  const double all = conditional(column, box_.y1);
  return {marginal(x) / at_x1_, all > 0 ? conditional(column, y) / all : 0};
}

}  // namespace lumifield
