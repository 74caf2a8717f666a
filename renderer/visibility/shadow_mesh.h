#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "luminaire/geometry.h"
#include "renderer/scene/mesh.h"

namespace lumifield {

/// A mesh as depth maps need it. Each triangle has its last corner for itself, which carries its plane; its others are
/// those of its neighbours, where one is at their place, so that there are hardly more vertices than triangles.
/// Triangles without an area are not kept. Scene frame, mm. Value type.
struct ShadowMesh {
  std::vector<std::array<float, 3>> vertices;  ///< vertex k is the last corner of triangle k; then those of none
  std::vector<std::uint32_t> corners;          ///< three for each triangle, into `vertices`

  explicit ShadowMesh(const Mesh& mesh);
  std::size_t triangles() const { return corners.size() / 3; }
};

/// A corner of a ShadowMesh placed in a luminaire's frame, as the shader reads it. Of the triangle whose last corner it
/// is: the plane n·x = d, n of unit length, and the extent along z. mm.
struct PlacedVertex {
  std::array<float, 3> position, n;
  float d, low_z, high_z;
};

/// `pose`: luminaire → scene, rigid.
std::vector<PlacedVertex> placed_vertices(const ShadowMesh& mesh, const Pose& pose);

}  // namespace lumifield
