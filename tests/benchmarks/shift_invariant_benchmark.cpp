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

/// Of a frame, the best of some each.
struct Timed {
  double frame_s = HUGE_VAL;
  double view_s = HUGE_VAL, receivers_s = HUGE_VAL, passes_s = HUGE_VAL, picture_s = HUGE_VAL;

  void take(const Timed& other) {
    frame_s = std::min(frame_s, other.frame_s);
    view_s = std::min(view_s, other.view_s);
    receivers_s = std::min(receivers_s, other.receivers_s);
    passes_s = std::min(passes_s, other.passes_s);
    picture_s = std::min(picture_s, other.picture_s);
  }
};

void must(const Status& done) {
  if (!done) std::fprintf(stderr, "%s\n", done.error().message().c_str()), std::exit(1);
}

/// Of another view, part by part.
Timed frame(Renderer& renderer, const SceneCamera& camera) {
  Timed t;
  const auto start = std::chrono::steady_clock::now();
  must(renderer.set_view(camera, size_px, size_px));
  t.view_s = seconds_since(start);
  must(renderer.hand_over());
  t.receivers_s = seconds_since(start) - t.view_s;
  const auto passes = std::chrono::steady_clock::now();
  must(renderer.sum_some(HUGE_VAL));
  t.passes_s = seconds_since(passes);
  const auto last = std::chrono::steady_clock::now();
  if (!renderer.picture()) std::exit(1);
  t.picture_s = seconds_since(last);
  t.frame_s = seconds_since(start);
  return t;
}

/// With depth maps as they are, and with the lamp moved before each.
std::pair<Timed, Timed> frames(const Scene& scene, const LightField& field, Visibility visibility,
                               const SpotSettings& spots) {
  auto renderer = Renderer::create(scene, size_px, size_px).value();
  must(renderer->set_method({.method = Method::shift_invariant, .spots = spots}));
  must(renderer->set_visibility(visibility));
  must(renderer->set_luminaire(field.geometry()));
  must(renderer->add_all(field));
  SceneCamera camera = scene.camera;
  std::vector<ScenePlacement> placements = scene.luminaires;
  Timed kept, moved;
  for (int k = 0; k < 9; ++k) {
    camera.target_mm.x() += 1;
    kept.take(frame(*renderer, camera));
    placements[0].pose(0, 3) += 1;
    must(renderer->set_placements(placements));
    moved.take(frame(*renderer, camera));
  }
  return {kept, moved};
}

LightField luminaire(int columns, int rows, int channels) {
  return make_luminaire({.name = "bike", .columns = columns, .rows = rows}, channels);
}

int run(int argc, char** argv) {
  const Scene pillars = read_scene(argv[1]).value();
  const Mesh mesh = read_mesh(pillars.mesh, pillars.materials).value();
  const Scene hall = hall_in_place_of(pillars, mesh);
  std::vector<int> per_pass;
  for (int k = 2; k < argc; ++k) per_pass.push_back(std::atoi(argv[k]));
  if (per_pass.empty()) per_pass.push_back(SpotSettings{}.cells_per_pass);
  const std::size_t hall_triangles = read_mesh(hall.mesh, {}).value().triangles();
  double load[3] = {};
  (void)getloadavg(load, 3);
  std::printf("%s; %dx%d, load %.2f\n", probe_opengl().value().c_str(), size_px, size_px, load[0]);
  std::printf("%-6s %-9s %-8s %-3s %-3s %9s %9s %8s   %s\n", "cells", "triangles", "shadows", "RGB", "X", "frames/s",
              "frame ms", "ms/cell", "view + receivers + passes + picture, ms; with depth maps drawn anew");
  for (const auto& [columns, rows] : {std::pair(5, 5), {7, 7}, {9, 7}})
    for (const Scene* scene : {&hall, &pillars})
      for (const Visibility visibility : {Visibility::none, Visibility::tile})
        for (const int channels : {3, 1})
          for (const int x : per_pass) {
            const LightField field = luminaire(columns, rows, channels);
            const SpotSettings spots{.look_up = SpotLookUp::textured, .cells_per_pass = x};
            const auto [t, moved] = frames(*scene, field, visibility, spots);
            const bool shadows = visibility != Visibility::none;
            std::printf("%dx%-4d %-9zu %-8s %-3s %-3d %9.1f %9.1f %8.2f   %.1f + %.1f + %.1f + %.1f", columns, rows,
                        scene == &hall ? hall_triangles : mesh.triangles(), shadows ? "yes" : "no",
                        channels == 3 ? "yes" : "no", x, 1 / t.frame_s, 1e3 * t.frame_s,
                        1e3 * t.passes_s / (columns * rows), 1e3 * t.view_s, 1e3 * t.receivers_s, 1e3 * t.passes_s,
                        1e3 * t.picture_s);
            if (shadows)
              std::printf("; %.1f frames/s, %.2f ms/cell", 1 / moved.frame_s,
                          1e3 * (moved.passes_s + moved.receivers_s) / (columns * rows));
            std::printf("\n");
            std::fflush(stdout);
          }
  return 0;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: shift_invariant_benchmark PILLARS/scene.json [X]...\n"), 2;
  return lumifield::run(argc, argv);
}
