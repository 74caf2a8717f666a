#include "acquisition/virtual/photosites.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lumifield::virtual_bench {

namespace {

/// Finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
std::uint64_t combine(std::uint64_t key, std::uint64_t value) { return mix(key + 0x9e3779b97f4a7c15u + mix(value)); }

/// Quantiles (i + ½)/n of the normal distribution, scaled so that the sum of two independent ones has variance 1.
constexpr std::size_t quantiles = 4096;
std::array<float, quantiles> make_normal_table() {
  std::array<float, quantiles> table;
  double sum2 = 0;
  for (std::size_t i = 0; i < quantiles; ++i) {
    const double p = (static_cast<double>(i) + 0.5) / quantiles;
    double z = 0;
    for (double step = 4; step > 1e-12; step /= 2) z += 0.5 * std::erfc(-z / std::sqrt(2.0)) < p ? step : -step;
    table[i] = static_cast<float>(z);
    sum2 += z * z;
  }
  const float scale = static_cast<float>(1 / std::sqrt(2 * sum2 / quantiles));
  for (float& z : table) z *= scale;
  return table;
}

}  // namespace

Photosites::Photosites(const Sensor& sensor, int width_px, int height_px, std::uint64_t seed)
    : sensor_(sensor), seed_(seed) {
  constexpr float dark_e_s = 3;
  constexpr int hot_pixels = 30;
  dark_.assign(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), dark_e_s);
  for (std::uint64_t i = 0; i < hot_pixels; ++i) {
    const std::uint64_t h = combine(combine(seed, 0x407), i);
    dark_[h % dark_.size()] = 500 * std::exp2(static_cast<float>(h >> 40) / 4e6f);
  }
}

void Photosites::expose(const Exposure& exposure, std::size_t first, std::span<const float> rate,
                        std::span<std::uint16_t> dn) const {
  static const std::array<float, quantiles> normal = make_normal_table();
  const float gain = static_cast<float>(sensor_.gain_dn_per_e * std::pow(10, exposure.gain_db / 20));
  const float light_s = static_cast<float>(exposure.seconds * exposure.light);
  const float dark_s = exposure.noise ? static_cast<float>(exposure.seconds) : 0.0f;
  const float read2 = static_cast<float>(sensor_.read_noise_e * sensor_.read_noise_e);
  const float full_scale = static_cast<float>(sensor_.saturation_dn);
  const float offset = static_cast<float>(sensor_.black_level_dn) + 0.5f, spread = exposure.noise ? gain : 0.0f;

  std::uint64_t key = combine(seed_, static_cast<std::uint64_t>(exposure.stage_um[0]));
  key = combine(key, static_cast<std::uint64_t>(exposure.stage_um[1]));
  key = combine(key, static_cast<std::uint64_t>(std::llround(exposure.seconds * 1e6)));
  key = combine(key, static_cast<std::uint64_t>(std::llround(exposure.gain_db * 1e3)));

  for (std::size_t p = 0; p < dn.size(); ++p) {
    const std::uint64_t h = mix(key + 0x9e3779b97f4a7c15u * (first + p));
    const float z = normal[h % quantiles] + normal[(h >> 20) % quantiles];
    const float electrons = rate[p] * light_s + dark_[first + p] * dark_s;
    const float value = offset + gain * electrons + spread * std::sqrt(electrons + read2) * z;
    dn[p] = static_cast<std::uint16_t>(std::clamp(value, 0.0f, full_scale));
  }
}

}  // namespace lumifield::virtual_bench
