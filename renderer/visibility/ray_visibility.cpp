#include "renderer/visibility/ray_visibility.h"

#include <Eigen/LU>
#include <algorithm>
#include <embree3/rtcore.h>
#include <limits>
#include <string>
#include <utility>

#include "renderer/bands.h"
#include "renderer/visibility/shadow_mesh.h"

namespace lumifield {
namespace {

tl::unexpected<Error> failed(RTCError code) {
  if (code == RTC_ERROR_OUT_OF_MEMORY)
    return fail("there is no memory for the rays' tree", "Embree", "use a smaller mesh");
  return fail("error " + std::to_string(code), "Embree",
              code == RTC_ERROR_UNSUPPORTED_CPU ? "use another machine" : "use another version");
}

}  // namespace

/// Of a scene, in its frame.
struct RayVisibility::Tree {
  Tree() = default;
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  ~Tree() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 low_mm{0, 0, 0}, high_mm{0, 0, 0};  ///< of all vertices

  Status build(const ShadowMesh& mesh);
};

Status RayVisibility::Tree::build(const ShadowMesh& mesh) {
  // One thread: what the machine's others do is not Embree's to say.
  device = rtcNewDevice("threads=1");
  if (!device) return failed(rtcGetDeviceError(nullptr));
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  if (!mesh.corners.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), mesh.vertices.size()));
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles()));
    if (vertices && corners) {
      for (std::size_t k = 0; k < mesh.vertices.size(); ++k) std::ranges::copy(mesh.vertices[k], vertices + 3 * k);
      std::ranges::copy(mesh.corners, corners);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
    }
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE) return failed(code);

  for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
    const Vec3 p = Eigen::Map<const Eigen::Vector3f>(mesh.vertices[k].data()).cast<double>();
    low_mm = k == 0 ? p : Vec3(low_mm.cwiseMin(p));
    high_mm = k == 0 ? p : Vec3(high_mm.cwiseMax(p));
  }
  return {};
}

RayVisibility::RayVisibility(std::shared_ptr<const Tree> tree, const Pose& pose) : tree_(std::move(tree)), pose_(pose) {
  const Pose to_luminaire = pose.inverse();
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) p[i] = (corner >> i & 1 ? tree_->high_mm : tree_->low_mm)[i];
    const Vec3 seen = transform_point(to_luminaire, p);
    largest = std::max({largest, p.cwiseAbs().maxCoeff(), seen.cwiseAbs().maxCoeff()});
  }
  offset_mm_ = 16 * largest * std::numeric_limits<float>::epsilon();
}

Result<RayVisibility> RayVisibility::create(const Mesh& mesh, const Pose& pose) {
  auto tree = std::make_shared<Tree>();
  if (const Status built = tree->build(ShadowMesh(mesh)); !built) return tl::unexpected(built.error());
  return RayVisibility(std::move(tree), pose);
}

RayVisibility RayVisibility::at(const Pose& pose) const { return {tree_, pose}; }

bool RayVisibility::sees(const Vec3& p_mm, const Vec3& face_n, const Vec3& u_mm) const {
  const double side = face_n.dot(u_mm - p_mm) < 0 ? -1 : 1;
  const Vec3 moved = p_mm + side * offset_mm_ * face_n;
  const Vec3 from = transform_point(pose_, moved), towards = transform_direction(pose_, u_mm - moved);
  RTCRay ray{};
  ray.org_x = static_cast<float>(from.x());
  ray.org_y = static_cast<float>(from.y());
  ray.org_z = static_cast<float>(from.z());
  ray.dir_x = static_cast<float>(towards.x());
  ray.dir_y = static_cast<float>(towards.y());
  ray.dir_z = static_cast<float>(towards.z());
  ray.tfar = 1;
  ray.mask = ~0U;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(tree_->scene, &context, &ray);
  return ray.tfar >= 0;  // −∞ where something was hit
}

TileVisibility RayVisibility::see_tiles(const TileGrid& grid, std::span<const float> p_xyzw,
                                        std::span<const float> face_xyzw, ShadowWeighing weighing) const {
  TileVisibility visibility{grid, weighing, {}};
  const std::size_t receivers = p_xyzw.size() / 4;
  visibility.words.assign(receivers * visibility.receiver_words(), 0);
  const auto vec3 = [](const float* v) { return Vec3(v[0], v[1], v[2]); };
  in_bands(receivers, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3 p = vec3(p_xyzw.data() + 4 * k), n = vec3(face_xyzw.data() + 4 * k);
      if (n == Vec3(0, 0, 0) || !(p.z() > 0)) continue;
      for (int row = 0; row < grid.rows; ++row)
        for (int column = 0; column < grid.columns; ++column) {
          const Vec2 u = grid.center_mm(column, row);
          if (sees(p, n, Vec3(u.x(), u.y(), 0))) visibility.set_seen(k, column, row);
        }
    }
  });
  return visibility;
}

}  // namespace lumifield
