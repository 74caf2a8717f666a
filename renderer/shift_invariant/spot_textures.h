#pragma once

#include <memory>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_images.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// The images of a luminaire's cells as one array texture, a layer for each cell of the grid; for textured look-ups
/// with their levels of detail (SpotLayout). Thread-bound to the context that is current when it is made.
class SpotTextures {
 public:
  /// Bytes of the texture, bounded before it is taken.
  static constexpr double most_bytes = 0x1p31;

  /// Errors: images, or a grid, that the device has no texture for.
  static Result<SpotTextures> create(const LuminaireGeometry& geometry, SpotLookUp look_up);

  /// Has the image in its cell's layer, unless it is there. Holds it, so that it stays what it is. Errors: those of
  /// check_cell; the layer stays as it was.
  Status hold(CellIndex cell, const std::shared_ptr<const CellImage>& image);
  void bind(int unit);

 private:
  SpotTextures(const LuminaireGeometry& geometry, SpotLayout layout)
      : geometry_(geometry), layout_(std::move(layout)) {}
  Status make_room();
  std::size_t floats() const { return geometry_.channels.size() == 3 ? 4 : 1; }  ///< of a texel
  /// The place of one channel of a level's first pixel in a layer of floats.
  float* place(std::vector<float>& layer, std::size_t level, std::size_t channel) const;
  std::vector<float> layer_of(const CellImage& image) const;

  LuminaireGeometry geometry_;
  SpotLayout layout_;
  GlTexture texture_;
  std::vector<std::shared_ptr<const CellImage>> held_;  ///< by Sampling::flat
};

}  // namespace lumifield
