#pragma once

#include <vector>

#include "luminaire/bench.h"

namespace lumifield::virtual_bench {

/// The filter slide: the passes of a bench printed side by side, opaque elsewhere. The pass with scale +k⁺ transmits
/// T⁺ = max(Φ′, 0)/k⁺, that with −k⁻ T⁻ = max(−Φ′, 0)/k⁻, Φ′(x, y) = f(x) f(y). With f = f⁺ − f⁻ both are sums of
/// products: k⁺T⁺ = f⁺f⁺ + f⁻f⁻ and k⁻T⁻ = f⁺f⁻ + f⁻f⁺. Immutable, safe from any thread.
class Slide {
 public:
  explicit Slide(const FilterSlide& filter);
  /// No slide: all light passes, in one pass.
  static Slide none(const FilterSlide& filter);
  /// The slide that has this pass alone.
  static Slide of_pass(const FilterSlide& filter, std::size_t pass);

  /// An interval, in spacings from the filter's centre, on which f keeps its sign and is one polynomial.
  struct Piece {
    double begin, end;
    bool positive;
  };
  const std::vector<Piece>& pieces() const { return pieces_; }
  double f(double x) const { return taken_out_ ? 1 : dual_(x); }
  const FilterSlide& filter() const { return filter_; }

  /// Transmission of a pass' filter at `offset` mm from its centre.
  double transmission(const FilterPass& pass, const Vec2& offset_mm) const;

 private:
  FilterSlide filter_;
  Dual dual_;
  bool taken_out_ = false;
  std::vector<Piece> pieces_;
};

/// Where the centre of a pass' filter stands in the lamp's frame, mm on U, at a stage reading q. Carrying the slide it
/// is A(q − offset) + b; carrying the lamp the filters are fixed at A·offset in the bench frame, and the lamp is
/// displaced.
Vec2 filter_center_mm(const Bench& bench, const FilterPass& pass, const Vec2& stage_mm);

/// The lamp's displacement in the bench frame: A q + b where the stage carries the lamp, else 0.
Vec2 displacement_mm(const Bench& bench, const Vec2& stage_mm);

/// ⌈lamp/spacing + window⌉ cells, centred on the lamp, hold every cell whose dual window touches it.
int cells_needed(double lamp_mm, double spacing_mm, int window);

/// From the axis to the centre of the outermost of those cells, mm.
Vec2 half_grid_mm(const Bench& bench);

/// Lays out slide and stage: passes and opaque patch far enough apart that only one filter stands before the lamp
/// (offset ≥ half grid + half lamp + half window), the stage's frame, and limits that fit. Where the operator changes
/// the slide, all passes stand in one place. Needs lamp_size_mm and the filter's basis, spacing, window and change;
/// sets its passes, dark offset, stage_to_luminaire and limits.
void lay_out_slide(Bench& bench);

}  // namespace lumifield::virtual_bench
