#include "app/views/signal_colours.h"

#include <QPalette>
#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

double linear(double srgb) { return srgb <= 0.03928 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

double luminance(const QColor& colour) {
  return 0.2126 * linear(colour.redF()) + 0.7152 * linear(colour.greenF()) + 0.0722 * linear(colour.blueF());
}

QColor choose(const QPalette& palette, const QColor& on_light, const QColor& on_dark) {
  const QColor base = palette.color(QPalette::Base);
  return contrast(on_light, base) >= contrast(on_dark, base) ? on_light : on_dark;
}

}  // namespace

double contrast(const QColor& a, const QColor& b) {
  const double la = luminance(a), lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

QColor fault_colour(const QPalette& palette) { return choose(palette, QColor(176, 0, 32), QColor(255, 138, 128)); }

QColor warning_colour(const QPalette& palette) { return choose(palette, QColor(138, 83, 0), QColor(255, 183, 77)); }

QColor good_colour(const QPalette& palette) { return choose(palette, QColor(27, 110, 40), QColor(129, 220, 140)); }

QColor information_colour(const QPalette& palette) {
  return choose(palette, QColor(0, 90, 170), QColor(130, 190, 255));
}

}  // namespace lumifield
