#pragma once

#include <string>

#include "app/session/scan_session.h"

namespace lumifield {

/// What a dataset keeps of its making, one JSON object: `scans`, each with program, bench, plan, the readings of the
/// reference cell so far, and once it has ended, with devices and times. Adds one scan to `earlier`, the object before
/// it; `ended` is null while the scan runs. Text of a device that is not UTF-8 is kept with replacement characters.
std::string provenance_json(const std::string& earlier, const ScanRequest& request, const std::string& started_utc,
                            const std::vector<ReferenceReading>& readings, const ScanSummary* ended);

/// "2026-01-31T12:34:56Z"
std::string utc_now();

}  // namespace lumifield
