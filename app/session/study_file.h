#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "luminaire/error.h"
#include "renderer/study/study.h"

namespace lumifield {

/// A study on disk: `study.json` ("format": "lumifield-study", version 1), and its lists of results as CSV for other
/// programs. Members are named as those of Study; "omissions" may be absent, as in files of before there were any; a
/// result that is not finite (a refusal has no error, the paper not every number) is null, in CSV an empty field. All
/// functions are reentrant.

inline constexpr std::string_view study_file_name = "study.json";

inline constexpr std::size_t most_study_luminaires = 32;
/// Names of its points: each luminaire's own, that in shadow, and of one some with gloss.
inline constexpr std::size_t most_study_plots = 2 * most_study_luminaires + 8;

/// A name as a study file holds it: bytes that are not UTF-8 are replacement characters, and a text that is too long
/// ends in "…".
std::string study_name(std::string_view text);
/// Of a luminaire: shorter, so that there is room for how it looks.
std::string study_luminaire_name(std::string_view text);

std::string study_json(const Study& study);

/// `name` stands for the file. Refuses other formats and versions, and what is out of range, with its place.
Result<Study> parse_study(std::string_view json, std::string_view name);
Result<Study> read_study(const std::filesystem::path& file);

/// Writes study.json, points.csv, stability.csv and figures.csv into `folder`, made where it is not there. Files of
/// these names are replaced. Refuses, before anything is written, what read_study would refuse, with its place.
Status write_study(const Study& study, const std::filesystem::path& folder);

}  // namespace lumifield
