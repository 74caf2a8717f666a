#pragma once

#include <QWidget>
#include <memory>
#include <optional>

#include "app/session/live_preview.h"

class QAction;
class QCheckBox;
class QDoubleSpinBox;
class QSlider;
class QStackedWidget;

namespace lumifield {

class ValueSpinBox;

/// How the preview's picture is shown: its exposure and the average that the exposure counts from, or false colours and
/// the end of their scale. GUI thread.
class PreviewLookBar : public QWidget {
  Q_OBJECT

 public:
  /// 0 stops: PreviewLook's own exposure, which shows the average as a mid grey.
  static constexpr double most_stops = 8, stops_per_key = 0.5;

  explicit PreviewLookBar(QWidget* parent = nullptr);

  const PreviewLook& look() const { return look_; }
  void set_quantity(Quantity quantity);
  /// What the picture's own average and scale are.
  void set_frame(const PreviewFrame& frame);

  QAction* false_colour_action() const { return false_colour_; }
  QAction* hold_average_action() const { return hold_; }
  QAction* brighter_action() const { return brighter_; }
  QAction* darker_action() const { return darker_; }

 signals:
  void lookChanged(const lumifield::PreviewLook& look);

 private:
  QAction* make_action(const QString& text, const QString& tip, bool checkable);
  QWidget* make_exposure();
  QWidget* make_scale();
  void set_stops(double stops);
  void hold_average(bool hold);
  void fix_scale(bool fixed);
  void say_average();
  void tell(const PreviewLook& look);

  PreviewLook look_;
  std::optional<Quantity> quantity_;
  double average_ = 0;  ///< of the latest picture
  QAction *false_colour_, *hold_, *brighter_, *darker_;
  QStackedWidget* pages_;
  QSlider* slider_ = nullptr;
  QDoubleSpinBox* stops_ = nullptr;
  QCheckBox *hold_box_ = nullptr, *fixed_ = nullptr;
  ValueSpinBox* top_ = nullptr;
};

}  // namespace lumifield
