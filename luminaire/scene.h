#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "luminaire/reader_notes.h"

namespace lumifield {

/// Overrides one material of the mesh by name; what is unset stays as the MTL file has it. Reflectances are 0 … 1. A
/// roughness makes the gloss GGX's of width roughness², an exponent Phong's; a file gives one of them at most.
struct MaterialOverride {
  std::optional<std::array<double, 3>> diffuse = std::nullopt;
  std::optional<std::array<double, 3>> specular = std::nullopt;  ///< GGX: F0; Phong: k_s
  std::optional<double> roughness = std::nullopt, exponent = std::nullopt;
};
constexpr double least_roughness = 0.03, largest_exponent = 1e5;

struct SceneCamera {
  Vec3 position_mm{0, 0, 0}, target_mm{0, 0, 0}, up{0, 0, 1};
  double fov_y_deg = 45;
};

/// A luminaire placed in the scene. pose: luminaire frame → scene frame, mm, rigid. scale multiplies its light.
struct ScenePlacement {
  Pose pose = Pose::Identity();
  double scale = 1;
};

/// More luminaires are refused.
inline constexpr std::size_t most_luminaires = 1'000;

/// The scene file ("format": "lumifield-scene", version 1). Paths are resolved and lie inside the file's folder.
struct Scene {
  std::string name;
  std::filesystem::path mesh;  ///< OBJ, mm
  std::map<std::string, MaterialOverride> materials;
  SceneCamera camera;
  std::vector<ScenePlacement> luminaires;
  std::optional<std::filesystem::path> environment;  ///< latitude-longitude (renderer/environment/lat_long.h)
  double environment_scale = 1;                      ///< radiance in the luminaire's unit of one unit of the image
};

/// Defaults taken for absent members, and members that are not known or have no effect, are told in `notes`, one text
/// each.
Result<Scene> read_scene(const std::filesystem::path& file, std::vector<std::string>* notes = nullptr,
                         ReaderNotes kind = ReaderNotes::all);
/// `folder` is where relative paths start.
Result<Scene> parse_scene(std::string_view json, std::string_view name, const std::filesystem::path& folder,
                          std::vector<std::string>* notes = nullptr, ReaderNotes kind = ReaderNotes::all);

/// The file's text. Mesh and environment are named relative to `folder`. Errors: one of them lies outside of it; what
/// parse_scene would refuse.
Result<std::string> to_json(const Scene& scene, const std::filesystem::path& folder);
/// On disk as a whole or not at all; read_scene gives the same scene. Errors: those of to_json, the disk's.
Status write_scene(const Scene& scene, const std::filesystem::path& file);

}  // namespace lumifield
