#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/closed_form.h"

namespace lumifield {

/// Of the code that computes references and the form in which they are kept: part of every key, so that none outlives
/// what made it. To be raised with each change that gives ClosedForm other values than rounding does, reads a luminaire
/// in another sense, or changes what a kept file holds.
inline constexpr int reference_version = 2;

/// SHA-256 in hex of everything that a reference follows from: the version, geometry, basis, every value of every cell,
/// the receivers.
std::string reference_key(const LightField& light_field, const std::vector<Receiver>& receivers,
                          int version = reference_version);

/// Irradiance of receivers by the reference, receiver-major, computed once: kept under its key. A folder that cannot be
/// written or a file that is not whole costs the time again, and nothing else.
std::vector<double> cached_reference(const LightField& light_field, const std::vector<Receiver>& receivers,
                                     const std::filesystem::path& folder);

/// $XDG_CACHE_HOME/lumifield, else ~/.cache/lumifield; empty where there is neither.
std::filesystem::path cache_folder();

}  // namespace lumifield
