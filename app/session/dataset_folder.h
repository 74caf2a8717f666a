#pragma once

#include <filesystem>

#include "luminaire/error.h"

namespace lumifield {

/// Removes a dataset that holds no cell, file by file: manifest, journal, `cells/`, folder. Refuses, and removes
/// nothing, when there is anything else in it.
Status remove_empty_dataset(const std::filesystem::path& folder);

}  // namespace lumifield
