#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/scene.h"
#include "renderer/scene/material.h"
#include "renderer/scene/texture.h"

namespace lumifield {

/// One corner of a triangle: mm, scene frame; the normal has unit length. Texture coordinates u to the right, v up, the
/// texture from 0 to 1 and repeated beyond.
struct Vertex {
  std::array<float, 3> position_mm, normal;
  std::array<float, 2> uv{0, 0};
};

/// The surfaces of a scene, as a plain list of triangles. Value type.
struct Mesh {
  std::vector<Vertex> vertices;         ///< three for each triangle
  std::vector<std::uint32_t> material;  ///< one for each triangle, into `materials`
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<std::string> notes;  ///< what the file says and the picture does not show

  std::size_t triangles() const { return material.size(); }
};

constexpr std::size_t max_triangles = 50'000'000;

/// Reads Wavefront OBJ with its MTL (Kd, Ks, Ns, Pr, Pm, map_Kd; material_of), polygons cut into triangles. Corners
/// without a normal get their face's. Faces without a material, or whose library is missing, get the material
/// "default", grey 0.5, and a note says so; so do textures that are not shown: missing, outside the OBJ's folder,
/// neither PNG nor OpenEXR. Kd multiplies the texture; where it is 0 the texture stands alone, as exporters mean it.
/// Overrides replace what they set by the material's name (apply_override).
///
/// Errors: a missing or oversized file, no triangle, a coordinate that is not a finite number (line named), an index
/// out of range, more than max_triangles, a material library outside the OBJ's folder, a value of it out of its range,
/// a broken texture, an override that names no material. Reentrant.
Result<Mesh> read_mesh(const std::filesystem::path& obj, const std::map<std::string, MaterialOverride>& overrides = {});

}  // namespace lumifield
