#pragma once

#include <memory>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// The images of a luminaire's cells as one array texture, a layer for each cell of the grid; for textured look-ups
/// with their levels of detail, padded with 0 (spot_images.h). Thread-bound to the context that is current when it is
/// made.
class SpotTextures {
 public:
  /// Bytes of the texture, bounded before it is taken.
  static constexpr double most_bytes = 0x1p31;

  /// Errors: images, or a grid, that the device has no texture for.
  static Result<SpotTextures> create(const LuminaireGeometry& geometry, SpotLookUp look_up);

  /// Has the image in its cell's layer, unless it is there. Holds it, so that it stays what it is.
  Status hold(CellIndex cell, const std::shared_ptr<const CellImage>& image);
  void bind(int unit);

 private:
  SpotTextures(const LuminaireGeometry& geometry, int coarsest) : geometry_(geometry), coarsest_(coarsest) {}
  Status make_room();
  int width(int level) const;
  int height(int level) const;
  /// A level padded, channels interleaved.
  std::vector<float> padded(int level) const { return std::vector<float>(texels(level) * (rgb() ? 4 : 1), 0.0F); }
  std::size_t texels(int level) const {
    return static_cast<std::size_t>(width(level)) * static_cast<std::size_t>(height(level));
  }
  bool rgb() const { return geometry_.channels.size() == 3; }

  LuminaireGeometry geometry_;
  int coarsest_ = 0;  ///< level
  GlTexture texture_;
  std::vector<std::shared_ptr<const CellImage>> held_;  ///< by Sampling::flat
};

}  // namespace lumifield
