#pragma once

#include <filesystem>
#include <string>

#include "renderer/study/study.h"

namespace lumifield {

/// A study as people read it: of each luminaire and method the point of least error, the stability cases that failed;
/// and as one JSON object.
std::string study_summary_text(const Study& study, const std::filesystem::path& out, double time_s);
std::string study_summary_json(const Study& study, const std::filesystem::path& out, double time_s);

}  // namespace lumifield
