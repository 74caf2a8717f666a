#include <cstdint>
#include <cstdlib>

#include "luminaire/scene.h"

/// No path of a scene file that is read leads out of its folder; what is written of it is read again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto scene = lumifield::parse_scene(text, "scene.json", "/nowhere/scenes");
  if (!scene) return 0;
  const std::string mesh = scene->mesh.lexically_normal().string();
  if (mesh.rfind("/nowhere/scenes", 0) != 0) std::abort();
  const auto written = lumifield::to_json(*scene, "/nowhere/scenes");
  if (!written) return 0;  // a name that is too long for the disk
  const auto again = lumifield::parse_scene(*written, "written.json", "/nowhere/scenes");
  if (!again || again->luminaires.size() != scene->luminaires.size()) std::abort();
  return 0;
}
