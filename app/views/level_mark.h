#pragma once

#include "app/views/operator_notice.h"

class QPainter;
class QPalette;
class QRectF;

namespace lumifield {

/// A notice's level as a drawn mark, told apart by shape as well as colour: a disc with an i, a triangle with an
/// exclamation mark, an octagon with a cross. GUI thread.
void paint_level_mark(QPainter& painter, const QRectF& square, OperatorNotice::Level level, const QPalette& palette);

}  // namespace lumifield
