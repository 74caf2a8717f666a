#pragma once

#include <optional>
#include <string>

#include "luminaire/bench.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// What the provenance of a dataset binds a scan to that resumes it: cells measured under other conditions do not
/// belong into one luminaire.

/// Refuses a bench or a plan that measures otherwise than those of the last scan on record, naming the first member
/// that differs. Addresses, names, dates, speeds, waiting times and limits may change. Empty text when there is nothing
/// on record to compare with: a note for the operator otherwise.
Result<std::string> check_same_measurement(const std::string& provenance_json, const Bench& bench, const Plan& plan);

/// The same of the bench that a recording is played back with.
Status check_same_bench(const Bench& recorded, const Bench& bench);

/// The first reading of the reference cell through this pass on record, to which the drift of all scans refers.
std::optional<ReferenceReading> first_reading(const std::string& provenance_json, int pass = 0);

}  // namespace lumifield
