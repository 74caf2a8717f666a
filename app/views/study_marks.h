#pragma once

#include <QColor>
#include <QPainterPath>

#include "renderer/methods/method.h"

class QPalette;

namespace lumifield {

/// How each method is drawn in every chart: a colour of its own, told apart under the common colour blindnesses too and
/// at a contrast of at least 3 to 1 against the palette's base, and a shape of its own. GUI thread.
QColor method_colour(Method method, const QPalette& palette);

/// Closed, around the origin, `size` wide.
QPainterPath method_mark(Method method, double size);

/// Points down, its tip in the origin: what it marks lies below the axis.
QPainterPath below_arrow(double size);

}  // namespace lumifield
