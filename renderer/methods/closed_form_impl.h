#pragma once

#include <mutex>

#include "luminaire/basis.h"
#include "renderer/methods/axis_weights.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/horizon.h"
#include "renderer/methods/image_levels.h"

namespace lumifield {

/// What a ClosedForm holds: the cells with their levels of detail.
struct ClosedForm::Impl {
  struct Cell {
    CellIndex index;
    Vec2 u_mm;
    std::shared_ptr<const CellImage> image;
    std::vector<std::vector<ImageLevel>> means, deviations;  ///< by channel; empty where all is exact
    void make_deviations();
  };
  /// A level of detail of a cell's images, or what bounds its error.
  struct Values {
    const Cell& cell;
    int level;
    bool deviation;

    double at(int channel, int i, int j) const {
      if (level == 0) return deviation ? 0 : cell.image->at(channel, i, j);
      const auto& levels = (deviation ? cell.deviations : cell.means)[static_cast<std::size_t>(channel)];
      const ImageLevel& image = levels[static_cast<std::size_t>(level - 1)];
      return image
          .value[static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width_px) + static_cast<std::size_t>(i)];
    }
  };
  LuminaireGeometry geometry;
  Basis basis;
  double pixels_per_support;
  std::vector<Cell> cells;
  std::once_flag deviations_made;  ///< when a bound is first asked for

  int level(const Receiver& receiver) const;
  /// The pixels of a level that a cell's support shows on each axis.
  std::pair<AxisWeights, AxisWeights> axes(const Receiver& receiver, const Values& values) const;
  /// n·(u−p) over a cell's support.
  HorizonPlane plane(const Receiver& receiver, const Cell& cell) const;
  double factor(const Receiver& receiver) const;  ///< δ²a_x a_y/(δ+Δ)³
  std::vector<double> sum_of(const Receiver& receiver, bool deviation) const;
  std::vector<double> light_of(const Receiver& receiver, const Look& look, int division, bool deviation) const;
  void make_deviations();
  void add(const Receiver& receiver, const Values& values, std::vector<double>& sum) const;
  double weight(const HorizonPlane& g, const AxisWeights::Pixel& x, const AxisWeights::Pixel& y, bool above) const;
};

}  // namespace lumifield
