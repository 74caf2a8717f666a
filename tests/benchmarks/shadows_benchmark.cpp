// What shadows cost: depth maps of a scene from the tiles of a lamp, tests of a picture's receivers. Not a test: run it
// alone on the machine.
//
//   shadows_benchmark SCENE.json

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "luminaire/scene.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/visibility/ray_visibility.h"
#include "renderer/visibility/shadow_map_pass.h"
#include "renderer/visibility/tile_shadows.h"

namespace lumifield {
namespace {

/// Of the process, all threads, s.
double processor_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// "wall ms (processor ms)", the best of five each.
template <class F>
std::string best(F&& f) {
  double wall = HUGE_VAL, processor = HUGE_VAL;
  for (int k = 0; k < 5; ++k) {
    const auto start = std::chrono::steady_clock::now();
    const double before = processor_s();
    f();
    processor = std::min(processor, processor_s() - before);
    wall = std::min(wall, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.1f ms (processor %.1f)", 1e3 * wall, 1e3 * processor);
  return text;
}

void see(const Scene& scene, const Mesh& mesh, EglContext& context) {
  // A picture's receivers, each with its face's normal.
  constexpr int width = 1024, height = 768;
  const GBuffer picture = GBufferPass::create(context, mesh).value()->draw(scene.camera, width, height).value();
  const Pose pose = scene.luminaires[0].pose;
  const Eigen::Matrix3f r = pose.topLeftCorner<3, 3>().transpose().cast<float>();
  const Eigen::Vector3f origin = pose.topRightCorner<3, 1>().cast<float>();
  std::vector<float> p(picture.position.size()), n(p.size());
  for (std::size_t k = 0; k < p.size(); k += 4) {
    Eigen::Map<Eigen::Vector3f>(p.data() + k) = r * (Eigen::Map<const Eigen::Vector3f>(&picture.position[k]) - origin);
    Eigen::Map<Eigen::Vector3f>(n.data() + k) = r * Eigen::Map<const Eigen::Vector3f>(&picture.normal[k]);
  }

  LuminaireGeometry lamp{{150}, {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}}, {300, 300, {1, 1}, {0, 0}}, {"Y"}};
  auto shadows = TileShadows::create(context, mesh).value();
  for (const int b : {1, 2}) {
    if (!shadows->set(pose, lamp, {.tiles_per_map = b})) std::exit(1);
    double kernel = HUGE_VAL;
    std::size_t bits = 0;
    const std::string all = best([&] {
      const TileVisibility seen = shadows->see(p, n).value();
      bits = 0;
      for (const std::uint32_t word : seen.words) bits += static_cast<std::size_t>(std::popcount(word));
      kernel = std::min(kernel, shadows->last_kernel_s());
    });
    std::printf("%dx%d receivers, %d maps: kernel %.1f ms, with transfers %s, %.1f %% seen; %s\n", width, height,
                shadows->maps(), 1e3 * kernel, all.c_str(), 100.0 * static_cast<double>(bits) / (80.0 * width * height),
                shadows->device_name().c_str());
  }
  const RayVisibility rays = RayVisibility::create(mesh, pose).value();
  const std::string by_rays = best([&] { rays.see_tiles(TileGrid(lamp.sampling), p, n); });
  std::printf("by rays: %s\n", by_rays.c_str());
}

int run(const char* file) {
  const Scene scene = read_scene(file).value();
  const Mesh mesh = read_mesh(scene.mesh, scene.materials).value();
  auto context = EglContext::create().value();
  std::unique_ptr<ShadowMapPass> pass;
  std::printf("%zu triangles, %s\n", mesh.triangles(), context->description().c_str());
  std::printf("create: %s\n", best([&] { pass = ShadowMapPass::create(*context, mesh).value(); }).c_str());
  for (const auto& [columns, rows] : {std::pair(1, 1), {10, 8}, {13, 11}}) {
    std::vector<ShadowView> views;
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < columns; ++i) {
        const Vec3 e((i - (columns - 1) / 2.0) * 7.5, (k - (rows - 1) / 2.0) * 7.5, 0);
        views.push_back({e, (Vec2(-154, -154) - e.head<2>()) / 150, (Vec2(154, 154) - e.head<2>()) / 150});
      }
    Pose pose = scene.luminaires[0].pose;
    ShadowMaps maps;
    const std::string same = best([&] { maps = pass->draw(pose, views, 192).value(); });
    const std::string moved = best([&] {
      pose(0, 3) += 1;
      maps = pass->draw(pose, views, 192).value();
    });
    std::size_t lit = 0;
    for (const float z : maps.depth_mm) lit += z < 1e30F;
    std::printf("%zu maps of 192x192: %s, moved %s; %zu of %zu texels\n", views.size(), same.c_str(), moved.c_str(),
                lit, maps.depth_mm.size());
  }
  see(scene, mesh, *context);
  return 0;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: shadows_benchmark SCENE.json\n"), 2;
  return lumifield::run(argv[1]);
}
