#include "app/views/stability_model.h"

#include <QTextDocument>
#include <algorithm>
#include <cmath>
#include <map>

#include "app/views/signal_colours.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {

/// Tints the base so that text on it stays legible.
QColor tint(const QColor& base, const QColor& colour) {
  constexpr double share = 0.18;
  const auto mix = [&](int x, int y) { return static_cast<int>(std::lround(x + share * (y - x))); };
  return {mix(base.red(), colour.red()), mix(base.green(), colour.green()), mix(base.blue(), colour.blue())};
}

QColor colour_of(StabilityOutcome outcome, const QPalette& palette) {
  switch (outcome) {
    case StabilityOutcome::ok:
      return good_colour(palette);
    case StabilityOutcome::refused:
      return warning_colour(palette);
    case StabilityOutcome::failed:
      break;
  }
  return fault_colour(palette);
}

QString text_of(std::string_view text) { return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size())); }

QString cell_text(const StabilityRow& row) {
  const QString outcome = text_of(to_string(row.outcome));
  return std::isfinite(row.rel_error) ? outcome + "  " + value_text(row.rel_error, 2) : outcome;
}

QString tooltip_of(const StabilityRow& row) {
  QString text = QString("%1, %2: %3")
                     .arg(text_of(to_string(row.method)), text_of(row.case_name), text_of(to_string(row.outcome)));
  if (std::isfinite(row.rel_error))
    text += QString("\nlargest error: %1 of Σ∫|C Φ| max(0, ·)").arg(value_text(row.rel_error));
  if (!row.reason.empty()) text += "\n" + text_of(row.reason);
  return Qt::convertFromPlainText(text, Qt::WhiteSpaceNormal);
}

}  // namespace

void StabilityModel::set_rows(const std::vector<StabilityRow>& rows) {
  beginResetModel();
  rows_ = rows;
  cases_.clear();
  methods_.clear();
  std::map<std::string_view, std::size_t> downs;
  std::map<Method, std::size_t> acrosses;
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (const StabilityRow& row : rows_) {
    const auto [down, new_case] = downs.emplace(row.case_name, cases_.size());
    const auto [across, new_method] = acrosses.emplace(row.method, methods_.size());
    if (new_case) cases_.push_back(text_of(row.case_name));
    if (new_method) methods_.push_back(row.method);
    places.emplace_back(down->second, across->second);
  }
  cells_.assign(cases_.size() * methods_.size(), -1);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    int& cell = cells_[places[k].first * methods_.size() + places[k].second];
    if (cell < 0 || rows_[k].outcome > rows_[static_cast<std::size_t>(cell)].outcome) cell = static_cast<int>(k);
  }
  endResetModel();
}

void StabilityModel::set_palette(const QPalette& palette) {
  palette_ = palette;
  if (!cells_.empty()) emit dataChanged(index(0, 0), index(rowCount() - 1, columnCount() - 1));
}

int StabilityModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(cases_.size());
}

int StabilityModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(methods_.size());
}

const StabilityRow* StabilityModel::at(const QModelIndex& index) const {
  const int row =
      cells_[static_cast<std::size_t>(index.row()) * methods_.size() + static_cast<std::size_t>(index.column())];
  return row < 0 ? nullptr : &rows_[static_cast<std::size_t>(row)];
}

QVariant StabilityModel::data(const QModelIndex& index, int role) const {
  if (!checkIndex(index, CheckIndexOption::IndexIsValid)) return {};
  const StabilityRow* row = at(index);
  if (!row) return role == Qt::DisplayRole ? QVariant(QString("not tried")) : QVariant();
  switch (role) {
    case Qt::DisplayRole:
      return cell_text(*row);
    case Qt::ToolTipRole:
      return tooltip_of(*row);
    case Qt::AccessibleDescriptionRole:
      return text_of(row->reason);
    case Qt::BackgroundRole:
      return tint(palette_.color(QPalette::Base), colour_of(row->outcome, palette_));
    case Qt::ForegroundRole:
      return palette_.color(QPalette::Text);
    default:
      return {};
  }
}

QVariant StabilityModel::headerData(int section, Qt::Orientation orientation, int role) const {
  const bool down = orientation == Qt::Vertical;
  if (section < 0 || section >= (down ? rowCount() : columnCount())) return {};
  const auto place = static_cast<std::size_t>(section);
  if (down && role == Qt::DisplayRole) return cases_[place];
  if (down) return role == Qt::ToolTipRole ? QVariant(cases_[place].toHtmlEscaped()) : QVariant();
  if (role == Qt::DisplayRole) return text_of(to_string(methods_[place]));
  return role == Qt::ToolTipRole ? QVariant(text_of(info(methods_[place]).what)) : QVariant();
}

}  // namespace lumifield
