#pragma once

#include <string>

#include "app/session/scan_session.h"

namespace lumifield {

/// What a dataset keeps of its making, one JSON object: `scans`, each with program, bench, plan, devices, times, drift
/// of the reference. `earlier` is the object so far: a scan that started at the same instant is replaced, a resumed one
/// added.
std::string provenance_json(const std::string& earlier, const ScanRequest& request, const ScanSummary& summary,
                            const std::string& started_utc);

/// "2026-01-31T12:34:56Z"
std::string utc_now();

}  // namespace lumifield
