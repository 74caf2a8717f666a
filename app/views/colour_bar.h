#pragma once

#include <QString>
#include <QWidget>

#include "app/views/value_scale.h"

namespace lumifield {

/// What the colours of a picture mean: a bar with ticks, the name of the values and their unit. GUI thread.
class ColourBar : public QWidget {
  Q_OBJECT

 public:
  explicit ColourBar(QWidget* parent = nullptr);
  void set_scale(const ValueScale& scale, const QString& name, const QString& unit);
  const ValueScale& scale() const { return scale_; }

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  QRectF bar_rect() const;
  void paint_ticks(QPainter& painter) const;

  ValueScale scale_;
  QString title_;
};

}  // namespace lumifield
