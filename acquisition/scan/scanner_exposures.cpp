// What the scanner exposes: scanner.h, "Exposures".
#include <algorithm>
#include <utility>

#include "acquisition/scan/scanner.h"
#include "acquisition/scan/stretch.h"

namespace lumifield {

Result<Bracket> Scanner::expose_bracket(const Vec2& stage_mm, const std::string& place, Exposures exposures) {
  enter(ScanState::exposing);
  const bool all = exposures == Exposures::ladder;
  const std::size_t begin = all ? 0 : ladder_.plan_begin, end = all ? ladder_.size() : ladder_.plan_end;
  Bracket bracket;
  bracket.reserve(end - begin);
  for (std::size_t k = begin; k < end; ++k) {
    Result<RawImage> frame = expose_at(ladder_.exposures_s[k], stage_mm, place);
    if (!frame) return tl::unexpected(std::move(frame).error());
    bracket.push_back(std::move(*frame));
  }
  if (exposures == Exposures::adapted)
    if (Status adapted = adapt(bracket, stage_mm, place); !adapted) return tl::unexpected(std::move(adapted).error());
  return bracket;
}

/// Goes beyond the plan's exposures at either end, as far as the frame there asks for it.
Status Scanner::adapt(Bracket& bracket, const Vec2& stage_mm, const std::string& place) {
  const std::vector<double>& exposures_s = ladder_.exposures_s;
  const double share = plan_.limits.saturated_share;

  for (std::size_t k = ladder_.plan_begin; k > 0 && is_saturated(bracket.front(), bench_.sensor, share); --k) {
    Result<RawImage> frame = expose_at(exposures_s[k - 1], stage_mm, place);
    if (!frame) return tl::unexpected(std::move(frame).error());
    bracket.insert(bracket.begin(), std::move(*frame));
  }
  for (std::size_t k = ladder_.plan_end; k < exposures_s.size(); ++k) {
    const double ratio = exposures_s[k] / exposures_s[k - 1];
    if (!may_be_longer(bracket.back(), dark_->bracket[k - 1], ratio, bench_.sensor, share)) break;
    Result<RawImage> frame = expose_at(exposures_s[k], stage_mm, place);
    if (!frame) return tl::unexpected(std::move(frame).error());
    bracket.push_back(std::move(*frame));
  }
  return {};
}

Result<RawImage> Scanner::expose_at(double exposure_s, const Vec2& stage_mm, const std::string& place) {
  if (end_.stop_requested()) return scan_stopped();
  camera().tell_place(stage_mm);
  Result<RawImage> frame = expose_frame(exposure_s);
  if (!frame) return blame(Culprit::camera, place, std::move(frame).error());
  frame->stage_mm = stage_mm;
  return frame;
}

Result<RawImage> Scanner::expose_frame(double exposure_s) {
  const double begin_s = clock_.now_s();
  Result<RawImage> frame = camera().expose(exposure_s);
  if (!frame) return frame;
  const double spent_s = clock_.now_s() - begin_s;
  const double exposed_s = std::min(frame->exposure_s, spent_s);
  timing_.exposure_s += exposed_s;
  timing_.readout_s += std::min(spent_s - exposed_s, bench_.camera.readout_s);
  return frame;
}

}  // namespace lumifield
