#include "app/views/cell_figures.h"

#include <QCoreApplication>
#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "app/views/cell_marks.h"
#include "app/views/value_text.h"
#include "renderer/shift_invariant/constant_distance_error.h"

namespace lumifield {

namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

QString tr(const char* text) { return QCoreApplication::translate("CellFigures", text); }

double quality_value(CellFigure figure, const Quality& quality) {
  switch (figure) {
    case CellFigure::saturated:
      return 100 * quality.saturated_share;
    case CellFigure::starved:
      return 100 * quality.starved_share;
    case CellFigure::snr:
      return quality.median_snr;
    case CellFigure::position:
      return quality.position_error_mm;
    case CellFigure::drift:
      return 100 * quality.drift;
    case CellFigure::dark:
      return quality.dark_dn;
    case CellFigure::neighbours:
    case CellFigure::total:
    case CellFigure::constant_distance:
      break;
  }
  return not_known;
}

/// "0.5, 2 ms".
QString exposures_text(const std::vector<double>& exposures_s) {
  QStringList texts;
  for (const double exposure_s : exposures_s) texts << value_text(1000 * exposure_s);
  return texts.join(QStringLiteral(", ")) + " ms";
}

/// The same planes, grid and images' place and size.
bool same_planes(const LuminaireGeometry& a, const LuminaireGeometry& b) {
  const auto grid = [](const Sampling& s) {
    return std::tuple(s.basis, s.columns, s.rows, s.spacing_mm.x(), s.spacing_mm.y(), s.center_mm.x(), s.center_mm.y());
  };
  const auto images = [](const Measurement& m) {
    return std::tuple(m.width_px, m.height_px, m.pixel_mm.x(), m.pixel_mm.y(), m.center_mm.x(), m.center_mm.y());
  };
  return a.planes == b.planes && grid(a.sampling) == grid(b.sampling) && images(a.measurement) == images(b.measurement);
}

}  // namespace

QString figure_name(CellFigure figure) {
  switch (figure) {
    case CellFigure::saturated:
      return tr("Saturated share");
    case CellFigure::starved:
      return tr("Starved share");
    case CellFigure::snr:
      return tr("Median SNR");
    case CellFigure::position:
      return tr("Position error");
    case CellFigure::drift:
      return tr("Drift");
    case CellFigure::dark:
      return tr("Dark level");
    case CellFigure::neighbours:
      return tr("Neighbour difference");
    case CellFigure::total:
      return tr("Total light");
    case CellFigure::constant_distance:
      return tr("Constant-distance error");
  }
  return {};
}

QString figure_meaning(CellFigure figure) {
  switch (figure) {
    case CellFigure::saturated:
      return tr("Pixels of S without any unsaturated exposure, in %");
    case CellFigure::starved:
      return tr("Pixels of S whose longest exposure lies within the read noise, in %");
    case CellFigure::snr:
      return tr("Median over the lit pixels of value over standard deviation, a plain number");
    case CellFigure::position:
      return tr("Commanded against read-back stage position, worst pass, in mm");
    case CellFigure::drift:
      return tr("Change of the reference cell since the scan began, in %");
    case CellFigure::dark:
      return tr("Mean of the dark set subtracted, longest exposure, in DN");
    case CellFigure::neighbours:
      return tr("Difference from the mean of the measured cells beside, above and below: 0 alike, 1 nothing in common");
    case CellFigure::total:
      return tr("Sum of C times the pixel's area over all pixels and channels");
    case CellFigure::constant_distance:
      return tr(
          "Not of the measurement: it follows from the slide and the planes alone. How far off a cell would be at "
          "most, "
          "were it one spotlight with one distance for all of it, in % (Er(θ0), Granier 2003). The measurement is "
          "untouched, and so are the methods here: shift-invariant takes each receiver's own distance");
  }
  return {};
}

QString figure_unit(CellFigure figure, Quantity quantity) {
  switch (figure) {
    case CellFigure::saturated:
    case CellFigure::starved:
    case CellFigure::drift:
    case CellFigure::constant_distance:
      return QStringLiteral("%");
    case CellFigure::position:
      return QStringLiteral("mm");
    case CellFigure::dark:
      return QStringLiteral("DN");
    case CellFigure::total:
      return unit_text(unit_of(quantity));
    case CellFigure::snr:
    case CellFigure::neighbours:
      break;
  }
  return {};
}

ImageFigures figures_of(const CellImage& image) {
  ImageFigures figures;
  for (int c = 0; c < image.channels; ++c) {
    const float* from = image.channel(c);
    float largest = -std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < image.plane(); ++k) {
      figures.sum += static_cast<double>(from[k]);
      largest = std::max(largest, from[k]);
    }
    figures.largest.push_back(largest);
  }
  return figures;
}

const ImageFigures& CellFigures::look_at(CellIndex cell) const {
  const std::shared_ptr<const CellImage>& image = model_.cell(cell)->image;
  Looked& looked = looked_[cell];
  if (looked.image != image) looked = {image, figures_of(*image)};
  return looked.figures;
}

double CellFigures::constant_distance(CellIndex cell) const {
  const LuminaireGeometry& geometry = *model_.geometry();
  if (!errors_of_ || !same_planes(*errors_of_, geometry)) {
    errors_.clear();
    errors_of_ = geometry;
  }
  const auto [error, fresh] = errors_.try_emplace(cell, not_known);
  if (fresh) error->second = largest_constant_distance_error(geometry, cell);
  return error->second;
}

double CellFigures::value(CellFigure figure, CellIndex cell) const {
  const LuminaireModel::Cell* known = model_.cell(cell);
  if (!known || !model_.geometry()) return not_known;
  if (figure == CellFigure::neighbours) return known->neighbour_difference;
  if (figure == CellFigure::constant_distance) return 100 * constant_distance(cell);
  if (figure == CellFigure::total) return look_at(cell).sum * model_.geometry()->measurement.pixel_mm.prod();
  return known->entry.quality ? quality_value(figure, *known->entry.quality) : not_known;
}

QString CellFigures::text(CellFigure figure, CellIndex cell) const {
  const double number = value(figure, cell);
  const QString unit = model_.geometry() ? figure_unit(figure, model_.geometry()->quantity) : QString();
  return std::isnan(number) || unit.isEmpty() ? value_text(number) : value_text(number) + u' ' + unit;
}

ValueScale CellFigures::scale(CellFigure figure) const {
  double least = 0, largest = 0;
  for (int k = 0; k < model_.total(); ++k) {
    const double number = value(figure, model_.geometry()->sampling.index(k));
    if (!std::isfinite(number)) continue;
    least = std::min(least, number);
    largest = std::max(largest, number);
  }
  if (figure == CellFigure::drift) largest = std::max(largest, -least);
  const bool empty = !(largest > 0) && !(least < 0);
  return {figure == CellFigure::drift ? -largest : least, empty ? 1 : largest};
}

double CellFigures::largest(int channel) const {
  double largest = 0;
  for (int k = 0; k < model_.total(); ++k) {
    const CellIndex at = model_.geometry()->sampling.index(k);
    if (model_.cell(at)) largest = std::max(largest, double(look_at(at).largest.at(static_cast<std::size_t>(channel))));
  }
  return largest;
}

QString CellFigures::geometry_note(CellIndex cell) const {
  if (!(value(CellFigure::constant_distance, cell) > wide_basis_percent)) return {};
  return tr("Constant-distance error above %1 %: of the slide and the planes alone; the measurement and the methods "
            "here "
            "are untouched")
      .arg(value_text(wide_basis_percent));
}

QString CellFigures::summary(CellIndex cell) const {
  if (!model_.geometry() || !model_.geometry()->sampling.contains(cell)) return {};
  const Vec2 center = model_.geometry()->sampling.cell_center_mm(cell);
  QString text = tr("Cell (row %1, column %2), centre (%3, %4) mm on U")
                     .arg(cell.row)
                     .arg(cell.column)
                     .arg(value_text(center.x(), 5), value_text(center.y(), 5));
  text += u'\n' + state_name(model_.state(cell));
  if (const QString why = model_.damage(cell); !why.isEmpty()) text += QStringLiteral(": ") + why;
  const LuminaireModel::Cell* known = model_.cell(cell);
  if (!known) return text;
  text += tr(", generation %1").arg(known->entry.generation);
  for (const CellFigure figure : all_cell_figures)
    text += QStringLiteral("\n%1: %2").arg(figure_name(figure), this->text(figure, cell));
  if (const QString note = geometry_note(cell); !note.isEmpty()) text += u'\n' + note;
  if (!known->entry.quality) return text;
  for (const auto& [pass, exposures_s] : known->entry.quality->exposures_s)
    text +=
        u'\n' + tr("Exposures of pass %1, adapted: %2").arg(QString::fromStdString(pass), exposures_text(exposures_s));
  for (const std::string& warning : known->entry.quality->warnings)
    text += u'\n' + tr("Warning: %1").arg(QString::fromStdString(warning));
  return text;
}

}  // namespace lumifield
