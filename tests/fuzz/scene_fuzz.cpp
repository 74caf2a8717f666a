#include <cstdint>
#include <cstdlib>

#include "luminaire/scene.h"

/// No path of a scene file that is read leads out of its folder.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto scene = lumifield::parse_scene(text, "scene.json", "/nowhere/scenes");
  if (!scene) return 0;
  const std::string mesh = scene->mesh.lexically_normal().string();
  if (mesh.rfind("/nowhere/scenes", 0) != 0) std::abort();
  return 0;
}
