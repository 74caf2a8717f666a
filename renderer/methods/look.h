#pragma once

#include <functional>

#include "renderer/methods/gloss_shared.h"
#include "renderer/visibility/tile_visibility.h"

namespace lumifield {

/// How one receiver looks: what it sees of U, and how it shines. By default it is diffuse and sees all. Value type;
/// refers to the visibility.
struct Look {
  GlossLobe lobe{};                              ///< the eye in the luminaire frame
  const TileVisibility* visible = nullptr;       ///< by tiles; null: all of them
  std::size_t receiver = 0;                      ///< of `visible`
  std::function<bool(const Vec2& u_mm)> sees{};  ///< exact, by point; where it is set `visible` counts for nothing

  bool plain() const { return lobe.kind == LOBE_NONE && !visible && !sees; }
};

/// Whether every part of a cell's support counts alike: nothing of it is hidden, or the cell is weighed by a mean.
bool light_is_even(const Look& look);

/// Values of radiance that a lobe makes of so many channels: one each, or three where it colours one channel's light.
std::size_t gloss_values(const GlossLobe& lobe, std::size_t channels);

}  // namespace lumifield
