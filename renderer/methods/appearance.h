#pragma once

#include <vector>

#include "luminaire/error.h"
#include "renderer/methods/look.h"

namespace lumifield {

/// How receivers look, besides diffuse and unoccluded. Value type.
struct Appearance {
  std::vector<GlossLobe> gloss{};  ///< one for each receiver, the eye in the luminaire frame; empty: all are diffuse
  TileVisibility visible{};        ///< of each receiver; empty: all see all
  /// By points of U, of a receiver; where it is set host forms ask it instead.
  std::function<bool(std::size_t receiver, const Vec2& u_mm)> sees{};

  /// Of one of them.
  Look look(std::size_t receiver) const;
  /// Whether no lobe is coloured.
  bool is_grey() const;
  /// Values of glossy radiance a receiver: one for each channel, or three where one channel's light is coloured by a
  /// lobe; 0 where all are diffuse.
  std::size_t gloss_channels(std::size_t channels) const;
};

/// Refuses one of other receivers or tiles, and lobes that are not finite.
Status check_appearance(const Appearance& appearance, const TileGrid& grid, std::size_t receivers);

}  // namespace lumifield
