#pragma once

#include <optional>
#include <span>
#include <string_view>

namespace lumifield {

/// The ways to tell what of a luminaire a receiver sees.
enum class Visibility {
  none,       ///< all of it
  tile,       ///< each tile of U by a depth map from its centre, each tile's light weighed by its own test
  published,  ///< Lu 2015, Sec. 6.2: depth maps from the medians on S, each cell's light weighed by its tiles' mean
  rays,       ///< each tile's centre by a ray; the reference by rays to many points
};

struct VisibilityInfo {
  Visibility visibility;
  std::string_view name;  ///< in options and the window
  std::string_view what;  ///< one line for people
};

/// All of them, in the order of the enumeration.
std::span<const VisibilityInfo> visibilities();
const VisibilityInfo& info(Visibility visibility);
std::string_view to_string(Visibility visibility);
std::optional<Visibility> visibility_from_string(std::string_view name);

}  // namespace lumifield
