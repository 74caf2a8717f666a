#pragma once

#include <filesystem>
#include <string>

#include "luminaire/dataset.h"
#include "luminaire/error.h"
#include "luminaire/scene.h"

namespace lumifield {

/// "lumifield: note: …" on stderr.
void print_note(const std::string& note);

/// Reads a scene; what it holds without effect is printed.
Result<Scene> read_noted_scene(const std::filesystem::path& file);
/// Reads a dataset; its notes, and how much of it is unmeasured, are printed. Errors: read_dataset's, and a folder that
/// is none but holds one.
Result<Dataset> read_noted_dataset(const std::filesystem::path& folder);

/// The datasets in a folder, which is none itself: "a.lumi, b.lumi"; empty where there are none.
std::string datasets_within(const std::filesystem::path& folder);

}  // namespace lumifield
