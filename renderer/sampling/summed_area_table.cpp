#include "renderer/sampling/summed_area_table.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

SummedAreaTable::SummedAreaTable(std::span<const double> image, int width_px, int height_px)
    : width_(width_px), height_(height_px), image_(image.begin(), image.end()) {
  table_.assign(static_cast<std::size_t>(width_ + 1) * static_cast<std::size_t>(height_ + 1), 0.0);
  for (int j = 0; j < height_; ++j) {
    double row = 0;
    for (int i = 0; i < width_; ++i) {
      row += value(i, j);
      table_[index(i + 1, j + 1, width_ + 1)] = corner(i + 1, j) + row;
    }
  }
}

PixelBox SummedAreaTable::clipped(const PixelBox& box) const {
  const double width = width_, height = height_;
  return {std::clamp(box.x0, 0.0, width), std::clamp(box.x1, 0.0, width), std::clamp(box.y0, 0.0, height),
          std::clamp(box.y1, 0.0, height)};
}

double SummedAreaTable::prefix(double x, double y) const {
  const int i = std::min(static_cast<int>(x), width_ - 1), j = std::min(static_cast<int>(y), height_ - 1);
  const double fx = x - i, fy = y - j;
  const double above = corner(i, j) + fx * (corner(i + 1, j) - corner(i, j));
  const double below = corner(i, j + 1) + fx * (corner(i + 1, j + 1) - corner(i, j + 1));
  return above + fy * (below - above);
}

double SummedAreaTable::integral(const PixelBox& box) const {
  if (box.empty()) return 0;
  const double lower = prefix(box.x1, box.y1) - prefix(box.x0, box.y1);
  const double upper = prefix(box.x1, box.y0) - prefix(box.x0, box.y0);
  return std::max(lower - upper, 0.0);
}

}  // namespace lumifield
