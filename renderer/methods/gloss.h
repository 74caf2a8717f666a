#pragma once

#include <array>

#include "luminaire/geometry.h"
#include "renderer/methods/gloss_shared.h"

namespace lumifield {

/// The glossy part f(i, o) of a surface's BRDF, 1/sr, in R, G, B; 0 unless both directions are on the normal's side.
///
/// Phong: k_s (n + 2)/(2π) cosⁿα, α between the light and the mirrored eye (Colbert, Křivánek, GPU Gems 3, ch. 20, with
/// Lafortune and Willems' normalisation). GGX: D G F/(4 cosθ_i cosθ_o), D and Smith's height-correlated G of Trowbridge
/// and Reitz with α = roughness² (Walter et al. 2007; Burley 2012; Heitz 2014), F of Schlick: F0 + (1 − F0)(1 −
/// cosθ_h)⁵.
///
/// n and to_light of unit length, in the frame of the lobe's eye. Reentrant. renderer/methods/gloss.clh is the same in
/// float.
std::array<double, 3> glossy_brdf(const GlossLobe& lobe, const Vec3& n, const Vec3& to_light);

/// Whether the three are one number for every direction: k_s or F0 is grey.
inline bool is_grey(const GlossLobe& lobe) { return lobe.r == lobe.g && lobe.g == lobe.b; }

}  // namespace lumifield
