#pragma once

#include <QAbstractTableModel>
#include <QPalette>
#include <vector>

#include "renderer/study/study.h"

namespace lumifield {

/// The stability table of a study: a row for each case, a column for each method, both in the study's order. A cell
/// tells the outcome in words and in colour, with the error; its tooltip the reason. Of several outcomes of one cell
/// the worst shows. GUI thread.
class StabilityModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  explicit StabilityModel(QObject* parent = nullptr) : QAbstractTableModel(parent) {}

  void set_rows(const std::vector<StabilityRow>& rows);
  /// The colours that cells stand out from.
  void set_palette(const QPalette& palette);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role = Qt::DisplayRole) const override;

 private:
  /// Null: not tried.
  const StabilityRow* at(const QModelIndex& index) const;

  std::vector<StabilityRow> rows_;
  std::vector<QString> cases_;
  std::vector<Method> methods_;
  std::vector<int> cells_;  ///< rows_ of each cell, case by case; −1: none
  QPalette palette_;
};

}  // namespace lumifield
