#include "app/views/value_text.h"

#include <QLocale>
#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

QString superscript(int number) {
  static const QString digits = QStringLiteral("⁰¹²³⁴⁵⁶⁷⁸⁹");
  QString text = number < 0 ? QStringLiteral("⁻") : QString();
  for (const QChar digit : QString::number(std::abs(number))) text += digits[digit.digitValue()];
  return text;
}

/// As short as `digits` allow: no zeros at the end of a fraction.
QString without_idle_zeros(QString text) {
  if (!text.contains(u'.')) return text;
  while (text.endsWith(u'0')) text.chop(1);
  if (text.endsWith(u'.')) text.chop(1);
  return text;
}

}  // namespace

QString value_text(double value, int digits) {
  if (std::isnan(value)) return QStringLiteral("not known");
  if (std::isinf(value)) return value > 0 ? QStringLiteral("∞") : QStringLiteral("−∞");
  if (value == 0) return QStringLiteral("0");
  // Rounded first, so that 999.9 becomes 1000 and not 10·10².
  const QString rounded = QString::number(std::abs(value), 'e', digits - 1);
  const int exponent = rounded.section(u'e', 1).toInt();
  const QString sign = value < 0 ? QStringLiteral("−") : QString();
  if (exponent < -3 || exponent > 5)
    return sign + without_idle_zeros(rounded.section(u'e', 0, 0)) + QStringLiteral("·10") + superscript(exponent);
  const QString fixed = QString::number(rounded.toDouble(), 'f', std::max(0, digits - 1 - exponent));
  return sign + without_idle_zeros(fixed);
}

QString unit_text(std::string_view unit) {
  return QString::fromUtf8(unit.data(), static_cast<qsizetype>(unit.size())).replace("^2", "²");
}

QString cell_unit_text(Quantity quantity) { return unit_text(unit_of(quantity)) + QStringLiteral(" per mm²"); }

std::vector<double> axis_ticks(double least, double largest, int most) {
  if (!(largest > least) || most < 1 || !std::isfinite(largest - least)) return {};
  const double rough = (largest - least) / most, decade = std::pow(10, std::floor(std::log10(rough)));
  for (const double times : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0}) {
    const double step = times * decade, slack = 1e-9;
    const double first = std::ceil(least / step - slack), last = std::floor(largest / step + slack);
    if (last - first + 1 > most) continue;
    std::vector<double> ticks;
    for (double k = first; k <= last; ++k) ticks.push_back(k * step);
    return ticks;
  }
  return {};
}

std::vector<double> decade_ticks(double least, double largest, int most) {
  if (!(least > 0) || !(largest > least) || most < 1) return {};
  const int first = static_cast<int>(std::ceil(std::log10(least) - 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(largest) + 1e-9));
  const int step = std::max(1, (last - first + most) / most);
  std::vector<double> ticks;
  for (int exponent = last; exponent >= first; exponent -= step) ticks.push_back(std::pow(10, exponent));
  std::ranges::reverse(ticks);
  return ticks;
}

}  // namespace lumifield
