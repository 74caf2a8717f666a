#pragma once

#include <QString>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "app/views/luminaire_model.h"
#include "app/views/value_scale.h"

namespace lumifield {

/// The figures that say how good a cell is; the last is none of the measurement: it follows from slide and planes.
enum class CellFigure { saturated, starved, snr, position, drift, dark, neighbours, total, constant_distance };
inline constexpr std::array all_cell_figures{
    CellFigure::saturated, CellFigure::starved,    CellFigure::snr,   CellFigure::position,         CellFigure::drift,
    CellFigure::dark,      CellFigure::neighbours, CellFigure::total, CellFigure::constant_distance};
/// Of constant_distance, in percent: from here on the cell is told to be too wide for one distance.
inline constexpr double wide_basis_percent = 8;

/// "Saturated share"; what it is, in a sentence; its unit as shown, "" for a plain number.
QString figure_name(CellFigure figure);
QString figure_meaning(CellFigure figure);
QString figure_unit(CellFigure figure, Quantity quantity);

/// What one look through an image's pixels tells.
struct ImageFigures {
  double sum = 0;              ///< over all channels and pixels, L-units per mm²
  std::vector<float> largest;  ///< of each channel
};
ImageFigures figures_of(const CellImage& image);

/// Figures of a luminaire's cells, in the units shown. Images are looked through once, and what is of the geometry
/// alone is computed once. GUI thread.
class CellFigures {
 public:
  explicit CellFigures(const LuminaireModel& model) : model_(model) {}
  /// After another luminaire came: lets its images go.
  void forget() {
    looked_.clear();
    errors_.clear();
  }

  /// NaN: not measured or not determined.
  double value(CellFigure figure, CellIndex cell) const;
  /// "0.12 %"; "not known".
  QString text(CellFigure figure, CellIndex cell) const;
  /// Ends over all measured cells: from 0, or the same to both sides where values have a sign.
  ValueScale scale(CellFigure figure) const;
  /// Of a measured cell's image; valid until the cell changes.
  const ImageFigures& look_at(CellIndex cell) const;
  /// Largest value of a channel over all measured cells, L-units per mm²; 0 when none is positive.
  double largest(int channel) const;
  /// What is to be said of a cell that is too wide for one distance; empty of others.
  QString geometry_note(CellIndex cell) const;
  /// Everything known about a cell, line by line.
  QString summary(CellIndex cell) const;

 private:
  double constant_distance(CellIndex cell) const;

  const LuminaireModel& model_;
  struct Looked {
    std::shared_ptr<const CellImage> image;
    ImageFigures figures;
  };
  mutable std::map<CellIndex, Looked> looked_;
  mutable std::map<CellIndex, double> errors_;            ///< Er, some 0.1 ms a cell
  mutable std::optional<LuminaireGeometry> errors_of_{};  ///< the luminaire that they are of
};

}  // namespace lumifield
