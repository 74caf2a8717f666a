#pragma once

#include <memory>
#include <vector>

#include "renderer/methods/image_levels.h"
#include "renderer/methods/receiver_view.h"
#include "renderer/methods/sampled_cell.h"

namespace lumifield {

/// The light L(u→s) of single rays, as Σ over the cells whose support u lies in, averaged over a footprint where there
/// is one: a square on U of side w about u and what it shows of S, of side |r| w.
///
/// C_m is then looked up at the level of detail ½ log2 of the footprint's area over a pixel's, linearly between levels
/// and between the texels of those above 0, whose texels are the image's pixels. Φ_m covers a footprint of its spacing
/// as it is. Beyond it, an axis' φ is averaged over w′ = √(w² − a²): a box of side a and one of w′ have together the
/// spread of one of w, so that cells whose support the footprint reaches count by their share, and none is missed
/// between samples a footprint apart. C_m is then averaged over that part of the footprint alone which lies in a box as
/// broad as Φ_m (of the same second moment), since beyond it the product C Φ has none of this cell's light.
///
/// Geometry is that of the point where C_m is averaged, times the solid angle that U shows there over that where the
/// ray leaves it: averages are over solid angle, and keep a cell's light. w is at most half the ray's length, since
/// beyond it squares on U are no image of a solid angle.
///
/// Value type; safe from any thread.
class RayLight {
 public:
  /// with_levels: footprints may be given.
  RayLight(const LightField& light_field, bool with_levels);

  const LuminaireGeometry& geometry() const { return geometry_; }
  const Basis& basis() const { return basis_; }
  bool empty() const { return cells_.empty(); }

  /// One cell's part of a ray's light.
  struct Part {
    std::uint32_t number;       ///< of the cell, Sampling::flat
    double factor;              ///< Φ_m δ²/cos⁴θ, averaged, times what is seen of it
    std::vector<double> value;  ///< C_m by channel, averaged
  };
  /// Calls visit(part) for each cell that the ray or its footprint meets. width_mm: w, 0 for a single ray.
  template <class Visit>
  void over_parts(const ReceiverView& view, const Vec2& u_mm, double width_mm, const Visit& visit) const;

  /// L by channel, in the luminaire's unit.
  std::vector<double> radiance(const ReceiverView& view, const Vec2& u_mm, double width_mm) const;

 private:
  struct Cell {
    MeasuredCell image;
    std::vector<std::vector<ImageLevel>> levels;  ///< by channel, from level 1
  };
  /// One axis of a footprint in one cell.
  struct Reach {
    double phi;
    double center_mm, size_mm;  ///< of C's average, on U
  };
  Reach reach(int axis, double u_mm, double u_m_mm, double width_mm) const;
  /// w as it counts.
  static double width(const ReceiverView& view, const Vec2& u_mm, double width_mm);
  void part(const ReceiverView& view, const Cell& cell, const Vec2& u_mm, double width_mm, Part& part) const;
  double value(const Cell& cell, std::size_t channel, const Vec2& on_s_px, double level) const;
  double texel(const Cell& cell, std::size_t channel, const Vec2& on_s_px, int level) const;
  /// Cells on an axis that a footprint about u meets: the first, and the end.
  struct Range {
    int first, end;
  };
  Range range(int axis, double u_mm, double width_mm) const;
  double widened_by(int axis, double width_mm) const;

  LuminaireGeometry geometry_;
  Basis basis_;
  double half_box_;  ///< half the side of the box as broad as φ, in spacings
  std::vector<Cell> cells_;
  std::vector<int> by_number_;  ///< of a cell of the grid its place in cells_, −1 where unmeasured
};

/// Half the side of the box of φ's second moment, in spacings.
double half_box_of(const Basis& basis);

template <class Visit>
void RayLight::over_parts(const ReceiverView& view, const Vec2& u_mm, double width, const Visit& visit) const {
  const double width_mm = RayLight::width(view, u_mm, width);
  const Range columns = range(0, u_mm.x(), width_mm), rows = range(1, u_mm.y(), width_mm);
  Part one;
  for (int row = rows.first; row < rows.end; ++row)
    for (int column = columns.first; column < columns.end; ++column) {
      const int number = geometry_.sampling.flat({row, column});
      const int at = by_number_[static_cast<std::size_t>(number)];
      if (at < 0) continue;
      part(view, cells_[static_cast<std::size_t>(at)], u_mm, width_mm, one);
      visit(one);
    }
}

}  // namespace lumifield
