#pragma once

#include <filesystem>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/closed_form.h"

namespace lumifield {

/// Irradiance of receivers by the reference, receiver-major, computed once: kept under the SHA-256 of everything that
/// it follows from (geometry, basis, every value of every cell, the receivers). A folder that cannot be written or a
/// file that is not whole costs the time again, and nothing else.
std::vector<double> cached_reference(const LightField& light_field, const std::vector<Receiver>& receivers,
                                     const std::filesystem::path& folder);

/// $XDG_CACHE_HOME/lumifield, else ~/.cache/lumifield; empty where there is neither.
std::filesystem::path cache_folder();

}  // namespace lumifield
