#pragma once

#include <filesystem>

#include "luminaire/scene.h"

namespace lumifield {

/// A hall of 6 × 6 × 3 m with fourteen columns of so many sides, a lamp and an eye in it: 56·sides − 44 triangles.
/// Writes hall.obj into the folder. Errors: it cannot be written.
Result<Scene> write_hall(const std::filesystem::path& folder, int sides);

}  // namespace lumifield
