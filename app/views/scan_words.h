#pragma once

#include <QString>

#include "app/session/rehearsal.h"
#include "app/views/scan_activity.h"
#include "luminaire/light_field.h"

class QDateTime;

namespace lumifield {

/// A scan's state and figures in words, for the window. Reentrant.

/// What the bench is doing: "Exposing cell (3, 4)".
QString bench_words(ScanActivity activity, const ScanProgress& progress);

/// What a rehearsal told, in one line: corners, test shot, reference cell, and what the scan will take.
QString rehearsal_text(const Rehearsal& told);
/// "63 cells, about 01:45, up to 45.4 MB of the 82.6 GB that are free"; says so where there is too little room.
QString prediction_text(const ScanPrediction& scan);

/// "03:25", from an hour on "1:03:25"; "—" when not a number or negative.
QString duration_text(double seconds);

/// "14:32"; with the weekday on another day than `now`, with the date from a week on.
QString clock_text(const QDateTime& when, const QDateTime& now);

/// "12.3 GB", 1 GB = 10⁹ bytes.
QString bytes_text(double bytes);

/// "+0.35 %".
QString drift_text(double drift);

/// What a disk is good for: "room for 5 scans" from one scan of `cells` on, else "room for 12 cells".
QString room_text(double free_bytes, double cell_bytes, int cells);

}  // namespace lumifield
