#include "app/session/bench_view.h"

#include <utility>

namespace lumifield {

BenchSnapshot BenchView::snapshot() const {
  std::lock_guard lock(mutex_);
  return now_;
}

void BenchView::set_camera(DeviceView camera) {
  std::lock_guard lock(mutex_);
  now_.camera = std::move(camera);
  ++now_.number;
}

void BenchView::set_stage(DeviceView stage) {
  std::lock_guard lock(mutex_);
  now_.stage = std::move(stage);
  ++now_.number;
}

void BenchView::set_stage_mm(const Vec2& stage_mm) {
  std::lock_guard lock(mutex_);
  now_.stage_mm = stage_mm;
  ++now_.number;
}

void BenchView::set_bracket(std::shared_ptr<const Bracket> bracket, std::string place) {
  std::lock_guard lock(mutex_);
  now_.bracket = std::move(bracket);
  now_.place = std::move(place);
  ++now_.number;
}

void BenchView::show(const Bracket& bracket, const std::string& place, const Vec2& stage_mm) {
  set_stage_mm(stage_mm);
  if (watched()) set_bracket(std::make_shared<const Bracket>(bracket), place);
}

}  // namespace lumifield
