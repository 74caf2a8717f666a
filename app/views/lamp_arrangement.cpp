#include "app/views/lamp_arrangement.h"

#include <algorithm>
#include <utility>

#include "app/views/lamp_pose.h"

namespace lumifield {
namespace {

/// From a lamp to its copy, of the lamp's width, but at least so far.
constexpr double copy_widths = 1.5, least_copy_mm = 100;

}  // namespace

LampArrangement::LampArrangement(QObject* parent) : QObject(parent) {
  rest_.setSingleShot(true);
  rest_.setInterval(rest_ms);
  connect(&rest_, &QTimer::timeout, this, [this] { emit placed(lamps_, false); });
}

void LampArrangement::set_scene(std::vector<ScenePlacement> own, const Vec3& up) {
  rest_.stop();
  lamps_ = own_ = std::move(own);
  up_ = up;
  chosen_ = -1;
  emit replaced();
  emit changed();
}

void LampArrangement::set_shape(const LampShape& shape) {
  shape_ = shape;
  emit replaced();
  emit changed();
}

void LampArrangement::place(int number, const ScenePlacement& lamp, bool moving) {
  lamps_.at(static_cast<std::size_t>(number)) = lamp;
  tell(moving);
}

void LampArrangement::tell(bool moving) {
  if (moving)
    rest_.start();
  else
    rest_.stop();
  emit placed(lamps_, moving);
  emit changed();
}

void LampArrangement::settle() {
  if (!rest_.isActive()) return;
  rest_.stop();
  emit placed(lamps_, false);
}

void LampArrangement::choose(int number) {
  if (number < 0 || number >= count()) number = -1;
  if (std::exchange(chosen_, number) != number) emit changed();
}

void LampArrangement::choose_next(int step) {
  if (count() == 0) return;
  choose(chosen_ < 0 ? (step > 0 ? 0 : count() - 1) : (chosen_ + step + count()) % count());
}

void LampArrangement::add_copy() {
  if (!can_add()) return;
  ScenePlacement copy = chosen_ >= 0 ? lamp(chosen_) : lamps_.back();
  const double away = std::max(2 * copy_widths * shape_.half_mm.x(), least_copy_mm);
  copy.pose = shifted(copy.pose, away * copy.pose.block<3, 1>(0, 0));
  lamps_.push_back(copy);
  chosen_ = count() - 1;
  tell(false);
}

void LampArrangement::remove_chosen() {
  if (!can_remove()) return;
  lamps_.erase(lamps_.begin() + chosen_);
  chosen_ = std::min(chosen_, count() - 1);
  emit replaced();
  tell(false);
}

void LampArrangement::back_to_scene() {
  lamps_ = own_;
  if (chosen_ >= count()) chosen_ = -1;
  emit replaced();
  tell(false);
}

}  // namespace lumifield
