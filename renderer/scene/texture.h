#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/error.h"

namespace lumifield {

/// A picture that gives a surface its colour: linear, R G B interleaved, first scanline on top. Value type.
struct Texture {
  int width_px = 0, height_px = 0;
  std::vector<float> rgb;
  std::string note;  ///< what of the file is not shown, or not there; empty when all is
};

constexpr int max_texture_px = 16384;
/// Of all textures of a mesh together.
constexpr std::size_t max_texture_pixels = std::size_t{1} << 26;

/// Whether a file begins as PNG or OpenEXR do, by which read_texture knows them. False where it cannot be read.
bool is_texture_file(const std::filesystem::path& file);

/// Reads PNG (of all kinds; sRGB, unless the file gives a gamma of its own) and OpenEXR (one part, R, G
/// and B or Y, linear). Alpha is left out. The picture of an OpenEXR file is its display window: where the data window
/// ends before it, as of a picture that was cropped to what it shows, it is 0, which is noted; what goes beyond is cut.
///
/// Errors: a file that cannot be read to its end, a side over max_texture_px or more than `most_pixels`, of either
/// window (checked before memory is taken), windows that share no pixel, values of an OpenEXR file that are negative or
/// not finite. Reentrant.
Result<Texture> read_texture(const std::filesystem::path& file, std::size_t most_pixels = max_texture_pixels);

}  // namespace lumifield
