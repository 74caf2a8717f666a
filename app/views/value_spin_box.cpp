#include "app/views/value_spin_box.h"

#include <QLineEdit>
#include <QLocale>
#include <QStyleOptionSpinBox>
#include <cmath>

namespace lumifield {
namespace {

constexpr double smallest = 1e-12, largest = 1e12;

double rounded(double value) { return QString::number(value, 'g', 4).toDouble(); }

}  // namespace

ValueSpinBox::ValueSpinBox(QWidget* parent) : QDoubleSpinBox(parent) {
  setLocale(QLocale::c());
  setDecimals(16);
  setRange(smallest, largest);
}

QString ValueSpinBox::number_in(const QString& text) const {
  QString number = text;
  if (number.endsWith(suffix())) number.chop(suffix().size());
  return number.trimmed();
}

QString ValueSpinBox::textFromValue(double value) const { return QString::number(value, 'g', 4); }

double ValueSpinBox::valueFromText(const QString& text) const { return number_in(text).toDouble(); }

QValidator::State ValueSpinBox::validate(QString& text, int&) const {
  const QString number = number_in(text);
  bool good = false;
  const double value = number.toDouble(&good);
  if (good && value >= smallest && value <= largest) return QValidator::Acceptable;
  for (const QChar c : number)
    if (!c.isDigit() && !QStringLiteral("+-.eE").contains(c)) return QValidator::Invalid;
  return QValidator::Intermediate;
}

void ValueSpinBox::stepBy(int steps) { setValue(rounded(value() * std::pow(1.1, steps))); }

QSize ValueSpinBox::sizeHint() const {
  QStyleOptionSpinBox option;
  initStyleOption(&option);
  const QSize text(fontMetrics().horizontalAdvance(QStringLiteral("1.234e-05") + suffix()) + 4,
                   lineEdit()->sizeHint().height());
  return style()->sizeFromContents(QStyle::CT_SpinBox, &option, text, this);
}

}  // namespace lumifield
