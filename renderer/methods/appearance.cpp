#include "renderer/methods/appearance.h"

#include <algorithm>

#include "renderer/methods/gloss.h"

namespace lumifield {

std::size_t Appearance::gloss_channels(std::size_t channels) const {
  if (gloss.empty()) return 0;
  const bool grey =
      std::ranges::all_of(gloss, [](const GlossLobe& lobe) { return lobe.kind == LOBE_NONE || is_grey(lobe); });
  return grey ? channels : 3;
}

}  // namespace lumifield
