#pragma once

#include <QColor>
#include <QString>
#include <array>

#include "app/views/luminaire_model.h"

class QPainter;
class QPalette;
class QRectF;

namespace lumifield {

inline constexpr std::array all_cell_states{LuminaireModel::State::unmeasured, LuminaireModel::State::measuring,
                                            LuminaireModel::State::waiting,    LuminaireModel::State::measured,
                                            LuminaireModel::State::warned,     LuminaireModel::State::damaged};

/// "measuring now".
QString state_name(LuminaireModel::State state);

/// A cell's state without its colour alone: unmeasured hollow, measured plain, measuring a triangle, waiting for a
/// retake a turning arrow, warned an exclamation mark, damaged a cross.
void paint_state(QPainter& painter, const QRectF& rect, LuminaireModel::State state, const QPalette& palette);

/// The same mark, small, in the upper right corner of a cell that shows something else; none for unmeasured and
/// measured.
void paint_state_badge(QPainter& painter, const QRectF& rect, LuminaireModel::State state);

/// "Not known": diagonal lines.
void paint_hatch(QPainter& painter, const QRectF& rect, const QPalette& palette);

/// Black or white, whichever is read more easily on a colour.
QColor ink_on(const QColor& colour);

}  // namespace lumifield
