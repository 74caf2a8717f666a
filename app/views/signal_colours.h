#pragma once

#include <QColor>

class QPalette;

namespace lumifield {

/// Colours that mean something, each at a contrast of at least 4.5 to 1 against the palette's base. GUI thread.
QColor fault_colour(const QPalette& palette);
QColor warning_colour(const QPalette& palette);
QColor good_colour(const QPalette& palette);
QColor information_colour(const QPalette& palette);

/// Contrast of two opaque colours, 1 … 21 (WCAG 2.1, relative luminance).
double contrast(const QColor& a, const QColor& b);

}  // namespace lumifield
