#pragma once

#include <string>

#include "app/session/scan_session.h"

namespace lumifield {

/// One line, of the whole grid: cells that were there before count as done and are named.
std::string progress_text(const ScanProgress& progress);
std::string done_text(const ScanSummary& summary);

/// The progress of a scan on stderr: one line that is rewritten on a terminal, else a line each tenth of the way and at
/// its end.
class ProgressLine {
 public:
  ProgressLine();
  /// The state `done` is left to `done`: cells are still stored and shown then.
  void show(const ScanProgress& progress);
  /// The last line, once the dataset is closed.
  void done(const ScanSummary& summary);
  /// A line of its own between two of progress.
  void say(const std::string& text);
  void end();

 private:
  void print(const std::string& text);

  bool terminal_;
  int last_tenth_ = -1;
  bool open_ = false;
};

/// The summary as people read it, and as one JSON object.
std::string summary_text(const ScanSummary& summary);
std::string summary_json(const ScanSummary& summary);

}  // namespace lumifield
