#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/closed_form_shared.h"

namespace lumifield {

/// How a cell's image lies in the kernel's memory: channel by channel, in each its levels of detail one after the
/// other, rows padded with zeros so that a vector read at any pixel stays in its row. Value type.
class DeviceImages {
 public:
  DeviceImages() = default;
  /// with_levels: all levels of detail (ImageLevel), which take a third more memory; else level 0 alone.
  DeviceImages(const LuminaireGeometry& geometry, bool with_levels);

  std::span<const ClosedFormLevel> levels() const { return levels_; }
  std::size_t plane_floats() const { return plane_; }  ///< one channel
  std::size_t image_floats() const { return channels_ * plane_; }
  /// The kernel counts the floats of an image in int.
  bool fits() const { return plane_ > 0 && plane_ < std::size_t(1) << 31 && image_floats() < std::size_t(1) << 31; }

  /// The image of a cell as it is uploaded; `packed` keeps its padding from one image to the next.
  void pack(const CellImage& image, std::vector<float>& packed) const;

 private:
  std::vector<ClosedFormLevel> levels_;
  std::size_t channels_ = 0, plane_ = 0;
};

}  // namespace lumifield
