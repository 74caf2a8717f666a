#include "renderer/visibility/shadow_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <unordered_map>

namespace lumifield {
namespace {

using Position = std::array<float, 3>;

struct Hash {
  std::size_t operator()(const Position& p) const {
    std::uint64_t h = 0;
    for (const float x : p) h = (h ^ std::bit_cast<std::uint32_t>(x)) * 0x9e3779b97f4a7c15U, h ^= h >> 29;
    return h;
  }
};

Vec3 vec3(const Position& p) { return {p[0], p[1], p[2]}; }

using Corners = std::array<Position, 3>;

/// Those that have an area.
std::vector<Corners> triangles_of(const Mesh& mesh) {
  std::vector<Corners> triangles;
  triangles.reserve(mesh.triangles());
  for (std::size_t k = 0; k < mesh.triangles(); ++k) {
    Corners p;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t x = 0; x < 3; ++x) p[i][x] = mesh.vertices[3 * k + i].position_mm[x] + 0.0F;  // −0 is 0
    if ((vec3(p[1]) - vec3(p[0])).cross(vec3(p[2]) - vec3(p[0])).squaredNorm() > 0) triangles.push_back(p);
  }
  return triangles;
}

}  // namespace

ShadowMesh::ShadowMesh(const Mesh& mesh) {
  std::vector<Corners> triangles = triangles_of(mesh);
  std::unordered_map<Position, std::uint32_t, Hash> vertex_at;
  vertex_at.reserve(triangles.size());

  // Turn each triangle so that its own vertex is at a place that has none yet.
  vertices.reserve(triangles.size());
  for (Corners& p : triangles) {
    const auto fresh = std::ranges::find_if(p, [&](const Position& corner) { return !vertex_at.contains(corner); });
    if (fresh != p.end()) std::rotate(p.begin(), fresh == p.end() - 1 ? p.begin() : fresh + 1, p.end());
    vertex_at.try_emplace(p[2], static_cast<std::uint32_t>(vertices.size()));
    vertices.push_back(p[2]);
  }

  // Join the others, those of the last triangles first.
  corners.reserve(3 * triangles.size());
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const Corners& p = triangles[k];
    vertex_at[p[2]] = static_cast<std::uint32_t>(k);
    for (std::size_t i = 0; i < 2; ++i) {
      const auto [at, is_new] = vertex_at.try_emplace(p[i], static_cast<std::uint32_t>(vertices.size()));
      if (is_new) vertices.push_back(p[i]);
      corners.push_back(at->second);
    }
    corners.push_back(static_cast<std::uint32_t>(k));
  }
}

std::vector<PlacedVertex> placed_vertices(const ShadowMesh& mesh, const Pose& pose) {
  const Eigen::Matrix3d to_luminaire = pose.topLeftCorner<3, 3>().transpose();
  const Vec3 origin = pose.topRightCorner<3, 1>();
  const auto place = [&](std::uint32_t k) -> Vec3 { return to_luminaire * (vec3(mesh.vertices[k]) - origin); };
  const auto floats = [](const Vec3& v) {
    return std::array{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  std::vector<PlacedVertex> vertices(mesh.vertices.size());
  for (std::uint32_t k = 0; k < vertices.size(); ++k) vertices[k].position = floats(place(k));
  for (std::size_t k = 0; k < mesh.triangles(); ++k) {
    const std::uint32_t* corner = mesh.corners.data() + 3 * k;
    const std::array<Vec3, 3> p = {place(corner[0]), place(corner[1]), place(corner[2])};
    const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    const auto [low, high] = std::minmax({p[0].z(), p[1].z(), p[2].z()});
    PlacedVertex& own = vertices[k];
    own.n = floats(n);
    own.d = static_cast<float>(n.dot(p[2]));
    own.low_z = static_cast<float>(low);
    own.high_z = static_cast<float>(high);
  }
  return vertices;
}

}  // namespace lumifield
