#pragma once

#include <array>

namespace lumifield {

/// How finely a picture is made. Value type.
struct PreviewDetail {
  int divisor = 1;  ///< of width and height
  double lod = 0;   ///< level of detail T, 0 exact
  bool full() const { return divisor == 1 && lod == 0; }
  bool operator==(const PreviewDetail&) const = default;
};

/// What a picture takes, learned from those made: pixels · (drawing and showing + cells · summing). Coarse and full
/// ones apart, since small pictures pay more for each pixel. Thread-bound.
class PreviewCosts {
 public:
  void drawn(PreviewDetail detail, double pixels, double seconds);
  void summed(PreviewDetail detail, double pixels, int cells, double seconds);
  void shown(PreviewDetail detail, double pixels, double seconds);

  /// `pixels` of the picture as it is made, divisor applied.
  double picture_s(PreviewDetail detail, double pixels, int cells) const;
  double cell_s(PreviewDetail detail, double pixels) const;

  /// The finest that takes no longer than `seconds`, or the coarsest there is. `before` is kept while it nearly fits.
  PreviewDetail finest_within(double seconds, double full_pixels, int cells, PreviewDetail before) const;

 private:
  struct Rates {
    double draw, sum, show;  ///< seconds for each pixel; sum: and cell
  };
  /// Two cores with PoCL and llvmpipe, until measured. Coarse, full.
  std::array<Rates, 2> rates_{Rates{2e-7, 1e-7, 2e-8}, Rates{2e-7, 1e-7, 2e-8}};
  const Rates& of(PreviewDetail detail) const { return rates_[detail.full() ? 1 : 0]; }
};

/// Whether cells that wait for a full picture are to be shown coarsely first. That costs the full one all its cells
/// again, so they must be many: as from a dataset that is opened, not from a scan on a slow machine.
bool shows_coarsely_first(int waiting, int cells, double cell_s);

}  // namespace lumifield
