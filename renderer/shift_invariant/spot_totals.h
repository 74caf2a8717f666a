#pragma once

#include <array>
#include <vector>

#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// What the passes of shift-invariant add up in: images of irradiance and, with gloss, of radiance; three floats a
/// receiver that blending adds to, or sRGBE that each pass reads from one pair and writes to the other. Thread-bound to
/// the context that is current when it is made.
class SpotTotals {
 public:
  SpotTotals() = default;
  /// All 0. Errors: a size that the device has none of, out of memory.
  static Result<SpotTotals> create(SpotSums sums, bool glossy, int columns, int rows);
  SpotTotals(SpotTotals&& other) noexcept;
  SpotTotals& operator=(SpotTotals&& other) noexcept;
  ~SpotTotals();

  Status clear();
  /// Binds what the next pass draws to, and reads.
  void begin_pass();
  /// R, G, B of all texels, interleaved; of radiance, where there is gloss.
  Status read(bool radiance, std::vector<float>& rgb);

 private:
  Status make(int columns, int rows);
  void bind_to_draw() const;

  SpotSums sums_ = SpotSums::float32;
  int columns_ = 0, rows_ = 0;
  std::size_t images_ = 0;  ///< of a pair: 1, or 2 with gloss
  unsigned framebuffer_ = 0;
  std::array<GlTexture, 4> textures_;  ///< the pair that holds, then the pair that is drawn to next
};

}  // namespace lumifield
