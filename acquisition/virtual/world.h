#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "luminaire/raw_image.h"

namespace lumifield::virtual_bench {

/// What the simulated bench is made of. `noise` covers shot and read noise, dark current and hot pixels (off: DN are
/// still whole numbers); `optics` covers distortion, vignetting and lens blur (off: an ideal pinhole, and the bench
/// file says so).
struct WorldOptions {
  std::string lamp = "bike";  ///< "bike" | "headlight" | "led-array"
  std::uint64_t seed = 1;
  bool noise = true;
  bool optics = true;
  StageCarries carries = StageCarries::slide;
  BasisKind basis = BasisKind::bell;
  Vec2 spacing_mm{7.5, 7.5};
  int window = 4;
  std::string pixel_format = "Mono12";
  int width_px = 1024, height_px = 768;
};

/// Refuses an unknown lamp or pixel format, and sizes out of range: names what, and what to use.
Status check(const WorldOptions& options);

/// The simulated world: lamp, slide, screen, camera sensor. It stands behind the servers and knows nothing of
/// protocols. The noise-free image of a stage position is computed once, in the world's own thread, as soon as the
/// stage is sent there; an exposure only scales it, adds noise and quantises. Thread-safe.
class World {
 public:
  static Result<std::unique_ptr<World>> create(const WorldOptions& options);
  ~World();

  /// The bench as an operator would have measured and written it down; addresses and device paths are left empty.
  const Bench& bench() const;

  /// The stage is on its way to q: the image there is computed meanwhile. The last few positions are kept.
  void prepare(const Vec2& stage_mm);
  /// Waits until the image of this position is computed.
  void wait_ready(const Vec2& stage_mm);

  /// DN of one frame, row-major, right-aligned in 16 bits. The noise is a hash of (seed, stage position in steps of 1
  /// µm, exposure, gain, pixel), so that a retake repeats it. At most 15 ms at 1024×768 once the position is ready;
  /// otherwise it waits for it. A region that reaches beyond the sensor reads 0 there.
  void expose(const Vec2& stage_mm, double exposure_s, double gain_db, int width_px, int height_px, int offset_x_px,
              int offset_y_px, std::span<std::uint16_t> dn);

  /// Knobs that act from the next image on: noise 0|1, lamp_drift (relative change of the lamp per hour).
  Status set(const std::string& knob, double value);

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A point and unit normal in the luminaire frame; E in W/m² in the bands R, G, B and in the mono camera's band Y.
struct TruthPoint {
  Vec3 p_mm, n;
};
struct TruthValue {
  double y, r, g, b;
};
/// Cells of a grid centred on the lamp. 0: ⌈lamp/spacing + window⌉, enough for every cell whose dual window touches the
/// lamp. More cells of the same parity add nothing; those of the other parity stand half a spacing aside, and so make
/// another projection.
struct TruthGrid {
  int columns = 0, rows = 0;
};
/// Irradiance by quadrature of the definition in double precision; refined until two levels agree to 1e-6 of the
/// largest. `projected`: of the lamp projected on the basis, continuous in s, with the cells of `grid`. Nothing for
/// options that check() refuses.
std::vector<TruthValue> truth(const WorldOptions& options, bool projected, std::span<const TruthPoint> points,
                              const TruthGrid& grid = {});

}  // namespace lumifield::virtual_bench
