#pragma once

#include <QImage>

namespace lumifield {

/// A mask shown smaller: a pixel of the result is marked when any pixel of the mask that falls into it is, so that a
/// single over-exposed pixel does not vanish. `mask` and the result: ARGB32_Premultiplied, unmarked = transparent.
QImage reduce_mask(const QImage& mask, const QSize& size);

}  // namespace lumifield
