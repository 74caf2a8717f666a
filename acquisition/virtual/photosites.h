#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "luminaire/bench.h"

namespace lumifield::virtual_bench {

/// The camera's sensor, from electrons per second to DN:
///
///     n = (rate + dark) t,   DN = black + gain · (n + √(n + read²) z),   rounded, clipped to [0, saturation],
///
/// dark = a small dark current, large at some thirty hot pixels, z a standard normal hashed from (seed, stage position
/// in µm, exposure in µs, gain, pixel): the same frame taken again is the same. Immutable, safe from any thread.
class Photosites {
 public:
  Photosites(const Sensor& sensor, int width_px, int height_px, std::uint64_t seed);

  struct Exposure {
    std::int64_t stage_um[2];
    double seconds, gain_db;
    bool noise;    ///< off: no dark current, hot pixels, shot and read noise; DN are still whole numbers
    double light;  ///< factor on the rate
  };
  /// Pixels first … first + dn.size() of the sensor, row by row; rate holds e⁻/s of the same pixels.
  void expose(const Exposure& exposure, std::size_t first, std::span<const float> rate,
              std::span<std::uint16_t> dn) const;

  const std::vector<float>& dark_current() const { return dark_; }  ///< e⁻/s, every pixel

 private:
  Sensor sensor_;
  std::uint64_t seed_;
  std::vector<float> dark_;
};

}  // namespace lumifield::virtual_bench
