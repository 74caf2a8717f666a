#include "renderer/sampling/piecewise_constant_1d.h"

namespace lumifield {

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const double> f) : f_(f.begin(), f.end()) {
  cumulative_.reserve(f.size() + 1);
  for (const double value : f) cumulative_.push_back(cumulative_.back() + value);
}

double PiecewiseConstant1D::operator()(double x) const {
  return x >= 0 && x < pieces() ? f_[static_cast<std::size_t>(x)] : 0;
}

double PiecewiseConstant1D::cumulative(double x) const {
  const double inside = std::clamp(x, 0.0, static_cast<double>(pieces()));
  const auto i = static_cast<std::size_t>(inside);
  return i < f_.size() ? cumulative_[i] + (inside - static_cast<double>(i)) * f_[i] : cumulative_.back();
}

double PiecewiseConstant1D::pdf(double x, double a, double b) const {
  const double all = integral(a, b);
  return all > 0 && x >= a && x <= b ? (*this)(x) / all : 0;
}

std::optional<double> PiecewiseConstant1D::sample(double xi, double a, double b, Inversion inversion, int depth) const {
  const double low = std::clamp(a, 0.0, static_cast<double>(pieces()));
  const double high = std::clamp(b, 0.0, static_cast<double>(pieces()));
  const double at_low = cumulative(low), at_high = cumulative(high);
  if (!(at_high > at_low)) return std::nullopt;
  const double y = at_low + xi * (at_high - at_low);
  const auto cdf = [this](int i) { return cumulative_[static_cast<std::size_t>(i)]; };
  return invert_cdf(cdf, {low, high, at_low, at_high}, y, inversion, depth).position(y);
}

double PiecewiseConstant1D::invert(double x, double a, double b) const {
  const double all = integral(a, b);
  return all > 0 ? integral(a, std::clamp(x, a, b)) / all : 0;
}

}  // namespace lumifield
