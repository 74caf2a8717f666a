#include <QKeyEvent>
#include <QMouseEvent>
#include <QWheelEvent>

#include "app/views/preview_view.h"

namespace lumifield {

void PreviewView::set_drag(Drag drag) {
  drag_ = drag;
  dragged_ = false;
  show_cursor();
}

void PreviewView::show_cursor() {
  if (drag_ != Drag::none) return setCursor(Qt::ClosedHandCursor);
  if (!grip_.at()) return setCursor(Qt::CrossCursor);
  setCursor(grip_.at()->part == LampPart::tip ? Qt::PointingHandCursor : Qt::OpenHandCursor);
}

void PreviewView::mousePressEvent(QMouseEvent* event) {
  // A lamp that is held stays so, whatever other button comes.
  if (!has_scene_ || drag_ == Drag::lamp || press_lamp(event)) return;
  const bool pan = event->button() != Qt::LeftButton || event->modifiers().testFlag(Qt::ShiftModifier);
  set_drag(pan ? Drag::pan : Drag::orbit);
  cursor_ = event->position();
}

void PreviewView::mouseMoveEvent(QMouseEvent* event) {
  const QPointF moved = event->position() - cursor_;
  cursor_ = event->position();
  cursor_inside_ = true;
  lamp_stepped_ = false;
  if (drag_ == Drag::lamp) grip_.drag({cursor_.x(), cursor_.y()});
  if (drag_ == Drag::none) point_at_lamps();
  tell_pointed();
  if (drag_ == Drag::none || drag_ == Drag::lamp || moved.isNull()) return;
  dragged_ = true;
  // What is before the target follows the cursor.
  if (drag_ == Drag::orbit)
    orbit_.orbit(-orbit_deg_per_px * moved.x(), orbit_deg_per_px * moved.y());
  else
    orbit_.pan(moved.x(), moved.y(), view_height());
  camera_moved();
}

void PreviewView::mouseReleaseEvent(QMouseEvent* event) {
  const bool lets_go = drag_ == Drag::lamp ? event->button() == Qt::LeftButton : event->buttons() == Qt::NoButton;
  if (!lets_go) return;
  grip_.release();
  if (drag_ == Drag::orbit && !dragged_) lamps_->choose(-1);
  set_drag(Drag::none);
  point_at_lamps();
  tell_pointed();
}

void PreviewView::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton && drag_ != Drag::lamp && !press_lamp(event)) reset_view();
}

void PreviewView::leaveEvent(QEvent*) {
  cursor_inside_ = false;
  point_at_lamps();
  tell_pointed();
}

void PreviewView::wheelEvent(QWheelEvent* event) {
  constexpr double units_per_step = 120;
  const double steps = event->angleDelta().y() / units_per_step;
  event->accept();
  if (!has_scene_ || steps == 0) return;
  orbit_.zoom(steps, from_centre(event->position()), view_height());
  camera_moved();
}

void PreviewView::keyPressEvent(QKeyEvent* event) {
  if (lamp_key(event)) return;
  const bool pan = event->modifiers().testFlag(Qt::ShiftModifier);
  const auto move_eye = [&](double right, double up) {
    if (pan)
      orbit_.pan(-pan_px_per_key * right, pan_px_per_key * up, view_height());
    else
      orbit_.orbit(orbit_deg_per_key * right, orbit_deg_per_key * up);
    camera_moved();
  };
  const auto zoom = [&](double steps) {
    orbit_.zoom(steps, {0, 0}, view_height());
    camera_moved();
  };
  if (!has_scene_ || (event->modifiers() & ~(Qt::ShiftModifier | Qt::KeypadModifier))) return event->ignore();
  switch (event->key()) {
    case Qt::Key_Left:
      return move_eye(-1, 0);
    case Qt::Key_Right:
      return move_eye(1, 0);
    case Qt::Key_Up:
      return move_eye(0, 1);
    case Qt::Key_Down:
      return move_eye(0, -1);
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom(1);
    case Qt::Key_Minus:
      return zoom(-1);
    case Qt::Key_R:
      return reset_view();
    default:
      event->ignore();
  }
}

}  // namespace lumifield
