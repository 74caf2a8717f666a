#include "app/cli/piecewise.h"

#include "app/cli/stop_signal.h"

namespace lumifield {

Status Piecewise::done(double share) {
  constexpr double silent_s = 1, every_s = 0.2;
  if (stop_wished()) return stopped_by_operator(what_);
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  if (elapsed_s < silent_s || elapsed_s < shown_s_ + every_s) return {};
  shown_s_ = elapsed_s;
  line_.show(what_ + " " + share_text(share, elapsed_s), static_cast<int>(10 * share));
  return {};
}

}  // namespace lumifield
