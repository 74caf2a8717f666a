#include "renderer/methods/appearance.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/gloss.h"

namespace lumifield {

bool light_is_even(const Look& look) {
  if (look.sees) return false;
  return !look.visible || look.visible->weighing == ShadowWeighing::mean ||
         sight_of(*look.visible, look.receiver) == Sight::all;
}

std::size_t gloss_values(const GlossLobe& lobe, std::size_t channels) {
  return lobe.kind == LOBE_NONE ? 0 : is_grey(lobe) ? channels : 3;
}

Look Appearance::look(std::size_t receiver) const {
  Look look{gloss.empty() ? GlossLobe{} : gloss[receiver], visible.empty() ? nullptr : &visible, receiver, {}};
  if (sees) look.sees = [this, receiver](const Vec2& u) { return sees(receiver, u); };
  return look;
}

bool Appearance::is_grey() const {
  return std::ranges::all_of(gloss, [](const GlossLobe& l) { return l.kind == LOBE_NONE || lumifield::is_grey(l); });
}

std::size_t Appearance::gloss_channels(std::size_t channels) const {
  const bool shines = std::ranges::any_of(gloss, [](const GlossLobe& l) { return l.kind != LOBE_NONE; });
  return !shines ? 0 : is_grey() ? channels : 3;
}

Status check_appearance(const Appearance& appearance, const TileGrid& grid, std::size_t receivers) {
  if (!appearance.gloss.empty() && appearance.gloss.size() != receivers)
    return fail(std::to_string(appearance.gloss.size()) + " lobes for " + std::to_string(receivers) + " receivers",
                "gloss", "give one each");
  for (std::size_t k = 0; k < appearance.gloss.size(); ++k) {
    const GlossLobe& l = appearance.gloss[k];
    if (!std::isfinite(l.eye_x + l.eye_y + l.eye_z) || !std::isfinite(l.shape) || !std::isfinite(l.r + l.g + l.b))
      return fail("its gloss has NaN or Inf", "receiver " + std::to_string(k), "give finite numbers");
  }
  const TileVisibility& visible = appearance.visible;
  if (visible.empty() || (visible.grid == grid && visible.words.size() == receivers * visible.receiver_words()))
    return {};
  return fail("they are of another luminaire, or of other receivers", "shadows", "make them for these");
}

}  // namespace lumifield
