#include "app/views/elided_label.h"

#include <QPainter>

namespace lumifield {

ElidedLabel::ElidedLabel(QWidget* parent) : QFrame(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void ElidedLabel::set_text(const QString& text) {
  if (text_ == text) return;
  text_ = text;
  setToolTip(text);
  setAccessibleDescription(text);
  update();
}

QSize ElidedLabel::sizeHint() const { return {fontMetrics().averageCharWidth() * 40, fontMetrics().height() + 2}; }

QSize ElidedLabel::minimumSizeHint() const { return {0, sizeHint().height()}; }

void ElidedLabel::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.drawText(rect(), Qt::AlignLeft | Qt::AlignVCenter | Qt::TextSingleLine,
                   fontMetrics().elidedText(text_, Qt::ElideRight, width()));
}

}  // namespace lumifield
