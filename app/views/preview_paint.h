#pragma once

#include <QRectF>
#include <QString>

class QPainter;
class QPalette;

namespace lumifield {

/// What is drawn over the preview's picture. The plates under the texts are dark whatever the palette is, for the
/// picture shines through them.

/// The false-colour scale at the right edge of `area`: unit, bar, ticks. `top` is the luminance at its end; `clipped`:
/// larger values show the end's colour too.
void draw_scale_bar(QPainter& painter, const QRectF& area, double top, bool clipped, const QString& unit);
/// A strip along the bottom of `area`: the warning, if there is one, above the text. Returns its height.
double draw_strip(QPainter& painter, const QRectF& area, const QString& warning, const QString& text);
/// In place of a picture.
void draw_placeholder(QPainter& painter, const QRectF& area, const QPalette& palette, const QString& title,
                      const QString& text, bool fault);

}  // namespace lumifield
