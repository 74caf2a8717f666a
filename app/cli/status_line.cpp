#include "app/cli/status_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace lumifield {

StatusLine::StatusLine() : terminal_(isatty(STDERR_FILENO) != 0) {}

void StatusLine::show(const std::string& text, int tenth) {
  if (!terminal_ && tenth == last_tenth_) return;
  last_tenth_ = tenth;
  show(text);
}

void StatusLine::show(const std::string& text) {
  // What is left of a longer line is erased.
  std::fprintf(stderr, terminal_ ? "\r%s\033[K" : "%s\n", text.c_str());
  std::fflush(stderr);
  open_ = terminal_;
}

void StatusLine::say(const std::string& text) {
  end();
  std::fprintf(stderr, "%s\n", text.c_str());
}

void StatusLine::end() {
  if (open_) std::fputc('\n', stderr);
  open_ = false;
}

std::string minutes_text(double seconds) {
  const long s = std::lround(std::max(0.0, seconds));
  char text[32];
  std::snprintf(text, sizeof text, "%ld:%02ld", s / 60, s % 60);
  return text;
}

std::string share_text(double share, double elapsed_s) {
  char text[16];
  std::snprintf(text, sizeof text, "%3.0f %%, ", 100 * share);
  const std::string left = share > 0 ? ", " + minutes_text(elapsed_s * (1 - share) / share) + " left" : "";
  return text + minutes_text(elapsed_s) + " elapsed" + left;
}

}  // namespace lumifield
