#pragma once

#include <QFrame>
#include <QString>

namespace lumifield {

/// One line of text that gives way: what does not fit ends in "…", and the whole is its tooltip unless it has another.
class ElidedLabel : public QFrame {
 public:
  explicit ElidedLabel(QWidget* parent = nullptr);

  const QString& text() const { return text_; }
  void set_text(const QString& text);
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  QString text_;
};

}  // namespace lumifield
