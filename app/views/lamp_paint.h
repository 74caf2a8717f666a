#pragma once

#include <vector>

#include "app/views/lamp_grip.h"

class QPainter;

namespace lumifield {

/// The lamps' handles over a picture: outline, arrow along the beam, number from 1. They are seen on bright and dark
/// pictures alike; `at` is what the cursor is at, `chosen` a lamp or −1. Nothing is drawn outside the view's picture.
void draw_lamps(QPainter& painter, const PictureProjection& view, const std::vector<LampHandle>& handles,
                const std::optional<LampHit>& at, int chosen);

}  // namespace lumifield
