#pragma once

#include <string>

#include "app/session/scan_session.h"

namespace lumifield {

/// The progress of a scan on stderr: one line that is rewritten on a terminal, else a line each tenth of the way.
class ProgressLine {
 public:
  ProgressLine();
  void show(const ScanProgress& progress);
  /// A line of its own between two of progress.
  void say(const std::string& text);
  void end();

 private:
  bool terminal_;
  int last_tenth_ = -1;
  bool open_ = false;
};

/// The summary as people read it, and as one JSON object.
std::string summary_text(const ScanSummary& summary);
std::string summary_json(const ScanSummary& summary);

}  // namespace lumifield
