#include "app/views/notice_delegate.h"

#include <QApplication>
#include <QDateTime>
#include <QListView>
#include <QPainter>
#include <QTextLayout>
#include <cmath>

#include "app/views/level_mark.h"
#include "app/views/notices_model.h"

namespace lumifield {

namespace {

constexpr int margin = 4;

/// Breaks the text into lines of at most `width`, between words where there are any. Its height.
int lay_out(QTextLayout& layout, int width) {
  QTextOption wrapping;
  wrapping.setWrapMode(QTextOption::WrapAtWordBoundaryOrAnywhere);
  layout.setTextOption(wrapping);
  layout.beginLayout();
  double y = 0;
  for (QTextLine line = layout.createLine(); line.isValid(); line = layout.createLine()) {
    line.setLineWidth(width);
    line.setPosition({0, y});
    y += line.height();
  }
  layout.endLayout();
  return static_cast<int>(std::ceil(y));
}

int head_width(const QFontMetrics& metrics) {
  return metrics.height() + 3 * margin + metrics.horizontalAdvance("00:00:00") + 2 * margin;
}

int text_width(int row_width, const QFontMetrics& metrics) {
  return std::max(50, row_width - head_width(metrics) - margin);
}

int list_width(const QStyleOptionViewItem& option) {
  const auto* list = qobject_cast<const QListView*>(option.widget);
  return list ? list->viewport()->width() : option.rect.width();
}

QString badge(const QModelIndex& index) {
  const int times = index.data(NoticesModel::times_role).toInt();
  return times > 1 ? QString("× %1").arg(times) : QString();
}

}  // namespace

int NoticeDelegate::text_height(const QFont& font, const QString& text, int width) const {
  if (width != width_ || font != font_ || heights_.size() > 2 * NoticesModel::most_notices) {
    heights_.clear();
    width_ = width;
    font_ = font;
  }
  int& height = heights_[text];
  if (height == 0) {
    QTextLayout layout(text, font);
    height = lay_out(layout, width);
  }
  return height;
}

QSize NoticeDelegate::sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const {
  const QFontMetrics& metrics = option.fontMetrics;
  const int width = list_width(option);
  const int text = text_height(option.font, index.data().toString(), text_width(width, metrics));
  // The count stands below the time.
  const int lines = badge(index).isEmpty() ? 1 : 2;
  return {width, std::max(text, lines * metrics.height()) + 2 * margin};
}

void NoticeDelegate::paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const {
  QStyleOptionViewItem row = option;
  const QWidget* widget = row.widget;
  (widget ? widget->style() : QApplication::style())
      ->drawPrimitive(QStyle::PE_PanelItemViewItem, &row, painter, widget);
  const bool selected = row.state & QStyle::State_Selected;
  const QRect inner = row.rect.adjusted(margin, margin, -margin, -margin);
  const int line = row.fontMetrics.height(), head = head_width(row.fontMetrics);

  QPalette palette = row.palette;
  if (selected) palette.setColor(QPalette::Base, palette.color(QPalette::Highlight));
  const auto level = static_cast<OperatorNotice::Level>(index.data(NoticesModel::level_role).toInt());
  paint_level_mark(*painter, QRectF(inner.left(), inner.top(), line, line), level, palette);

  painter->save();
  painter->setFont(row.font);
  painter->setPen(palette.color(selected ? QPalette::HighlightedText : QPalette::Text));
  const QRect time(inner.left() + line + 2 * margin, inner.top(), head - line - 4 * margin, line);
  painter->drawText(time, Qt::AlignLeft, index.data(NoticesModel::time_role).toDateTime().toString("HH:mm:ss"));
  painter->drawText(time.translated(0, line), Qt::AlignLeft, badge(index));
  QTextLayout text(index.data().toString(), row.font);
  lay_out(text, text_width(row.rect.width(), row.fontMetrics));
  text.draw(painter, QPointF(row.rect.left() + head, inner.top()));
  painter->restore();
}

}  // namespace lumifield
