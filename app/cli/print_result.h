#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "renderer/methods/method.h"

namespace lumifield {

/// JSON text in one line; bytes that are not UTF-8, as of paths, become replacement characters.
std::string dump_json(const nlohmann::ordered_json& json);

/// The end of a sub-command: its result on stdout as one JSON object or in `words`, or its error. Returns the exit
/// code.
int print_result(const Result<nlohmann::ordered_json>& result, bool json,
                 const std::function<std::string(const nlohmann::ordered_json&)>& words);

/// What a summary says of a method: what it has use for.
nlohmann::ordered_json method_summary(const MethodSettings& settings);
/// The same for people: "mis with 200 samples".
std::string method_words(const nlohmann::ordered_json& summary);

}  // namespace lumifield
