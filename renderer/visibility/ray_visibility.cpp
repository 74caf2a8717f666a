#include "renderer/visibility/ray_visibility.h"

#include <algorithm>
#include <cmath>
#include <embree3/rtcore.h>
#include <limits>
#include <string>

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

struct RayVisibility::Impl {
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  double offset_mm = 0;

  Status build(const ShadowMesh& mesh, const Pose& pose);
};

Status RayVisibility::Impl::build(const ShadowMesh& mesh, const Pose& pose) {
  // One thread: what the machine's others do is not Embree's to say.
  device = rtcNewDevice("threads=1");
  if (!device) return failed(rtcGetDeviceError(nullptr));
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  double largest = 0;
  const std::vector<PlacedVertex> placed = placed_vertices(mesh, pose);
  if (!mesh.corners.empty()) {
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), placed.size()));
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles()));
    if (vertices && corners) {
      for (std::size_t k = 0; k < placed.size(); ++k) std::ranges::copy(placed[k].position, vertices + 3 * k);
      std::ranges::copy(mesh.corners, corners);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
    }
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  if (const RTCError code = rtcGetDeviceError(device); code != RTC_ERROR_NONE) return failed(code);

  for (std::size_t k = 0; k < placed.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      largest = std::max({largest, std::abs(double(placed[k].position[i])), std::abs(double(mesh.vertices[k][i]))});
  offset_mm = 16 * largest * std::numeric_limits<float>::epsilon();
  return {};
}

RayVisibility::RayVisibility(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RayVisibility::RayVisibility(RayVisibility&&) noexcept = default;
RayVisibility& RayVisibility::operator=(RayVisibility&&) noexcept = default;
RayVisibility::~RayVisibility() = default;
double RayVisibility::offset_mm() const { return impl_->offset_mm; }

Result<RayVisibility> RayVisibility::create(const Mesh& mesh, const Pose& pose) {
  auto impl = std::make_unique<Impl>();
  if (const Status built = impl->build(ShadowMesh(mesh), pose); !built) return tl::unexpected(built.error());
  return RayVisibility(std::move(impl));
}

bool RayVisibility::sees(const Vec3& p_mm, const Vec3& face_n, const Vec3& u_mm) const {
  const double side = face_n.dot(u_mm - p_mm) < 0 ? -1 : 1;
  const Vec3 from = p_mm + side * impl_->offset_mm * face_n;
  const Vec3 towards = u_mm - from;
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
  rtcOccluded1(impl_->scene, &context, &ray);
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
