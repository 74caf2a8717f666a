#pragma once

#include <span>
#include <vector>

namespace lumifield {

/// An axis-parallel box on an image, in pixels: [x0, x1] × [y0, y1].
struct PixelBox {
  double x0, x1, y0, y1;
  bool empty() const { return !(x1 > x0 && y1 > y0); }
};

/// Integrals of a non-negative image over boxes (Crow 1984). The image is constant on its pixels, so that bilinear
/// interpolation of the table at fractional corners is exact. In double: a small box is the difference of large sums,
/// good to 2⁻⁵³ of the whole image's, which for 4k images with bright pixels is beyond float. Value type, immutable,
/// safe from any thread.
class SummedAreaTable {
 public:
  /// Row by row; finite, not negative.
  SummedAreaTable(std::span<const double> image, int width_px, int height_px);

  int width_px() const { return width_; }
  int height_px() const { return height_; }
  double value(int i, int j) const { return image_[index(i, j, width_)]; }
  /// The part of a box that lies on the image.
  PixelBox clipped(const PixelBox& box) const;

  /// Sum over the pixels left of i and above j, 0 ≤ i ≤ width, 0 ≤ j ≤ height.
  double corner(int i, int j) const { return table_[index(i, j, width_ + 1)]; }
  /// Integral over [0, x] × [0, y], within the image.
  double prefix(double x, double y) const;
  /// Integral over a box within the image, pixel² the unit of area; not below 0.
  double integral(const PixelBox& box) const;
  double total() const { return table_.back(); }

 private:
  static std::size_t index(int i, int j, int stride) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(i);
  }
  int width_, height_;
  std::vector<double> image_, table_;
};

}  // namespace lumifield
