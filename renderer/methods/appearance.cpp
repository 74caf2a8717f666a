#include "renderer/methods/appearance.h"

#include <algorithm>

#include "renderer/methods/gloss.h"

namespace lumifield {

bool Appearance::is_grey() const {
  return std::ranges::all_of(gloss, [](const GlossLobe& l) { return l.kind == LOBE_NONE || lumifield::is_grey(l); });
}

std::size_t Appearance::gloss_channels(std::size_t channels) const {
  const bool shines = std::ranges::any_of(gloss, [](const GlossLobe& l) { return l.kind != LOBE_NONE; });
  return !shines ? 0 : is_grey() ? channels : 3;
}

}  // namespace lumifield
