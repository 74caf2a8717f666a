#include "acquisition/virtual/slide.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lumifield::virtual_bench {

namespace {

double bisect_sign_change(const Dual& f, double a, double b) {
  const bool positive = f(a) > 0;
  for (int i = 0; i < 60; ++i) {
    const double middle = (a + b) / 2;
    ((f(middle) > 0) == positive ? a : b) = middle;
  }
  return (a + b) / 2;
}

}  // namespace

Slide::Slide(const FilterSlide& filter) : filter_(filter), dual_(filter.basis, filter.window) {
  // Knots lie at multiples of half a spacing; between them f is a parabola.
  constexpr int samples = 32;
  for (int k = -filter.window; k < filter.window; ++k) {
    double begin = k / 2.0;
    const auto inside = [&](int i) { return (k + (i + 0.5) / samples) / 2; };
    for (int i = 0; i + 1 < samples; ++i) {
      const double a = inside(i), b = inside(i + 1);
      if ((dual_(a) > 0) == (dual_(b) > 0)) continue;
      const double root = bisect_sign_change(dual_, a, b);
      pieces_.push_back({begin, root, dual_(a) > 0});
      begin = root;
    }
    pieces_.push_back({begin, (k + 1) / 2.0, dual_(inside(samples - 1)) > 0});
  }
}

Slide Slide::none(const FilterSlide& filter) {
  Slide none(filter);
  none.taken_out_ = true;
  none.filter_.passes = {{"open", {0, 0}, 1}};
  none.pieces_ = {{-INFINITY, INFINITY, true}};
  return none;
}

Slide Slide::of_pass(const FilterSlide& filter, std::size_t pass) {
  FilterSlide one = filter;
  one.passes = {filter.passes[pass]};
  return Slide(one);
}

double Slide::transmission(const FilterPass& pass, const Vec2& offset_mm) const {
  const double value = f(offset_mm.x() / filter_.spacing_mm.x()) * f(offset_mm.y() / filter_.spacing_mm.y());
  return std::max(0.0, value / pass.scale);
}

Vec2 filter_center_mm(const Bench& bench, const FilterPass& pass, const Vec2& stage_mm) {
  const StageToLuminaire& map = bench.stage_to_luminaire;
  const Vec2 center = map.linear * (stage_mm - pass.offset_mm) + map.origin_mm;
  return bench.stage_carries == StageCarries::slide ? center : Vec2(-center);
}

Vec2 displacement_mm(const Bench& bench, const Vec2& stage_mm) {
  if (bench.stage_carries == StageCarries::slide) return Vec2::Zero();
  return bench.stage_to_luminaire.linear * stage_mm + bench.stage_to_luminaire.origin_mm;
}

int cells_needed(double lamp_mm, double spacing_mm, int window) {
  return static_cast<int>(std::ceil(lamp_mm / spacing_mm + window - 1e-9));
}

Vec2 half_grid_mm(const Bench& bench) {
  Vec2 half;
  for (int axis = 0; axis < 2; ++axis) {
    const double a = bench.filter.spacing_mm[axis];
    half[axis] = (cells_needed(bench.lamp_size_mm[axis], a, bench.filter.window) - 1) * a / 2;
  }
  return half;
}

void lay_out_slide(Bench& bench) {
  FilterSlide& filter = bench.filter;
  const bool slide = bench.stage_carries == StageCarries::slide;

  // Distances between the filters and to the opaque patch, in steps of 5 mm.
  const Vec2 half_grid = half_grid_mm(bench);
  const Vec2 needed = half_grid + bench.lamp_size_mm / 2 + filter.window * filter.spacing_mm / 2;
  const auto offset = [&](int axis) { return std::max(90.0, 5 * std::ceil((needed[axis] + 2) / 5)); };
  const Dual dual(filter.basis, filter.window);
  const bool one_pass = dual.k_negative() < 1e-12;
  const double apart = one_pass || filter.change == PassChange::by_operator ? 0 : offset(0);
  const double first = slide ? 0 : -apart / 2;
  filter.passes = {{"positive", {first, 0}, dual.k_positive()}};
  if (!one_pass) filter.passes.push_back({"negative", {first + apart, 0}, -dual.k_negative()});
  filter.dark_offset_mm = {0, offset(1)};

  // A stage mounted slightly askew, one axis running backwards, with small errors of scale.
  const double angle = slide ? 0.007 : -0.005;
  const Eigen::Vector2d scale = slide ? Vec2(1.001, -0.999) : Vec2(-1.0005, 1.0015);
  Eigen::Matrix2d rotation;
  rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  bench.stage_to_luminaire.linear = rotation * scale.asDiagonal();

  // Travel from 0 to what the grid, the passes and the opaque patch need, with 8 mm to spare.
  const Vec2 reach = half_grid + Vec2(8, 8);
  const Vec2 home = (Vec2(-first, 0) + reach).array().ceil();
  bench.stage_to_luminaire.origin_mm = -bench.stage_to_luminaire.linear * home;
  bench.limits.low_mm = Vec2::Zero();
  bench.limits.high_mm = (home + Vec2(filter.passes.back().offset_mm.x(), offset(1)) + reach).array().ceil();
}

}  // namespace lumifield::virtual_bench
