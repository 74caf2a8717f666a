#include "renderer/scene/material.h"

#include <algorithm>
#include <cstdio>

namespace lumifield {
namespace {

bool any(const std::array<float, 3>& colour) {
  return std::ranges::any_of(colour, [](float v) { return v > 0; });
}

bool in_range(double value, double low, double high) { return value >= low && value <= high; }

Status replace(const std::optional<std::array<double, 3>>& values, const char* what, const std::string& name,
               std::array<float, 3>& colour) {
  if (!values) return {};
  for (std::size_t c = 0; c < 3; ++c) {
    if (!in_range((*values)[c], 0, 1))
      return fail(std::string("the ") + what + " reflectance is not 0 to 1", "materials: " + name,
                  "give three numbers from 0 to 1");
    colour[c] = static_cast<float>((*values)[c]);
  }
  return {};
}

}  // namespace

Material material_of(const MtlMaterial& mtl, std::vector<std::string>& notes) {
  const auto note = [&](const std::string& text) { notes.push_back("material \"" + mtl.name + "\": " + text); };
  Material material{.name = mtl.name, .diffuse = mtl.kd};
  if (mtl.pr == 0) {
    if (mtl.pm > 0) note("it has no roughness (Pr); its metal (Pm) is not shown");
    if (!any(mtl.ks)) return material;
    material.specular = mtl.ks;
    material.lobe = LOBE_PHONG;
    material.shape = mtl.ns;
    return material;
  }
  constexpr auto least = static_cast<float>(least_roughness);
  if (mtl.pr < least) note("its roughness (Pr) is below 0.03 and shows as 0.03");
  const float roughness = std::max(mtl.pr, least);
  material.lobe = LOBE_GGX;
  material.shape = roughness * roughness;
  for (std::size_t c = 0; c < 3; ++c) {
    const float f0 = any(mtl.ks) ? mtl.ks[c] : common_f0;
    material.specular[c] = f0 + mtl.pm * (mtl.kd[c] - f0);
    material.diffuse[c] = mtl.kd[c] * (1 - mtl.pm);
  }
  if (mtl.pm > 0 && !mtl.map_kd.empty()) note("its metal shines in the plain colour Kd, not in the texture's");
  return material;
}

Status apply_override(const MaterialOverride& values, Material& material) {
  const std::string where = "materials: " + material.name;
  if (Status ok = replace(values.diffuse, "diffuse", material.name, material.diffuse); !ok) return ok;
  if (Status ok = replace(values.specular, "specular", material.name, material.specular); !ok) return ok;
  if (values.roughness && values.exponent)
    return fail("a roughness and an exponent", where, "give one of them: roughness for GGX, exponent for Phong");
  if (values.roughness) {
    if (!in_range(*values.roughness, least_roughness, 1))
      return fail("the roughness is not 0.03 to 1", where, "give a number from 0.03 to 1");
    if (!any(material.specular) && !values.specular) material.specular.fill(common_f0);
    material.lobe = LOBE_GGX;
    material.shape = static_cast<float>(*values.roughness * *values.roughness);
  }
  if (values.exponent) {
    if (!in_range(*values.exponent, 1, largest_exponent))
      return fail("the exponent is not 1 to 100000", where, "give a number from 1 to 100000");
    if (!any(material.specular) && !values.specular)
      return fail("an exponent without a specular reflectance", where, "give specular too");
    material.lobe = LOBE_PHONG;
    material.shape = static_cast<float>(*values.exponent);
  }
  if (any(material.specular) && material.lobe == LOBE_NONE)
    return fail("a specular reflectance without a lobe", where, "give roughness (GGX) or exponent (Phong) too");
  if (material.lobe == LOBE_PHONG && !any(material.specular)) material.lobe = LOBE_NONE;
  return {};
}

void note_energy(const Material& material, std::vector<std::string>& notes) {
  float most = 0;
  for (std::size_t c = 0; c < 3; ++c) most = std::max(most, material.diffuse[c] + material.specular[c]);
  if (most <= 1 + 1e-6F) return;
  std::array<char, 16> sum{};
  std::snprintf(sum.data(), sum.size(), "%.3g", static_cast<double>(most));
  notes.push_back("material \"" + material.name + "\": its diffuse and specular reflectances add up to " + sum.data() +
                  "; it reflects more than it gets");
}

}  // namespace lumifield
