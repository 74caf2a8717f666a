#pragma once

#include <string>

namespace lumifield {

/// Progress on stderr: one line that is rewritten on a terminal, else a line for each tenth of the way. Thread-bound.
class StatusLine {
 public:
  StatusLine();

  /// `tenth` of the way; not on a terminal only the first text of each is shown.
  void show(const std::string& text, int tenth);
  void show(const std::string& text);
  /// A line of its own between two of progress.
  void say(const std::string& text);
  void end();

 private:
  bool terminal_;
  int last_tenth_ = -1;
  bool open_ = false;
};

/// "1:15", minutes and seconds.
std::string minutes_text(double seconds);
/// " 12 %, 0:05 elapsed, 0:37 left", by the time that the share took; without what is left before there is any.
std::string share_text(double share, double elapsed_s);

}  // namespace lumifield
