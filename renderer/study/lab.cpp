#include "renderer/study/lab.h"

#include <cmath>

namespace lumifield {

namespace {

double linear(std::uint8_t code) {
  const double v = code / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

double lab_root(double t) {
  constexpr double d = 6.0 / 29;
  return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

}  // namespace

std::array<double, 3> lab_of_srgb(std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  const double r = linear(red), g = linear(green), b = linear(blue);
  const double x = lab_root((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505);
  const double y = lab_root(0.2126 * r + 0.7152 * g + 0.0722 * b);
  const double z = lab_root((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.0890);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double mean_lab_delta_e(const Picture8& a, const Picture8& b) {
  double sum = 0;
  const std::size_t pixels = a.srgb.size() / 3;
  for (std::size_t k = 0; k < pixels; ++k) {
    const auto p = lab_of_srgb(a.srgb[3 * k], a.srgb[3 * k + 1], a.srgb[3 * k + 2]);
    const auto q = lab_of_srgb(b.srgb[3 * k], b.srgb[3 * k + 1], b.srgb[3 * k + 2]);
    sum += std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  }
  return pixels == 0 ? 0 : sum / static_cast<double>(pixels);
}

}  // namespace lumifield
