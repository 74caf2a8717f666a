#include "renderer/study/hall.h"

#include <cmath>
#include <numbers>
#include <sstream>

#include "luminaire/file_io.h"

namespace lumifield {

namespace {

constexpr double length_mm = 6000, width_mm = 4000, height_mm = 3000, column_mm = 200;
constexpr int columns = 14;

/// Upright, closed at both ends.
void add_prism(std::ostream& obj, int& corners, double x, double y, double radius, int sides) {
  for (int k = 0; k < sides; ++k) {
    const double a = 2 * std::numbers::pi * (k + 0.5) / sides;
    for (const double z : {0.0, height_mm})
      obj << "v " << x + radius * std::cos(a) << " " << y + radius * std::sin(a) << " " << z << "\n";
  }
  for (int k = 0; k < sides; ++k) {
    const int a = corners + 2 * k + 1, b = corners + 2 * ((k + 1) % sides) + 1;
    obj << "f " << a << " " << b << " " << b + 1 << " " << a + 1 << "\n";
  }
  for (int k = 1; k + 1 < sides; ++k)
    for (const int end : {1, 2})
      obj << "f " << corners + end << " " << corners + 2 * k + end << " " << corners + 2 * k + 2 + end << "\n";
  corners += 2 * sides;
}

}  // namespace

Result<Scene> write_hall(const std::filesystem::path& folder, int sides) {
  std::ostringstream obj;
  int corners = 0;
  add_prism(obj, corners, length_mm / 2, width_mm / 2, length_mm / std::numbers::sqrt2, 4);
  for (int k = 0; k < columns; ++k)
    add_prism(obj, corners, length_mm * (k / 2 + 0.5) / (columns / 2), width_mm * (k % 2 == 0 ? 0.28 : 0.72), column_mm,
              sides);
  Scene scene;
  scene.name = "hall";
  scene.mesh = folder / "hall.obj";
  if (const Status written = write_file_durably(scene.mesh, obj.str()); !written)
    return tl::unexpected(written.error());
  scene.camera.position_mm = {200, 2000, 1700};
  scene.camera.target_mm = {4000, 2000, 900};
  // The beam, +z of the luminaire, along the hall.
  Pose pose = Pose::Identity();
  pose << 0, 0, 1, 900, 1, 0, 0, 2000, 0, 1, 0, 1400, 0, 0, 0, 1;
  scene.luminaires = {{pose, 1}};
  return scene;
}

}  // namespace lumifield
