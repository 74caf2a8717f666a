#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

std::string_view to_string(SpotLookUp look_up) { return look_up == SpotLookUp::weighted ? "weighted" : "textured"; }

std::optional<SpotLookUp> spot_look_up_from_string(std::string_view name) {
  for (const SpotLookUp each : {SpotLookUp::weighted, SpotLookUp::textured})
    if (name == to_string(each)) return each;
  return std::nullopt;
}

}  // namespace lumifield
