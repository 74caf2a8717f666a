#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "luminaire/error.h"

namespace lumifield {

/// A rendered view, linear: radiance leaving the surface towards the eye, in the luminaire's radiance unit, R G B
/// interleaved (a luminaire of channel Y gives three equal bands before the material's colour), first scanline on top.
struct Picture {
  int width_px = 0, height_px = 0;
  std::vector<float> rgb;       ///< 3 · width · height
  std::vector<float> coverage;  ///< 1 where a surface is seen, 0 background
  std::string note;             ///< what the picture leaves out; write_exr keeps it as the file's comments
};

/// Exponential tone mapping: v = 1 − exp(−exposure · L / L̄), then sRGB's transfer curve; L̄ is the mean luminance
/// (0.2126 R + 0.7152 G + 0.0722 B) of the pixels above 0 unless `white` gives it. Switches, named: nothing else is
/// done to the values; negatives show as 0.
struct ToneCurve {
  double exposure = 1;
  double white = 0;  ///< L̄ to use; 0 = the picture's own average
};

struct Picture8 {
  int width_px = 0, height_px = 0;
  std::vector<std::uint8_t> srgb;  ///< 3 · width · height
};

/// The average L̄ that tone mapping of this picture uses.
double average_luminance(const Picture& picture);
Picture8 tone_map(const Picture& picture, const ToneCurve& curve);

/// Writes through a temporary name, so that a full disk leaves nothing half-written.
Status write_png(const Picture8& picture, const std::filesystem::path& file);
/// Linear FLOAT channels R, G, B.
Status write_exr(const Picture& picture, const std::filesystem::path& file);

}  // namespace lumifield
