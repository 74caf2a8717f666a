#pragma once

#include <cstddef>
#include <string_view>

#include "luminaire/error.h"

namespace lumifield {

/// What a view takes of memory: of each of its receivers, one for each pixel and luminaire; of each luminaire, however
/// large the picture is; and once. Value type.
struct ViewMemory {
  std::size_t pixels = 0, luminaires = 0, each_bytes = 0;
  double luminaire_bytes = 0, once_bytes = 0;

  double bytes() const {
    const auto all = static_cast<double>(luminaires);
    return static_cast<double>(pixels) * all * static_cast<double>(each_bytes) + all * luminaire_bytes + once_bytes;
  }
};

/// Refuses a view that takes more on the host for `what` than half of `memory_bytes`. To be asked before any of it is
/// taken. Reentrant.
Status check_view_memory(std::string_view what, const ViewMemory& view, double memory_bytes);

}  // namespace lumifield
