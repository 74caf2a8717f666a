#include "luminaire/scene.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "luminaire/file_io.h"
#include "luminaire/json_reader.h"

namespace lumifield {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view format = "lumifield-scene";
constexpr int version = 1;
constexpr std::size_t most_materials = 10'000;

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

Json json_of(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json json_of(const SceneCamera& c) {
  return {{"position_mm", json_of(c.position_mm)},
          {"target_mm", json_of(c.target_mm)},
          {"up", json_of(c.up)},
          {"fov_y_deg", c.fov_y_deg}};
}

Json json_of(const MaterialOverride& material) {
  Json json = Json::object();
  if (material.diffuse) json["diffuse"] = *material.diffuse;
  if (material.specular) json["specular"] = *material.specular;
  if (material.roughness) json["roughness"] = *material.roughness;
  if (material.exponent) json["exponent"] = *material.exponent;
  return json;
}

Json json_of(const ScenePlacement& placement) {
  Json pose = Json::array();
  for (int k = 0; k < 16; ++k) pose.push_back(placement.pose(k / 4, k % 4));
  return {{"pose", std::move(pose)}, {"scale", placement.scale}};
}

/// The name of `file` in a scene file of `folder`.
Result<std::string> name_in(const std::filesystem::path& folder, const std::filesystem::path& file,
                            std::string_view member) {
  std::error_code code;
  const std::filesystem::path from = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, code);
  const std::filesystem::path relative = std::filesystem::weakly_canonical(file, code).lexically_relative(from);
  if (code || relative.empty() || *relative.begin() == "..")
    return fail("the scene's " + std::string(member) + " " + file.string() + " lies outside the folder",
                folder.string(), "save the scene beside it or in a folder above, or copy the file there first");
  return relative.string();
}

}  // namespace

Result<Scene> parse_scene(std::string_view json, std::string_view name, const std::filesystem::path& folder,
                          std::vector<std::string>* notes, ReaderNotes kind) {
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
  const JsonValue scale = root["environment_scale"];
  if (scale.present()) scene.environment_scale = scale.number(not_negative);
  if (scale.present() && !scene.environment) scale.note_no_effect("without \"environment\"");
  if (Status ok = document->finish(notes, kind); !ok) return tl::unexpected(ok.error());
  return scene;
}

Result<Scene> read_scene(const std::filesystem::path& file, std::vector<std::string>* notes, ReaderNotes kind) {
  const Result<std::string> text = read_file(file, JsonLimits{}.bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_scene(*text, file.string(), file.parent_path(), notes, kind);
}

Result<std::string> to_json(const Scene& scene, const std::filesystem::path& folder) {
  Json json{{"format", format}, {"version", version}, {"name", scene.name}};
  const Result<std::string> mesh = name_in(folder, scene.mesh, "mesh");
  if (!mesh) return tl::unexpected(mesh.error());
  json["mesh"] = *mesh;
  json["materials"] = Json::object();
  for (const auto& [name, material] : scene.materials) json["materials"][name] = json_of(material);
  json["camera"] = json_of(scene.camera);
  json["luminaires"] = Json::array();
  for (const ScenePlacement& each : scene.luminaires) json["luminaires"].push_back(json_of(each));
  if (scene.environment) {
    const Result<std::string> environment = name_in(folder, *scene.environment, "environment");
    if (!environment) return tl::unexpected(environment.error());
    json["environment"] = *environment;
  }
  if (scene.environment_scale != 1) json["environment_scale"] = scene.environment_scale;
  std::string text = json_file_text(json);
  if (const Result<Scene> read = parse_scene(text, "scene", folder); !read) return tl::unexpected(read.error());
  return text;
}

Status write_scene(const Scene& scene, const std::filesystem::path& file) {
  const Result<std::string> text = to_json(scene, file.parent_path());
  if (!text) return tl::unexpected(text.error());
  return write_file_durably(file, *text);
}

}  // namespace lumifield
