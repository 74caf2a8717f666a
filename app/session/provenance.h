#pragma once

#include <optional>
#include <string>

#include "app/session/scan_session.h"

namespace lumifield {

/// What a dataset keeps of its making, one JSON object: `scans`, each with program, bench, plan, the readings of the
/// reference cell so far, and once it has ended, with devices and times. Adds one scan to `earlier`, the object before
/// it; `ended` is null while the scan runs. Text of a device that is not UTF-8 is kept with replacement characters.
std::string provenance_json(const std::string& earlier, const ScanRequest& request, const std::string& started_utc,
                            const std::vector<ReferenceReading>& readings, const ScanSummary* ended);

/// Of what a dataset keeps of its making: the largest drift of the reference cell, and the limit of the plan by which
/// it was scanned then. Empty where no reading is on record.
struct RecordedDrift {
  double drift = 0, limit = 0;
};
std::optional<RecordedDrift> largest_drift(const std::string& provenance_json);

/// "2026-01-31T12:34:56Z"
std::string utc_now();

}  // namespace lumifield
