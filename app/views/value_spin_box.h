#pragma once

#include <QDoubleSpinBox>

namespace lumifield {

/// A positive value of any magnitude, to four significant digits; each step changes it by a tenth.
class ValueSpinBox : public QDoubleSpinBox {
 public:
  explicit ValueSpinBox(QWidget* parent = nullptr);

  QString textFromValue(double value) const override;
  double valueFromText(const QString& text) const override;
  QValidator::State validate(QString& text, int& position) const override;
  void stepBy(int steps) override;
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 private:
  QString number_in(const QString& text) const;
};

}  // namespace lumifield
