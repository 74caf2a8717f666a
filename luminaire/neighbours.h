#pragma once

#include <functional>

#include "luminaire/light_field.h"

namespace lumifield {

/// How little a cell's image C is like those around it: Σ|C − N| / Σ(|C| + |N|) over pixels and channels, N the mean of
/// the measured cells beside, above and below. 0: alike; 1: nothing in common; NaN: no neighbour is measured, or all is
/// dark. Smooth lamps stay low; a slipped stage or a wrong filter stands out from the cells around it.
double neighbour_difference(const Sampling& sampling, CellIndex cell,
                            const std::function<const CellImage*(CellIndex)>& image_of);

}  // namespace lumifield
