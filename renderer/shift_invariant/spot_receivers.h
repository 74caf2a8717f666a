#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"
#include "renderer/opengl/gl_objects.h"

namespace lumifield {

/// Receivers as the passes of shift-invariant take them, `columns` of them side by side, row after row: positions and
/// normals as float textures, and in double as a buffer where they are asked for so; with their faces, lobes and what
/// they see of tiles. Thread-bound to the context that is current when they are set.
class SpotReceivers {
 public:
  /// 4 floats each, interleaved, p in mm and n, luminaire frame.
  struct Floats {
    std::span<const float> p_xyzw, n_xyzw, face_xyzw{};
  };
  /// `in_double`: also as these. Errors: more than the device has textures for, out of memory.
  Status set(const Floats& floats, std::span<const double> in_double, int columns, std::span<const GlossLobe> gloss,
             std::span<const std::uint32_t> words);
  void bind();

  std::size_t count() const { return count_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

 private:
  Status fill(GlTexture& texture, std::span<const float> four_each);
  std::size_t count_ = 0;
  int columns_ = 0, rows_ = 0;
  GlTexture positions_, normals_, faces_, lobe_eyes_, lobe_colours_;
  GlBuffer numbers_, words_;
};

}  // namespace lumifield
