#pragma once

#include <QWidget>
#include <optional>
#include <vector>

#include "luminaire/bench.h"

namespace lumifield {

/// The stage's travel, x to the right and y upwards, with its reading as a dot and the cells' places. The tooltip tells
/// the numbers. GUI thread.
class StageMap : public QWidget {
  Q_OBJECT

 public:
  explicit StageMap(QWidget* parent = nullptr);

  void set_limits(const StageLimits& limits);
  /// Stage readings of the cells, first pass.
  void set_targets(std::vector<Vec2> stage_mm);
  void set_position(const std::optional<Vec2>& stage_mm);

  /// Where a stage reading is painted. Limits are set.
  QPointF point_of(const Vec2& stage_mm) const;
  /// "x 12.500 mm, y −3.250 mm", and that it lies outside the limits.
  QString position_text() const;
  bool outside() const;

  QSize sizeHint() const override { return {120, 96}; }
  QSize minimumSizeHint() const override { return {90, 70}; }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  QRectF travel_rect() const;
  bool has_limits() const;
  void describe();

  StageLimits limits_;
  std::vector<Vec2> targets_;
  std::optional<Vec2> position_;
};

}  // namespace lumifield
