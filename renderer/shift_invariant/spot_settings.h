#pragma once

#include <optional>
#include <string_view>

namespace lumifield {

/// How a cell's image is averaged over the support of its basis, as a receiver sees it.
///
/// weighted: by Φ, exactly: over every pixel of the support.
/// textured: one trilinear look-up at the support's centre, as graphics hardware has it, at the level of detail whose
/// own blur is as wide (spot_images.h). A cheap variant that has a bias.
enum class SpotLookUp { weighted, textured };
/// "weighted", "textured": in options, files and the window.
std::string_view to_string(SpotLookUp look_up);
std::optional<SpotLookUp> spot_look_up_from_string(std::string_view name);

/// What passes are added up in.
///
/// float32: one float a channel.
/// srgbe: 8 bits a channel with a shared signed exponent (srgbe.h), read, added to and written by every pass: what
/// hardware without blending of floats did (Granier et al. 2003, Sec. 4.2). Each pass rounds by up to 0.78 % of the
/// largest channel; of 63 cells the RMS error is 0.5 % with X = 16, 1 % with X = 3 and 2.3 % with X = 1.
enum class SpotSums { float32, srgbe };

/// Of the method shift-invariant. Value type.
struct SpotSettings {
  SpotLookUp look_up = SpotLookUp::weighted;
  SpotSums sums = SpotSums::float32;
  int cells_per_pass = 16;  ///< X, from 1 to most_cells_per_pass
  int shadow_texels = 2;  ///< a side of the patch of depth texels that a shadow test compares, 1 to most_shadow_texels
  int shadow_map_px = 192;  ///< a side of a cell's depth map
  bool operator==(const SpotSettings&) const = default;
};

inline constexpr int most_cells_per_pass = 64, most_shadow_texels = 8, most_shadow_map_px = 4096;

}  // namespace lumifield
