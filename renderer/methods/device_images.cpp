#include "renderer/methods/device_images.h"

#include <algorithm>

#include "renderer/methods/image_levels.h"

namespace lumifield {

namespace {

/// Floats that a kernel reads at once.
constexpr std::size_t vector_floats = 16;

template <class T>
void copy_rows(const T* image, const ClosedFormLevel& level, float* out) {
  for (int j = 0; j < level.height; ++j, image += level.width, out += level.stride)
    std::transform(image, image + level.width, out, [](T v) { return static_cast<float>(v); });
}

}  // namespace

DeviceImages::DeviceImages(const LuminaireGeometry& geometry, bool with_levels) : channels_(geometry.channels.size()) {
  int width = geometry.measurement.width_px, height = geometry.measurement.height_px;
  if (width < 1 || height < 1) return;
  const int levels = with_levels ? coarsest_level(width, height) + 1 : 1;
  for (int level = 0; level < levels; ++level) {
    // An odd number of vectors, so that the pixels below each other lie in different sets of a cache.
    const std::size_t vectors = (static_cast<std::size_t>(width) + 2 * vector_floats - 1) / vector_floats;
    const std::size_t stride = (vectors | 1) * vector_floats;
    levels_.push_back({width, height, static_cast<int>(stride), static_cast<int>(plane_)});
    plane_ += stride * static_cast<std::size_t>(height);
    width -= width / 2;
    height -= height / 2;
  }
}

void DeviceImages::pack(const CellImage& image, std::vector<float>& packed) const {
  packed.resize(image_floats(), 0.0f);
  for (std::size_t c = 0; c < channels_; ++c) {
    const float* channel = image.channel(static_cast<int>(c));
    float* out = packed.data() + c * plane_;
    copy_rows(channel, levels_[0], out);
    if (levels_.size() == 1) continue;
    const std::vector<ImageLevel> coarse = coarse_levels(channel, image.width_px, image.height_px);
    for (std::size_t k = 0; k < coarse.size(); ++k)
      copy_rows(coarse[k].value.data(), levels_[k + 1], out + levels_[k + 1].offset);
  }
}

}  // namespace lumifield
