#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumifield::virtual_bench {

/// What a camera does to the sensor's values before it sends them, as cameras come from the factory, or from another
/// program. Value type.
struct GenicamProcessing {
  bool mirrored_x = false, mirrored_y = false;
  double gain_db = 0;          ///< digital, after the sensor's
  double red = 1, blue = 1;    ///< factors of an RGGB pattern's photosites, on those of mono sensors too
  double gamma = 1;            ///< power, of full scale
  bool table = false;          ///< a look-up table, which halves them
  bool white_balance = false;  ///< every other value of every other row up by a quarter
  bool black_level = false;    ///< up by the number of the frame, 1 … 7

  bool operator==(const GenicamProcessing&) const = default;
  bool changes() const { return *this != GenicamProcessing{}; }
  void apply(std::span<std::uint16_t> dn, int width_px, int bits, std::uint64_t frame) const;
};

/// Means of bins of `columns` × `rows` photosites, rounded down; `width_px` of the picture that results.
void bin(std::span<const std::uint16_t> dn, int columns, int rows, int width_px, std::span<std::uint16_t> out);

}  // namespace lumifield::virtual_bench
