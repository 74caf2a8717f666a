// Frames a second of the method shift-invariant, as Granier et al. 2003, Table 1 has them: 400×400 pixels, 5×5, 7×7 and
// 9×7 cells of 300×300, scenes of some 500 and 8,000 polygons. Not a test: run it alone on the machine.
//
//   shift_invariant_benchmark PILLARS/scene.json [cells per pass]...

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "luminaire/scene.h"
#include "renderer/renderer.h"
#include "renderer/scene/mesh.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {
namespace {

constexpr int size_px = 400;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A hall with columns of ten sides, some 500 triangles, where the other scene's camera and lamp stand in it.
Scene hall_in_place_of(const Scene& other, const Mesh& mesh) {
  Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
  for (const Vertex& v : mesh.vertices) {
    const Vec3 p(v.position_mm[0], v.position_mm[1], v.position_mm[2]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto folder = std::filesystem::temp_directory_path() / "lumifield-shift-invariant-benchmark";
  std::filesystem::create_directories(folder);
  std::ofstream obj(folder / "hall.obj");
  int corners = 0;
  const auto prism = [&](const Vec2& at, double radius, int sides, double bottom, double top) {
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * std::numbers::pi * (k + 0.5) / sides;
      for (const double z : {bottom, top})
        obj << "v " << at.x() + radius * std::cos(a) << " " << at.y() + radius * std::sin(a) << " " << z << "\n";
    }
    for (int k = 0; k < sides; ++k) {
      const int a = corners + 2 * k + 1, b = corners + 2 * ((k + 1) % sides) + 1;
      obj << "f " << a << " " << b << " " << b + 1 << " " << a + 1 << "\n";
    }
    for (int k = 1; k + 1 < sides; ++k)
      for (const int end : {1, 2})
        obj << "f " << corners + end << " " << corners + 2 * k + end << " " << corners + 2 * k + 2 + end << "\n";
    corners += 2 * sides;
  };
  const Vec3 middle = (low + high) / 2, size = high - low;
  prism(middle.head<2>(), size.head<2>().norm() / 2, 4, low.z(), high.z());
  for (int k = 0; k < 14; ++k)
    prism({low.x() + size.x() * (k / 2 + 0.5) / 7, low.y() + size.y() * (k % 2 ? 0.72 : 0.28)}, 0.035 * size.x(), 10,
          low.z(), high.z());
  obj.close();
  Scene scene = other;
  scene.mesh = (folder / "hall.obj").string();
  scene.materials.clear();
  return scene;
}

struct Timed {
  double cached_s = 0, moved_s = 0;  ///< a frame, the best of five: of another view, and with the lamp moved
};

Timed frames(const Scene& scene, const LightField& field, Visibility visibility, const SpotSettings& spots) {
  auto renderer = Renderer::create(scene, size_px, size_px).value();
  if (!renderer->set_method({.method = Method::shift_invariant, .spots = spots}) ||
      !renderer->set_visibility(visibility) || !renderer->set_luminaire(field.geometry()) || !renderer->add_all(field))
    std::exit(1);
  SceneCamera camera = scene.camera;
  std::vector<ScenePlacement> placements = scene.luminaires;
  Timed best{HUGE_VAL, HUGE_VAL};
  for (int k = 0; k < 6; ++k) {
    const auto start = std::chrono::steady_clock::now();
    camera.target_mm.x() += 1;
    if (!renderer->set_view(camera, size_px, size_px) || !renderer->picture()) std::exit(1);
    if (k > 0) best.cached_s = std::min(best.cached_s, seconds_since(start));
    const auto moved = std::chrono::steady_clock::now();
    placements[0].pose(0, 3) += 1;
    if (!renderer->set_placements(placements) || !renderer->set_view(camera, size_px, size_px) || !renderer->picture())
      std::exit(1);
    if (k > 0) best.moved_s = std::min(best.moved_s, seconds_since(moved));
  }
  return best;
}

LightField luminaire(int columns, int rows) {
  return make_luminaire({.name = "bike", .columns = columns, .rows = rows}, 3);
}

int run(int argc, char** argv) {
  const Scene pillars = read_scene(argv[1]).value();
  const Mesh mesh = read_mesh(pillars.mesh, pillars.materials).value();
  const Scene hall = hall_in_place_of(pillars, mesh);
  std::vector<int> per_pass;
  for (int k = 2; k < argc; ++k) per_pass.push_back(std::atoi(argv[k]));
  if (per_pass.empty()) per_pass.push_back(SpotSettings{}.cells_per_pass);
  double load[3] = {};
  (void)getloadavg(load, 3);
  std::printf("%s; %dx%d, load %.2f\n", probe_opengl().value().c_str(), size_px, size_px, load[0]);
  for (const auto& [columns, rows] : {std::pair(5, 5), {7, 7}, {9, 7}}) {
    const LightField field = luminaire(columns, rows);
    for (const Scene* scene : {&hall, &pillars})
      for (const Visibility visibility : {Visibility::none, Visibility::tile})
        for (const int x : per_pass) {
          SpotSettings spots{.look_up = SpotLookUp::textured, .cells_per_pass = x};
          const Timed t = frames(*scene, field, visibility, spots);
          const double cells = columns * rows;
          std::printf("%dx%d cells, %zu triangles, %s, X = %d: %.1f frames/s (%.1f ms, %.2f ms a cell)", columns, rows,
                      scene == &hall ? read_mesh(hall.mesh, {}).value().triangles() : mesh.triangles(),
                      visibility == Visibility::none ? "no shadows" : "shadows", x, 1 / t.cached_s, 1e3 * t.cached_s,
                      1e3 * t.cached_s / cells);
          if (visibility != Visibility::none)
            std::printf("; maps drawn anew %.1f frames/s (%.1f ms, %.2f ms a cell)", 1 / t.moved_s, 1e3 * t.moved_s,
                        1e3 * t.moved_s / cells);
          std::printf("\n");
          std::fflush(stdout);
        }
  }
  return 0;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: shift_invariant_benchmark PILLARS/scene.json [X]...\n"), 2;
  return lumifield::run(argc, argv);
}
