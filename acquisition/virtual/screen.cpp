#include "acquisition/virtual/screen.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquisition/virtual/quadrature.h"

namespace lumifield::virtual_bench {

ScreenGrid ScreenGrid::covering(const Vec2& half_mm, double step_mm) {
  const auto half_count = [&](double half) { return static_cast<int>(std::ceil(half / step_mm)); };
  const int nx = half_count(half_mm.x()), ny = half_count(half_mm.y());
  return {Vec2(-nx * step_mm, -ny * step_mm), step_mm, 2 * nx + 1, 2 * ny + 1};
}

Eigen::ArrayXd ScreenGrid::nodes(int axis) const {
  const int n = axis == 0 ? columns : rows;
  return Eigen::ArrayXd::LinSpaced(n, corner_mm[axis], corner_mm[axis] + (n - 1) * step_mm);
}

namespace {

/// ∫ f⁻ F du and ∫ f⁺ F du for every s; empty where filter and term do not meet.
using AxisIntegrals = std::array<Eigen::ArrayXd, 2>;

AxisIntegrals integrate_axis(const AxisTerm& term, const Slide& slide, int axis, double filter_mm,
                             const Eigen::ArrayXd& s) {
  static const GaussRule rule(8);
  const double a = slide.filter().spacing_mm[axis];
  AxisIntegrals sums;
  for (const Slide::Piece& piece : slide.pieces()) {
    const double low = std::max(filter_mm + a * piece.begin, term.low_mm());
    const double high = std::min(filter_mm + a * piece.end, term.high_mm());
    Eigen::ArrayXd& sum = sums[piece.positive];
    if (low < high && sum.size() == 0) sum = Eigen::ArrayXd::Zero(s.size());
    rule.panels(low, high, term.detail_mm(), [&](double u, double weight) {
      weight *= std::abs(slide.f((u - filter_mm) / a)) * term.window(u);
      sum += weight * term.lobe(u, Eigen::ArrayXd((s - u) / plane_separation_mm));
    });
  }
  return sums;
}

/// One product of the irradiance Σ colour · y xᵀ.
struct Factor {
  Eigen::ArrayXd x, y;
  Eigen::Array3d colour;
};

std::vector<Factor> factors_of(const Lamp& lamp, const Slide& slide, const Bench& bench, const ScreenGrid& grid,
                               const Vec2& stage_mm) {
  const Vec2 displacement = displacement_mm(bench, stage_mm);
  const Eigen::ArrayXd sx = grid.nodes(0) - displacement.x(), sy = grid.nodes(1) - displacement.y();
  std::vector<Factor> factors;
  for (const FilterPass& pass : slide.filter().passes) {
    const Vec2 center = filter_center_mm(bench, pass, stage_mm);
    for (const LampTerm& term : lamp.terms) {
      const AxisIntegrals x = integrate_axis(term.x, slide, 0, center.x(), sx);
      if (x[0].size() == 0 && x[1].size() == 0) continue;
      const AxisIntegrals y = integrate_axis(term.y, slide, 1, center.y(), sy);
      const Eigen::Array3d colour = term.radiance / (std::abs(pass.scale) * plane_separation_mm * plane_separation_mm);
      for (const int sign : {0, 1}) {
        const Eigen::ArrayXd& partner = y[pass.scale > 0 ? sign : 1 - sign];
        if (x[sign].size() > 0 && partner.size() > 0) factors.push_back({x[sign], partner, colour});
      }
    }
  }
  return factors;
}

}  // namespace

std::vector<Plane> screen_irradiance(const Lamp& lamp, const Slide& slide, const Bench& bench, const ScreenGrid& grid,
                                     const Vec2& stage_mm, const std::vector<Eigen::Array3d>& bands) {
  const std::vector<Factor> factors = factors_of(lamp, slide, bench, grid, stage_mm);
  const Eigen::Index count = static_cast<Eigen::Index>(factors.size());
  Eigen::MatrixXf x(count, grid.columns), y(grid.rows, count);
  for (Eigen::Index c = 0; c < count; ++c) {
    x.row(c) = factors[c].x.cast<float>();
    y.col(c) = factors[c].y.cast<float>();
  }

  std::vector<Plane> planes;
  for (const Eigen::Array3d& band : bands) {
    Eigen::MatrixXf weighted = x;
    for (Eigen::Index c = 0; c < count; ++c) weighted.row(c) *= static_cast<float>((band * factors[c].colour).sum());
    planes.push_back(Plane::Zero(grid.rows, grid.columns));
    if (count > 0) planes.back().noalias() = y * weighted;
  }
  return planes;
}

namespace {

/// Separable kernel (v/2, 1 − v, v/2): unit sum, variance v. Pixels beyond the image repeat its edge.
void blur(Plane& image, float variance) {
  const float side = variance / 2, middle = 1 - variance;
  const Eigen::Index w = image.cols(), h = image.rows();
  Plane wider(h, w + 2), higher(h + 2, w);
  wider << image.col(0), image, image.col(w - 1);
  image = middle * image + side * (wider.leftCols(w) + wider.rightCols(w));
  higher << image.row(0), image, image.row(h - 1);
  image = middle * image + side * (higher.topRows(h) + higher.bottomRows(h));
}

}  // namespace

Plane photograph(const Plane& screen, const ScreenGrid& grid, const LensMap& lens, double blur_px) {
  Plane image(lens.height_px, lens.width_px);
  const Eigen::Vector2f corner = grid.corner_mm.cast<float>();
  const float per_mm = static_cast<float>(1 / grid.step_mm);
  const float last_x = static_cast<float>(grid.columns - 1), last_y = static_cast<float>(grid.rows - 1);
  for (Eigen::Index p = 0; p < image.size(); ++p) {
    const float x = (lens.screen_mm[p].x() - corner.x()) * per_mm, y = (lens.screen_mm[p].y() - corner.y()) * per_mm;
    float value = 0;
    if (x >= 0 && y >= 0 && x < last_x && y < last_y) {
      const int i = static_cast<int>(x), j = static_cast<int>(y);
      const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j);
      const float* above = screen.data() + static_cast<Eigen::Index>(j) * grid.columns + i;
      const float* below = above + grid.columns;
      value = (1 - fy) * (above[0] + fx * (above[1] - above[0])) + fy * (below[0] + fx * (below[1] - below[0]));
    }
    image.data()[p] = value;
  }
  // A square pixel has variance 1/12.
  blur(image, static_cast<float>(1.0 / 12 + blur_px * blur_px));
  return image;
}

}  // namespace lumifield::virtual_bench
