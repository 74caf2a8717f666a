#include "luminaire/scene.h"

#include <Eigen/Geometry>

#include "luminaire/file_io.h"
#include "luminaire/json_reader.h"

namespace lumifield {
namespace {

constexpr std::string_view format = "lumifield-scene";
constexpr int version = 1;
constexpr std::size_t most_materials = 10'000, most_luminaires = 1'000;

/// A file named by the scene, inside the scene's folder.
std::filesystem::path read_path(const JsonValue& at, const std::filesystem::path& folder) {
  const std::string text = at.text();
  const Result<std::filesystem::path> path = path_inside(folder, text, at.place());
  if (path) return *path;
  at.refuse(path.error().what, path.error().remedy);
  return {};
}

std::map<std::string, MaterialOverride> read_materials(const JsonValue& at) {
  std::map<std::string, MaterialOverride> materials;
  if (!at.present()) {
    at.note_default("{}");
    return materials;
  }
  for (const std::string& name : at.keys(most_materials)) {
    MaterialOverride& material = materials[name];
    const auto colour = [&](const char* member) -> std::optional<std::array<double, 3>> {
      const JsonValue value = at[name][member];
      if (!value.present()) return std::nullopt;
      const Vec3 v = value.vec3(share);
      return std::array{v.x(), v.y(), v.z()};
    };
    material.diffuse = colour("diffuse");
    material.specular = colour("specular");
    const JsonValue roughness = at[name]["roughness"], exponent = at[name]["exponent"];
    if (roughness.present()) material.roughness = roughness.number({least_roughness, 1});
    if (exponent.present()) material.exponent = exponent.number({1, largest_exponent});
    if (roughness.present() && exponent.present())
      exponent.refuse("stands beside a roughness", "give one of them: roughness for GGX, exponent for Phong");
  }
  return materials;
}

SceneCamera read_camera(const JsonValue& at) {
  SceneCamera c;
  c.position_mm = at["position_mm"].vec3();
  c.target_mm = at["target_mm"].vec3();
  c.up = at["up"].vec3_or(c.up);
  c.fov_y_deg = at["fov_y_deg"].number_or(c.fov_y_deg, {0.01, 179});
  const Vec3 view = c.target_mm - c.position_mm;
  if (view.norm() == 0) at["target_mm"].refuse("is the camera's own position", "move the target or the camera");
  if (!(c.up.cross(view).norm() > 1e-9 * c.up.norm() * view.norm()))
    at["up"].refuse("is zero or along the view", "choose another direction");
  return c;
}

}  // namespace

Result<Scene> parse_scene(std::string_view json, std::string_view name, const std::filesystem::path& folder,
                          std::vector<std::string>* notes) {
  Result<JsonDocument> document = JsonDocument::parse(json, name);
  if (!document) return tl::unexpected(document.error());
  document->note_unknown_keys();
  if (Status ok = document->check_format(format, version); !ok) return tl::unexpected(ok.error());
  const JsonValue root = document->root();
  Scene scene;
  scene.name = root["name"].text_or("");
  scene.mesh = read_path(root["mesh"], folder);
  scene.materials = read_materials(root["materials"]);
  scene.camera = read_camera(root["camera"]);
  for (const JsonValue& each : root["luminaires"].elements(0, most_luminaires))
    scene.luminaires.push_back({each["pose"].rigid_pose(), each["scale"].number_or(1, not_negative)});
  if (root["environment"].present()) scene.environment = read_path(root["environment"], folder);
  if (Status ok = document->finish(notes); !ok) return tl::unexpected(ok.error());
  return scene;
}

Result<Scene> read_scene(const std::filesystem::path& file, std::vector<std::string>* notes) {
  const Result<std::string> text = read_file(file, JsonLimits{}.bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_scene(*text, file.string(), file.parent_path(), notes);
}

}  // namespace lumifield
