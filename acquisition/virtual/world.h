#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/virtual/photosites.h"
#include "acquisition/virtual/screen.h"
#include "luminaire/error.h"

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
  PassChange change = PassChange::stage;  ///< by_operator: at first the first pass' slide is in
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

  /// The bench as an operator would have measured and written it down; addresses and device paths are left empty.
  const Bench& bench() const { return bench_; }

  /// The stage is on its way to q: the image there is computed meanwhile. The last few positions are kept.
  void prepare(const Vec2& stage_mm);
  /// Waits until the image of this position is computed.
  void wait_ready(const Vec2& stage_mm) { wait(stage_mm); }

  /// DN of one frame, row-major, right-aligned in 16 bits. The noise is a hash of (seed, stage position in steps of 1
  /// µm, exposure, gain, pixel), so that a retake repeats it. At most 15 ms at 1024×768 once the position is ready;
  /// otherwise it waits for it. A region that reaches beyond the sensor reads 0 there.
  void expose(const Vec2& stage_mm, double exposure_s, double gain_db, int width_px, int height_px, int offset_x_px,
              int offset_y_px, std::span<std::uint16_t> dn);

  /// Knobs that act from the next image on, whatever the bench file says: noise 0|1, optics 0|1, filter 0|1 (0: no
  /// slide before the lamp), slide (0: the one with all passes; 1, 2: that with this pass alone), lamp_drift (relative
  /// change of the lamp per hour), lamp_warm_up (relative excess of its light when it is switched on, which is now; it
  /// fades with the time constant lamp_warm_up_s, 10 s at first).
  Status set(const std::string& knob, double value);

  /// The lamp's light now, 1 without drift and warm-up.
  double light();

 private:
  using Clock = std::chrono::steady_clock;
  /// What a noise-free image depends on. The stage is in steps of 1 µm.
  struct View {
    std::int64_t x_um, y_um;
    bool optics, filter;
    std::size_t slide;
    bool operator==(const View&) const = default;
  };
  /// Electrons per second of every pixel.
  using Frame = std::shared_ptr<const std::vector<float>>;

  explicit World(const WorldOptions& options);
  View view_of(const Vec2& stage_mm) const;
  Frame render(const View& view) const;
  void work(std::stop_token stop);
  Frame find(const View& view) const;
  void want(const View& view);
  std::pair<View, Frame> wait(const Vec2& stage_mm);

  const Lamp lamp_;
  const Bench bench_;
  const std::vector<Slide> slides_;  ///< with all passes, then with each alone
  const Slide no_slide_;
  const ScreenGrid grid_;
  const LensMap pinhole_, lens_;
  const Photosites photosites_;

  std::mutex mutex_;  // guards what follows, but the thread
  std::condition_variable_any changed_;
  std::deque<View> wanted_;
  std::deque<std::pair<View, Frame>> frames_;
  bool noise_, optics_, filter_ = true;
  std::size_t slide_;  ///< of slides_
  double drift_per_hour_ = 0, warm_up_ = 0, warm_up_s_ = 10;
  Clock::time_point drift_start_ = Clock::now(), switched_on_ = Clock::now();
  std::jthread worker_;  // the last, so that it ends before what it uses
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
