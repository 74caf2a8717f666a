#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/scene.h"
#include "renderer/methods/gloss_shared.h"

namespace lumifield {

/// What a surface reflects: a diffuse part, times its texture's where it has one, and a lobe. Reflectances 0 … 1 in the
/// scene's R, G, B.
struct Material {
  std::string name;
  std::array<float, 3> diffuse{0.5F, 0.5F, 0.5F};
  std::array<float, 3> specular{0, 0, 0};   ///< Phong: k_s; GGX: F0
  int lobe = LOBE_NONE;                     ///< LOBE_NONE, LOBE_PHONG, LOBE_GGX
  float shape = 0;                          ///< Phong: exponent; GGX: α = roughness²
  std::optional<std::size_t> texture = {};  ///< into Mesh::textures, multiplies diffuse
};

/// What an MTL file says of a material.
struct MtlMaterial {
  std::string name;
  std::array<float, 3> kd{}, ks{};
  float ns = 1, pr = 0, pm = 0;  ///< pr 0: absent
  std::string map_kd;            ///< empty: none
};

/// F0 of surfaces that say how rough they are and nothing else: of glass and most plastics.
constexpr float common_f0 = 0.04F;

/// Ks and Ns make Phong's lobe. Pr makes GGX's of α = Pr², F0 = Ks or, without, common_f0; Pm is the share of metal,
/// whose F0 is Kd and which has no diffuse part. Pr below least_roughness counts as that, and a note says so.
Material material_of(const MtlMaterial& mtl, std::vector<std::string>& notes);

/// Replaces what an override sets. A roughness without any specular reflectance makes it common_f0. Errors: values out
/// of their ranges, a gloss that lacks its roughness or exponent, an exponent without a specular reflectance.
Status apply_override(const MaterialOverride& values, Material& material);

/// Notes what reflects more than it gets.
void note_energy(const Material& material, std::vector<std::string>& notes);

}  // namespace lumifield
