#include "renderer/methods/closed_form_tiles.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/closed_form_impl.h"
#include "renderer/methods/gloss.h"

namespace lumifield {

namespace {

/// The part of a pixel in one subtile of a support, ξ running from 0 to 1 over the subtile: h0, h1 are ∫φ(1 − ξ) and
/// ∫φξ, g0 and g1 the same with τ in it.
struct Segment {
  int pixel, subtile;
  double low, high;  ///< τ
  double h0, h1, g0, g1;
};

/// Subtiles of a support, an axis; a division of 0 leaves it whole.
int subtiles_of(int per_support, int division) { return division == 0 ? 1 : per_support * division; }
/// Corners of subtiles to a tile, and from one end of a subtile to the other.
int nodes_of(int division) { return std::max(division, 1); }
int step_of(int per_support, int division) { return division == 0 ? per_support : 1; }

std::vector<Segment> segments_of(const Basis& basis, const AxisWeights& axis, int division) {
  std::vector<Segment> segments;
  const double half = basis.half_support();
  const int subtiles = subtiles_of(basis.overlap(), division);
  const double length = 2 * half / subtiles;
  for (std::size_t i = 0; i < axis.pixels.size(); ++i)
    for (int k = 0; k < subtiles; ++k) {
      const AxisWeights::Pixel& pixel = axis.pixels[i];
      const double begin = -half + k * length, end = -half + (k + 1) * length;
      const double low = std::max(pixel.low, begin), high = std::min(pixel.high, end);
      if (low >= high) continue;
      const bool whole = pixel.width > 0 && low == pixel.low && high == pixel.high;
      const double exact = whole ? pixel.width / (high - low) : 1;
      const double w0 = exact * basis.moment(0, low, high), w1 = exact * basis.moment(1, low, high),
                   w2 = exact * basis.moment(2, low, high);
      const double h1 = (w1 - begin * w0) / length, g1 = (w2 - begin * w1) / length;
      segments.push_back({static_cast<int>(i), k, low, high, w0 - h1, h1, w1 - g1, g1});
    }
  return segments;
}

using Rgb = std::array<double, 3>;

/// The lobe at the corners of all subtiles.
class CornerLobes {
 public:
  CornerLobes(const TileGrid& grid, const Receiver& receiver, const GlossLobe& lobe, int division)
      : columns_(grid.columns * nodes_of(division) + 1) {
    const int rows = grid.rows * nodes_of(division) + 1;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns_; ++column) {
        const Vec2 u = grid.corner_mm + grid.size_mm.cwiseProduct(Vec2(column, row)) / nodes_of(division);
        const Vec3 to_light(u.x() - receiver.p_mm.x(), u.y() - receiver.p_mm.y(), -receiver.p_mm.z());
        values_.push_back(glossy_brdf(lobe, receiver.n, to_light.normalized()));
      }
  }
  const Rgb& at(int column, int row) const { return values_[static_cast<std::size_t>(row * columns_ + column)]; }

 private:
  int columns_;
  std::vector<Rgb> values_;
};

/// One cell as a receiver sees it, and its subtiles' first column and row.
struct SplitCell {
  const HorizonPlane& g;
  const Basis& basis;
  bool above;
  int column, row, division;
};

double plain_weight(const SplitCell& cell, const Segment& x, const Segment& y) {
  const double hx = x.h0 + x.h1, hy = y.h0 + y.h1;
  return cell.g.k * hx * hy + cell.g.x * (x.g0 + x.g1) * hy + cell.g.y * hx * (y.g0 + y.g1);
}

/// ∬ φφ f max(0, g) over a segment of both axes, by colour.
Rgb glossy_weight(const SplitCell& cell, const Segment& x, const Segment& y, double clipped, const CornerLobes& f) {
  const int column = cell.column + x.subtile, row = cell.row + y.subtile;
  const int step = step_of(cell.basis.overlap(), cell.division);
  const Rgb &f00 = f.at(column, row), &f10 = f.at(column + step, row), &f01 = f.at(column, row + step),
            &f11 = f.at(column + step, row + step);
  Rgb weight;
  for (std::size_t c = 0; c < 3; ++c) {
    if (cell.above) {
      // Linear in each axis: the moments weigh the corners.
      const auto along = [&](double hy, double gy, double low, double high) {
        const double h = low * x.h0 + high * x.h1, g = low * x.g0 + high * x.g1;
        return hy * (cell.g.k * h + cell.g.x * g) + gy * cell.g.y * h;
      };
      weight[c] = along(y.h0, y.g0, f00[c], f10[c]) + along(y.h1, y.g1, f01[c], f11[c]);
      continue;
    }
    const double half = cell.basis.half_support();
    const double per_length = subtiles_of(cell.basis.overlap(), cell.division) / (2 * half);
    const double fx = ((x.low + x.high) / 2 + half) * per_length - x.subtile;
    const double fy = ((y.low + y.high) / 2 + half) * per_length - y.subtile;
    weight[c] = clipped * ((1 - fy) * ((1 - fx) * f00[c] + fx * f10[c]) + fy * ((1 - fx) * f01[c] + fx * f11[c]));
  }
  return weight;
}

}  // namespace

double lobe_error(const TileGrid& grid, const Receiver& receiver, const GlossLobe& lobe, int division) {
  if (lobe.kind == LOBE_NONE) return 0;
  const Vec2 p = receiver.p_mm.head<2>();
  const Vec2 low = grid.corner_mm, high = low + grid.size_mm.cwiseProduct(Vec2(grid.columns, grid.rows));
  const Vec2 beside = (p - p.cwiseMax(low).cwiseMin(high));
  const double distance_squared = beside.squaredNorm() + receiver.p_mm.z() * receiver.p_mm.z();
  const double shape = static_cast<double>(lobe.shape);
  const double curvature = lobe.kind == LOBE_PHONG ? shape : 1 / (shape * shape);
  const double parts = division == 0 ? 1.0 / grid.per_support : division;
  return grid.size_mm.squaredNorm() / (distance_squared * parts * parts) * curvature / 8;
}

int gloss_division(const TileGrid& grid, const Receiver& receiver, const GlossLobe& lobe, bool light_is_even,
                   double tolerance) {
  if (light_is_even && grid.per_support > 1 && lobe_error(grid, receiver, lobe, 0) <= tolerance) return 0;
  int division = 1;
  while (division < most_division && lobe_error(grid, receiver, lobe, division) > tolerance) division *= 2;
  return division;
}

namespace {

/// What is seen of each subtile of U by a receiver; of a mean, of each subtile of each cell.
class SeenSubtiles {
 public:
  SeenSubtiles(const TileGrid& grid, const Look& look, int division)
      : look_(look), division_(nodes_of(division)), columns_(grid.columns * division_) {
    if (!look.sees) return;
    for (int row = 0; row < grid.rows * division_; ++row)
      for (int column = 0; column < columns_; ++column)
        by_point_.push_back(
            look.sees(grid.corner_mm + grid.size_mm.cwiseProduct(Vec2(column + 0.5, row + 0.5)) / division_));
  }
  double at(CellIndex cell, int column, int row) const {
    if (look_.sees) return by_point_[static_cast<std::size_t>(row * columns_ + column)] ? 1 : 0;
    return look_.visible ? look_.visible->share(look_.receiver, cell, column / division_, row / division_) : 1;
  }

 private:
  const Look& look_;
  int division_, columns_;
  std::vector<bool> by_point_;
};

}  // namespace

std::vector<double> ClosedForm::light(const Receiver& receiver, const Look& look, int division) const {
  return impl_->light_of(receiver, look, division, false);
}

std::vector<double> ClosedForm::light_detail_error_bound(const Receiver& receiver, const Look& look,
                                                         int division) const {
  impl_->make_deviations();
  return impl_->light_of(receiver, look, division, true);
}

std::vector<double> ClosedForm::Impl::light_of(const Receiver& receiver, const Look& look, int division,
                                               bool deviation) const {
  const std::size_t channels = geometry.channels.size(), gloss = gloss_values(look.lobe, channels);
  std::vector<double> light(channels + gloss, 0.0);
  const Receiver at = at_lit_height(receiver);
  const int of_receiver = level(at);
  if (!(at.p_mm.z() > 0) || (deviation && of_receiver == 0)) return light;
  const TileGrid grid(geometry.sampling);
  std::optional<CornerLobes> corners;
  if (gloss > 0) corners.emplace(grid, at, look.lobe, division);
  const SeenSubtiles seen(grid, look, division);
  const double half = basis.half_support(), scale = factor(at);

  for (const Cell& cell : cells) {
    // Classify the support against the receiver's horizon.
    const HorizonPlane g = plane(at, cell);
    const BasisRectangle support{-half, half, -half, half};
    if (highest(g, support) <= 0) continue;
    const SplitCell split{g,
                          basis,
                          lowest(g, support) >= 0,
                          cell.index.column * nodes_of(division),
                          cell.index.row * nodes_of(division),
                          division};

    // Sum what each pixel's part in each subtile gives.
    const Values values{cell, of_receiver, deviation};
    const std::pair<AxisWeights, AxisWeights> along = axes(at, values);
    const AxisWeights &x_axis = along.first, &y_axis = along.second;
    const std::vector<Segment> xs = segments_of(basis, x_axis, division), ys = segments_of(basis, y_axis, division);
    for (const Segment& y : ys)
      for (const Segment& x : xs) {
        const double v = scale * seen.at(cell.index, split.column + x.subtile, split.row + y.subtile);
        const double plain = v == 0        ? 0
                             : split.above ? plain_weight(split, x, y)
                                           : clipped_integral(basis, g, {x.low, x.high, y.low, y.high});
        if (plain == 0) continue;
        const auto c_at = [&](std::size_t c) {
          return v * values.at(static_cast<int>(c), x_axis.first + x.pixel, y_axis.first + y.pixel);
        };
        for (std::size_t c = 0; c < channels; ++c) light[c] += plain * c_at(c);
        if (gloss == 0) continue;
        const Rgb weight = glossy_weight(split, x, y, plain, *corners);
        for (std::size_t c = 0; c < gloss; ++c) light[channels + c] += weight[c] * c_at(channels == 1 ? 0 : c);
      }
  }
  return light;
}

}  // namespace lumifield
