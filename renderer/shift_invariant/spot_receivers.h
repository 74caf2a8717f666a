#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_order.h"

namespace lumifield {

/// Receivers as the passes of shift-invariant take them, in a SpotOrder: positions and normals as float textures, and
/// in double as a buffer where they are asked for so; with their faces, lobes and what they see of tiles. Thread-bound
/// to the context that is current when they are set.
class SpotReceivers {
 public:
  /// Of the same receivers each. Spans: valid as long as what they look at.
  struct Given {
    std::span<const float> p_xyzw, n_xyzw, face_xyzw{};  ///< 4 floats each, p in mm, luminaire frame; no face: empty
    std::span<const double> numbers{};                   ///< p and n, 6 each, or empty
    std::span<const GlossLobe> gloss{};                  ///< one each, or empty
    std::span<const std::uint32_t> words{};              ///< of tiles seen, as many each, or empty
    int picture_columns = 0;                             ///< of a picture of them, 0: they are a list
  };
  /// Errors: more than the device has textures for, out of memory.
  Status set(const LuminaireGeometry& geometry, const Given& given);
  void bind();

  std::size_t count() const { return count_; }
  const SpotOrder& order() const { return order_; }
  bool empty() const { return order_.receiver.empty(); }  ///< none that a cell lights

 private:
  Status fill(GlTexture& texture, std::span<const float> four_each);
  Status fill_lobes(std::span<const GlossLobe> gloss);

  std::size_t count_ = 0;
  SpotOrder order_;
  GlTexture positions_, normals_, faces_, lobe_eyes_, lobe_colours_;
  GlBuffer numbers_, words_;
};

}  // namespace lumifield
