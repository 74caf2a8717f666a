#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli/status_line.h"
#include "app/session/scan_session.h"

namespace lumifield {

/// One line, of the whole grid: cells that were there before count as done and are named.
std::string progress_text(const ScanProgress& progress);
std::string done_text(const ScanSummary& summary);

/// "20 cells, about 0:12, up to 3.6 MB of 82600.0 MB that are free", and what recorded frames take;
/// says so where there is too little room.
std::string prediction_line(const ScanPrediction& scan);
nlohmann::ordered_json prediction_json(const ScanPrediction& scan);

/// How to go on with a scan that ended by `error`: "5 of 20 cells are kept; when that is mended, run again with
/// --resume to go on". Empty where nothing is kept. `homes`: a scan that goes on homes the stage.
std::string go_on_text(const ScanKept& kept, const Error& error, bool homes);

/// The progress of a scan on stderr; its end is always told.
class ProgressLine {
 public:
  /// The state `done` is left to `done`: cells are still stored and shown then.
  void show(const ScanProgress& progress);
  /// The last line, once the dataset is closed.
  void done(const ScanSummary& summary);
  void say(const std::string& text) { line_.say(text); }
  void end() { line_.end(); }

 private:
  StatusLine line_;
};

/// The summary as people read it, and as one JSON object.
std::string summary_text(const ScanSummary& summary);
std::string summary_json(const ScanSummary& summary);

}  // namespace lumifield
