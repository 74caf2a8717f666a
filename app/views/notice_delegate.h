#pragma once

#include <QFont>
#include <QHash>
#include <QStyledItemDelegate>

namespace lumifield {

/// One notice: level's mark, time, how often, and the text wrapped to the list's width. GUI thread.
class NoticeDelegate : public QStyledItemDelegate {
 public:
  using QStyledItemDelegate::QStyledItemDelegate;

  void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override;
  QSize sizeHint(const QStyleOptionViewItem& option, const QModelIndex& index) const override;

 private:
  int text_height(const QFont& font, const QString& text, int width) const;

  mutable QHash<QString, int> heights_;  ///< of texts, at `width_` in `font_`: a list lays all its rows out anew
  mutable int width_ = 0;
  mutable QFont font_;
};

}  // namespace lumifield
