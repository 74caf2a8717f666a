#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield {

/// Radiance that comes from all directions, far away, as an image of latitude and longitude: R, G, B, constant on its
/// pixels, in units of the image. In the scene frame, z up: the first scanline is about +z, the middle column looks
/// along +y, columns to the right turn towards +x, as one sees them from within. Value type, immutable, safe from any
/// thread; copies share the pixels.
class LatLong {
 public:
  /// Twice as wide as high. rgb interleaved, 3 · width · height, finite and not negative.
  LatLong(int width_px, int height_px, std::vector<float> rgb);
  /// OpenEXR (R, G, B or Y; the display window is the whole turn) or PNG. Errors: those of read_texture; an image that
  /// is not twice as wide as high.
  static Result<LatLong> read(const std::filesystem::path& file);

  /// What of its file is not shown, or not there; empty when all is.
  const std::string& note() const { return note_; }
  int width_px() const { return width_; }
  int height_px() const { return height_; }
  /// L from where a direction of any length points.
  std::array<double, 3> radiance(const Vec3& direction) const;
  std::array<double, 3> pixel(int i, int j) const;
  /// Column and row of the pixel that is there.
  std::array<int, 2> pixel_at(const Vec3& direction) const;
  /// At pixel coordinates: whole numbers are edges.
  Vec3 direction(double i, double j) const;
  /// Of a pixel of row j, sr.
  double solid_angle(int j) const;

 private:
  int width_, height_;
  std::shared_ptr<const std::vector<float>> rgb_;
  std::string note_;
};

}  // namespace lumifield
