#include "acquisition/virtual/lamps.h"

#include <algorithm>
#include <cmath>

namespace lumifield::virtual_bench {

double AxisTerm::window(double u) const {
  const double t = (u - center_mm) / half_mm;
  return std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 0;
}

double AxisTerm::detail_mm() const {
  const double finest = edge_width == 0 ? sigma : std::min(sigma, 3 * std::abs(edge_width));
  return std::min(plane_separation_mm * finest, 4.0);
}

Eigen::Array3d Lamp::radiance(const Vec2& u, const Vec2& m) const {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const LampTerm& term : terms) {
    const double window = term.x.window(u.x()) * term.y.window(u.y());
    if (window > 0) sum += term.radiance * (window * term.x.lobe(u.x(), m.x()) * term.y.lobe(u.y(), m.y()));
  }
  const double inverse_cos2 = 1 + m.squaredNorm();
  return sum * inverse_cos2 * inverse_cos2;
}

namespace {

using Rgb = Eigen::Array3d;

/// 6×5 facets, each with its own tilt, around a filament seen directly.
Lamp bike() {
  Lamp lamp;
  const Rgb warm(1.0, 0.90, 0.66);
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 6; ++i) {
      const double x = 5.4 * (i - 2.5), y = 3.8 * (j - 2);
      const double tilt_x = 0.09 * std::sin(2.3 * i + 1.7 * j), tilt_y = 0.06 * std::cos(1.9 * i - 2.9 * j);
      const double power = 2.6e4 * (1 + 0.35 * std::sin(1.1 * i + 2.6 * j));
      lamp.terms.push_back(
          {power * warm,
           {.center_mm = x, .half_mm = 4.4, .slope = tilt_x - 0.004 * x, .bend_per_mm = 0.004, .sigma = 0.09},
           {.center_mm = y, .half_mm = 3.4, .slope = tilt_y - 0.03, .bend_per_mm = -0.005, .sigma = 0.07}});
    }
  lamp.terms.push_back({9e4 * Rgb(1.0, 0.82, 0.5),
                        {.center_mm = 0.6, .half_mm = 3.4, .slope = 0.01, .bend_per_mm = 0, .sigma = 0.22},
                        {.center_mm = -0.4, .half_mm = 2.6, .slope = 0.02, .bend_per_mm = 0, .sigma = 0.20}});
  lamp.terms.push_back({7e4 * Rgb(0.6, 0.8, 1.0),
                        {.center_mm = 12.0, .half_mm = 4.2, .slope = 0.30, .bend_per_mm = 0.003, .sigma = 0.06},
                        {.center_mm = 6.4, .half_mm = 3.8, .slope = 0.20, .bend_per_mm = 0.004, .sigma = 0.05}});
  return lamp;
}

/// 4×3 zones; the cut-off of the beam's right side lies higher, both sides blended by complementary edges in m_x.
Lamp headlight() {
  Lamp lamp;
  constexpr double blend = 0.02, cut_width = 0.003;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) {
      const double x = 8.6 * (i - 1.5), y = 6.9 * (j - 1);
      const bool left = i < 2;
      const Rgb power =
          (left ? 3.4e4 : 2.6e4) * (1 + 0.2 * std::sin(1.3 * i + 2.1 * j)) * Rgb(0.93, 1.0, left ? 0.95 : 1.05);
      AxisTerm across{
          .center_mm = x, .half_mm = 5.1, .slope = left ? 0.05 : -0.06, .bend_per_mm = 0.006, .sigma = 0.20};
      AxisTerm up{.center_mm = y, .half_mm = 4.0, .slope = -0.05, .bend_per_mm = 0, .sigma = 0.07};
      across.edge_width = blend;
      up.edge = -0.01, up.edge_width = cut_width;
      lamp.terms.push_back({power, across, up});
      across.edge_width = -blend;
      up.edge = 0.035;
      lamp.terms.push_back({power, across, up});
    }
  lamp.terms.push_back({6e4 * Rgb(1.0, 0.8, 0.5),
                        {.center_mm = -12.5, .half_mm = 4.5, .slope = -0.32, .bend_per_mm = 0, .sigma = 0.05},
                        {.center_mm = -6.5, .half_mm = 4.0, .slope = -0.25, .bend_per_mm = 0, .sigma = 0.05}});
  return lamp;
}

/// 4×3 LEDs, each a wide lens and its narrower core, warm at −x, cool at +x, greener towards −y.
Lamp led_array() {
  Lamp lamp;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) {
      const double x = 8.8 * (i - 1.5), y = 7.2 * (j - 1), cool = i / 3.0;
      const Rgb colour(1.1 - 0.6 * cool, 1.0 - 0.15 * j, 0.5 + 0.6 * cool);
      const double tilt = 0.03 * std::sin(2.0 * i + 3.1 * j);
      lamp.terms.push_back({2.2e4 * colour,
                            {.center_mm = x, .half_mm = 4.7, .slope = tilt, .bend_per_mm = 0.012, .sigma = 0.18},
                            {.center_mm = y, .half_mm = 3.7, .slope = -tilt, .bend_per_mm = 0.015, .sigma = 0.16}});
      lamp.terms.push_back({6e4 * colour,
                            {.center_mm = x, .half_mm = 3.2, .slope = tilt, .bend_per_mm = 0.02, .sigma = 0.09},
                            {.center_mm = y, .half_mm = 2.8, .slope = -tilt, .bend_per_mm = 0.02, .sigma = 0.09}});
    }
  lamp.terms.push_back({8e4 * Rgb(1.0, 0.25, 0.2),
                        {.center_mm = -12.0, .half_mm = 4.2, .slope = -0.33, .bend_per_mm = 0, .sigma = 0.06},
                        {.center_mm = 6.6, .half_mm = 3.8, .slope = 0.24, .bend_per_mm = 0, .sigma = 0.06}});
  return lamp;
}

}  // namespace

std::optional<Lamp> make_lamp(std::string_view name) {
  if (name == "bike") return bike();
  if (name == "headlight") return headlight();
  if (name == "led-array") return led_array();
  return std::nullopt;
}

}  // namespace lumifield::virtual_bench
