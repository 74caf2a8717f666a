#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"

namespace lumifield {

/// Of the code that computes references and the form in which they are kept: part of every key, so that none outlives
/// what made it. To be raised with each change that gives ClosedForm other values than rounding does, reads a luminaire
/// in another sense, or changes what a kept file holds.
inline constexpr int reference_version = 2;

/// SHA-256 in hex of everything that a reference follows from: the version, geometry, basis, every value of every cell,
/// the receivers and their lobes and tiles.
std::string reference_key(const LightField& light_field, const std::vector<Receiver>& receivers,
                          const Appearance& appearance = {}, int version = reference_version);

/// Light of receivers by the reference, receiver-major, the irradiance of all before the radiance by gloss; computed
/// once: kept under its key. A folder that cannot be written or a file that is not whole costs the time again, and
/// nothing else. What receivers see by points (Appearance::sees) has no key, and is no part of it. Errors: out of
/// memory.
Result<std::vector<double>> cached_reference(const LightField& light_field, const std::vector<Receiver>& receivers,
                                             const Appearance& appearance, const std::filesystem::path& folder);

/// $XDG_CACHE_HOME/lumifield, else ~/.cache/lumifield; empty where there is neither.
std::filesystem::path cache_folder();

}  // namespace lumifield
