#include "renderer/false_colour.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "renderer/bands.h"

namespace lumifield {
namespace {

using Rgb = std::array<double, 3>;

/// OKLab → linear sRGB (B. Ottosson, "A perceptual color space for image processing", 2020).
Rgb linear_srgb(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool shows(const Rgb& rgb) {
  return std::ranges::all_of(rgb, [](double v) { return v >= 0 && v <= 1; });
}

double srgb_encode(double v) { return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055; }

/// As much chroma, up to 0.16, as sRGB shows.
std::array<std::uint8_t, 3> colour_at(double share) {
  const double lightness = 0.18 + 0.78 * share, hue = (300 - 200 * share) * std::numbers::pi / 180;
  double least = 0, most = 0.16;
  for (int k = 0; k < 20; ++k) {
    const double chroma = (least + most) / 2;
    (shows(linear_srgb(lightness, chroma * std::cos(hue), chroma * std::sin(hue))) ? least : most) = chroma;
  }
  const Rgb rgb = linear_srgb(lightness, least * std::cos(hue), least * std::sin(hue));
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(255 * srgb_encode(std::clamp(rgb[c], 0.0, 1.0))));
  return colour;
}

constexpr std::size_t steps = 256;

const std::array<std::array<std::uint8_t, 3>, steps>& colours() {
  static const auto table = [] {
    std::array<std::array<std::uint8_t, 3>, steps> made{};
    for (std::size_t k = 0; k < steps; ++k) made[k] = colour_at(static_cast<double>(k) / (steps - 1));
    return made;
  }();
  return table;
}

double luminance(const float* rgb) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

}  // namespace

std::array<std::uint8_t, 3> false_colour(double share) {
  if (std::isnan(share)) return {128, 128, 128};
  return colours()[static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * (steps - 1)))];
}

double largest_luminance(const Picture& picture) {
  std::mutex mutex;
  double largest = 0;
  in_bands(picture.coverage.size(), [&](std::size_t begin, std::size_t end) {
    double most = 0;
    for (std::size_t i = begin; i < end; ++i)
      if (picture.coverage[i] > 0) most = std::max(most, luminance(&picture.rgb[3 * i]));
    const std::lock_guard lock(mutex);
    largest = std::max(largest, most);
  });
  return largest;
}

Picture8 false_colours(const Picture& picture, double top) {
  const double end = top > 0 ? top : largest_luminance(picture);
  Picture8 shown{picture.width_px, picture.height_px, std::vector<std::uint8_t>(picture.rgb.size(), 0)};
  in_bands(picture.coverage.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (picture.coverage[i] == 0) continue;
      const auto colour = false_colour(end > 0 ? luminance(&picture.rgb[3 * i]) / end : 0);
      std::ranges::copy(colour, shown.srgb.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
  });
  return shown;
}

}  // namespace lumifield
