#include "app/views/lamp_grip.h"

#include <algorithm>
#include <utility>

#include "app/views/lamp_pose.h"

namespace lumifield {

std::vector<LampHandle> LampGrip::handles(const PictureProjection& view) const {
  std::vector<LampHandle> all;
  for (int k = 0; k < lamps_.count(); ++k)
    if (const auto handle = handle_of(view, k, lamps_.lamp(k), lamps_.shape())) all.push_back(*handle);
  return all;
}

bool LampGrip::point(const PictureProjection& view, const Vec2& px) {
  if (held_) return false;
  const std::optional<LampHit> now = hit(handles(view), px);
  return std::exchange(at_, now) != now;
}

bool LampGrip::point_away() { return !held_ && std::exchange(at_, std::nullopt).has_value(); }

bool LampGrip::grab(const PictureProjection& view, const Vec2& px, Motion motion) {
  held_.reset();
  at_ = hit(handles(view), px);
  if (!at_) return false;
  const ScenePlacement& lamp = lamps_.lamp(at_->lamp);
  held_ = Held{at_->lamp, lamp, at_->part == LampPart::tip ? Motion::turn : motion,
               view,      px,   arrow_mm(view, lamp, lamps_.shape()),
               false};
  lamps_.choose(at_->lamp);
  return true;
}

std::optional<Pose> LampGrip::dragged(const Held& held, const Vec2& px) const {
  const Pose& pose = held.before.pose;
  const Vec3 pivot = lamps_.shape().pivot(), point = transform_point(pose, pivot), beam = beam_of(rigid(pose));
  if (held.motion == Motion::across) return shifted(pose, shift_across(held.view, point, held.from, px));
  if (held.motion == Motion::along) {
    const std::optional<Vec3> shift = shift_along(held.view, point, beam, held.from, px);
    return shift ? std::optional(shifted(pose, *shift)) : std::nullopt;
  }
  const std::optional<Vec3> turned = beam_below(held.view, point, beam, held.arrow_mm, held.from, px);
  return turned ? std::optional(with_beam(pose, pivot, *turned, lamps_.up())) : std::nullopt;
}

void LampGrip::drag(const Vec2& px) {
  if (!held_ || (!held_->moves && (px - held_->from).norm() <= slack_px)) return;
  const std::optional<Pose> pose = dragged(*held_, px);
  if (!pose) return;
  held_->moves = true;
  lamps_.place(held_->lamp, {*pose, held_->before.scale}, true);
}

void LampGrip::release() {
  if (!held_) return;
  held_.reset();
  lamps_.settle();
}

bool LampGrip::cancel() {
  if (!held_) return false;
  const Held was = *std::exchange(held_, std::nullopt);
  if (was.moves) lamps_.place(was.lamp, was.before, false);
  return true;
}

bool LampGrip::step(const PictureProjection& view, Motion motion, int right, int up) {
  if (lamps_.chosen() < 0 || held_) return false;
  ScenePlacement lamp = lamps_.lamp(lamps_.chosen());
  if (motion == Motion::across) {
    lamp.pose = shifted(lamp.pose, step_mm * (right * view.right() + up * view.up()));
  } else if (motion == Motion::along) {
    lamp.pose = shifted(lamp.pose, step_mm * up * beam_of(rigid(lamp.pose)));
  } else {
    LampAngles angles = angles_of(lamp.pose, lamps_.up());
    angles.yaw_deg -= right * step_deg;
    angles.pitch_deg = std::clamp(angles.pitch_deg + up * step_deg, -90.0, 90.0);
    lamp.pose = with_angles(lamp.pose, lamps_.shape().pivot(), angles, lamps_.up());
  }
  lamps_.place(lamps_.chosen(), lamp, true);
  return true;
}

}  // namespace lumifield
