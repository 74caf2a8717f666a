#include "renderer/visibility/visibility.h"

#include <algorithm>
#include <array>

namespace lumifield {

namespace {

constexpr std::array all{
    VisibilityInfo{Visibility::none, "none", "no shadows: every surface is lit, whatever stands before it"},
    VisibilityInfo{Visibility::tile, "tile",
                   "a shadow map for each tile of the lamp, its light weighed by its own test"},
    VisibilityInfo{Visibility::published, "published",
                   "as Lu 2015: shadow maps from the medians of the images, a cell weighed by the mean of its tiles"},
    VisibilityInfo{Visibility::rays, "rays", "rays to the middle of each tile; the reference by rays to many points"},
};

}  // namespace

std::span<const VisibilityInfo> visibilities() { return all; }

const VisibilityInfo& info(Visibility visibility) { return all[static_cast<std::size_t>(visibility)]; }

std::string_view to_string(Visibility visibility) { return info(visibility).name; }

std::optional<Visibility> visibility_from_string(std::string_view name) {
  const auto found = std::ranges::find(all, name, &VisibilityInfo::name);
  return found == all.end() ? std::nullopt : std::optional(found->visibility);
}

}  // namespace lumifield
