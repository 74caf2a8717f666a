#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "luminaire/basis.h"
#include "luminaire/error.h"
#include "luminaire/geometry.h"

namespace lumifield {

/// The light field luminaire of Granier et al. 2003 / Goesele et al. 2003, in the luminaire frame: right-handed,
/// millimetres, light travels towards +z; plane U (grid of cells) is z = 0, plane S (images) is z = δ > 0.
///
///     L(u→s) = Σ_m C_m(s) Φ_m(u) δ²/cos⁴θ
///
/// C_m is piecewise constant on the half-open pixels of S, zero (unmeasured) outside the image, and may be negative.

/// Planes U (z = 0) and S (z = separation_mm = δ).
struct TwoPlaneParameterization {
  double separation_mm = 0;
  bool operator==(const TwoPlaneParameterization&) const = default;
};

struct CellIndex {
  int row = 0, column = 0;
  auto operator<=>(const CellIndex&) const = default;
};
std::string to_string(CellIndex cell);  ///< "(row, column)"

/// The grid of cells on U.
struct Sampling {
  BasisKind basis = BasisKind::bell;
  Vec2 spacing_mm{0, 0};
  int columns = 0, rows = 0;
  Vec2 center_mm{0, 0};

  int cells() const { return columns * rows; }
  bool contains(CellIndex c) const { return c.row >= 0 && c.row < rows && c.column >= 0 && c.column < columns; }
  /// Row-major, 0 … cells() − 1.
  int flat(CellIndex c) const { return c.row * columns + c.column; }
  CellIndex index(int flat) const { return {flat / columns, flat % columns}; }
  /// u_m, mm on U: column along +x, row along +y.
  Vec2 cell_center_mm(CellIndex c) const {
    return center_mm +
           Vec2((c.column - (columns - 1) / 2.0) * spacing_mm.x(), (c.row - (rows - 1) / 2.0) * spacing_mm.y());
  }
};

/// The pixel grid of the images on S: pixel (i, j), i along +x, j along +y, j = 0 the first scanline.
struct Measurement {
  int width_px = 0, height_px = 0;
  Vec2 pixel_mm{0, 0};
  Vec2 center_mm{0, 0};

  /// Edge of pixel (0, 0) towards −x, −y: pixel (i, j) is [corner + (i, j)·pixel, corner + (i+1, j+1)·pixel).
  Vec2 corner_mm() const { return center_mm - Vec2(width_px * pixel_mm.x(), height_px * pixel_mm.y()) / 2; }
  Vec2 pixel_center_mm(int i, int j) const {
    return corner_mm() + Vec2((i + 0.5) * pixel_mm.x(), (j + 0.5) * pixel_mm.y());
  }
  std::size_t pixels() const { return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px); }
};

/// Quantity of L: radiance W/(m² sr), luminance cd/m², or a quantity on an unknown absolute scale.
enum class Quantity { radiance, luminance, relative };
std::string_view to_string(Quantity q);           ///< "radiance", "luminance", "relative"
std::string_view unit_of(Quantity q);             ///< "W/(m^2 sr)", "cd/m^2", "relative"
std::string_view irradiance_unit_of(Quantity q);  ///< of E: "W/m^2", "lx", "relative"

/// Everything about a luminaire but its cells.
struct LuminaireGeometry {
  TwoPlaneParameterization planes;
  Sampling sampling;
  Measurement measurement;
  std::vector<std::string> channels;  ///< {"Y"} or {"R","G","B"} in the camera's primaries
  Quantity quantity = Quantity::relative;
};

/// How good one cell is. Shares are 0 … 1; NaN = not determined.
struct Quality {
  double saturated_share = 0;         ///< pixels of S without any unsaturated exposure
  double starved_share = 0;           ///< pixels of S whose longest exposure lies within the read noise
  double median_snr = 0;              ///< of value/σ over lit pixels (calibration/quality.h); NaN = a dark cell
  double position_error_mm = 0;       ///< commanded against read-back stage position, worst pass
  double drift = 0;                   ///< relative change of the reference cell since the scan began
  double dark_dn = 0;                 ///< mean of the dark set subtracted, longest exposure, DN
  std::vector<std::string> warnings;  ///< the plan's limits that this cell breaks, in words
  /// As the camera reports them, of each pass by its name that took others than the plan's; empty: none did.
  std::map<std::string, std::vector<double>> exposures_s;
};

/// C_m of one cell: planar float32, L-units per mm², channel by channel, j = 0 first. Moved, never shared while
/// written.
struct CellImage {
  int width_px = 0, height_px = 0, channels = 0;
  std::vector<float> value;     ///< channels · height · width
  std::vector<float> variance;  ///< same layout, (L-units/mm²)²; empty = unknown
  Quality quality;

  std::size_t plane() const { return static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px); }
  const float* channel(int c) const { return value.data() + static_cast<std::size_t>(c) * plane(); }
  float* channel(int c) { return value.data() + static_cast<std::size_t>(c) * plane(); }
  float at(int c, int i, int j) const {
    return channel(c)[static_cast<std::size_t>(j) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(i)];
  }
};

/// Refuses, naming channel and pixel: another size or number of channels than the luminaire's, NaN, Inf, a negative
/// variance. `where` stands for the image in messages.
Status check_image(const LuminaireGeometry& geometry, const CellImage& image, std::string_view where);
/// Also refuses an index outside the grid.
Status check_cell(const LuminaireGeometry& geometry, CellIndex cell, const CellImage& image);

/// How much of the luminaire has been measured.
struct Coverage {
  int measured = 0, total = 0;
  std::vector<CellIndex> missing;
  bool complete() const { return measured == total; }
};

/// The measured luminaire in memory. Cells are appended; a retake appends the next generation of its cell, and the last
/// one counts. Absent cells are unmeasured, not black. Thread-bound; the cell images it hands out are immutable and may
/// be kept and read from any thread.
class LightField {
 public:
  explicit LightField(LuminaireGeometry geometry);

  const LuminaireGeometry& geometry() const { return geometry_; }

  /// Errors: those of check_cell.
  Status add(CellIndex cell, CellImage image);
  Status add(CellIndex cell, std::shared_ptr<const CellImage> image);

  /// The latest image of a cell, null while unmeasured.
  std::shared_ptr<const CellImage> cell(CellIndex cell) const;
  Coverage coverage() const;

 private:
  LuminaireGeometry geometry_;
  std::vector<std::shared_ptr<const CellImage>> cells_;
};

}  // namespace lumifield
