#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/scene.h"

namespace lumifield {

/// A diffuse surface; reflectances 0 … 1 in the scene's R, G, B.
struct Material {
  std::string name;
  std::array<float, 3> diffuse{0.5F, 0.5F, 0.5F};
};

/// One corner of a triangle: mm, scene frame; the normal has unit length.
struct Vertex {
  std::array<float, 3> position_mm, normal;
};

/// The surfaces of a scene, as a plain list of triangles. Value type.
struct Mesh {
  std::vector<Vertex> vertices;         ///< three for each triangle
  std::vector<std::uint32_t> material;  ///< one for each triangle, into `materials`
  std::vector<Material> materials;
  std::vector<std::string> notes;  ///< what the file says and the picture does not show

  std::size_t triangles() const { return material.size(); }
};

constexpr std::size_t max_triangles = 50'000'000;

/// Reads Wavefront OBJ with its MTL (Kd), polygons cut into triangles. Corners without a normal get their face's. Faces
/// without a material, or whose library is missing, get the material "default", grey 0.5, and a note says so; so do
/// textures and other properties that are not shown. Overrides replace Kd by the material's name.
///
/// Errors: a missing or oversized file, no triangle, a coordinate that is not a finite number (line named), an index
/// out of range, more than max_triangles, a material library outside the OBJ's folder, a Kd outside 0 … 1, an override
/// that names no material. Reentrant.
Result<Mesh> read_mesh(const std::filesystem::path& obj, const std::map<std::string, MaterialOverride>& overrides = {});

}  // namespace lumifield
