#include <QHelpEvent>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QToolTip>

#include "app/views/preview_text.h"
#include "app/views/preview_view.h"

namespace lumifield {

namespace {

Vec2 pixel(const QPointF& position) { return {position.x(), position.y()}; }

LampGrip::Motion motion_of(Qt::KeyboardModifiers keys) {
  if (keys.testFlag(Qt::ControlModifier)) return LampGrip::Motion::turn;
  return keys.testFlag(Qt::ShiftModifier) ? LampGrip::Motion::along : LampGrip::Motion::across;
}

QString hint(const LampHit& at) {
  if (at.part == LampPart::tip) return PreviewView::tr("Lamp %1: drag the tip to turn it").arg(at.lamp + 1);
  return PreviewView::tr("Lamp %1: drag to move it, with Shift along its beam, with Ctrl to turn it").arg(at.lamp + 1);
}

}  // namespace

/// Of the picture that is shown, which handles and cursor belong to.
std::optional<PictureProjection> PreviewView::projection() const {
  const QRectF rect = picture_rect();
  if (rect.isEmpty() || !handles_shown_) return {};
  return PictureProjection(frame_->camera, pixel(rect.topLeft()), {rect.width(), rect.height()});
}

void PreviewView::watch_lamps() {
  connect(lamps_, &LampArrangement::changed, this, [this] {
    say_state();
    tell_pointed();
    update();
  });
  connect(lamps_, &LampArrangement::replaced, this, [this] {
    grip_.let_go();
    grip_.point_away();
    if (drag_ == Drag::lamp) set_drag(Drag::none);
  });
}

void PreviewView::point_at_lamps() {
  const auto view = projection();
  const bool other = view && cursor_inside_ && picture_rect().contains(cursor_) ? grip_.point(*view, pixel(cursor_))
                                                                                : grip_.point_away();
  if (!other) return;
  show_cursor();
  update();
}

bool PreviewView::press_lamp(QMouseEvent* event) {
  const auto view = projection();
  if (!view || event->button() != Qt::LeftButton) return false;
  if (!grip_.grab(*view, pixel(event->position()), motion_of(event->modifiers()))) return false;
  cursor_ = event->position();
  set_drag(Drag::lamp);
  tell_pointed();
  return true;
}

bool PreviewView::lamp_key(const QKeyEvent* event) {
  if (event->key() == Qt::Key_Escape) {
    if (grip_.cancel()) {
      set_drag(Drag::none);
      tell_pointed();
      return true;
    }
    const bool chosen = lamps_->chosen() >= 0;
    lamps_->choose(-1);
    return chosen;
  }
  if (event->key() == Qt::Key_L && !(event->modifiers() & ~Qt::ShiftModifier) && frame_ && handles_shown_) {
    lamp_stepped_ = true;
    lamps_->choose_next(event->modifiers().testFlag(Qt::ShiftModifier) ? -1 : 1);
    return true;
  }
  return lamp_arrow(event);
}

bool PreviewView::lamp_arrow(const QKeyEvent* event) {
  const auto view = projection();
  const int key = event->key();
  if (!view || key < Qt::Key_Left || key > Qt::Key_Down) return false;
  if (event->modifiers() & ~(Qt::ShiftModifier | Qt::ControlModifier | Qt::KeypadModifier)) return false;
  const int right = (key == Qt::Key_Right) - (key == Qt::Key_Left), up = (key == Qt::Key_Up) - (key == Qt::Key_Down);
  lamp_stepped_ = true;
  return grip_.step(*view, motion_of(event->modifiers()), right, up);
}

/// Of the lamp that is moved, else of the one at the cursor; empty without either.
QString PreviewView::lamp_words() const {
  if (!frame_) return {};
  const int chosen = lamps_->chosen();
  if (chosen >= 0 && (grip_.moves() || lamp_stepped_)) return lamp_text(chosen, lamps_->lamp(chosen), lamps_->up());
  return grip_.at() ? hint(*grip_.at()) : QString();
}

bool PreviewView::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  if (grip_.at() && !grip_.holds())
    QToolTip::showText(static_cast<QHelpEvent*>(event)->globalPos(),
                       hint(*grip_.at()) + "\n" +
                           tr("Esc cancels. Chosen by a click or L: arrow keys move it by %1 mm, with Shift along its "
                              "beam, with Ctrl turn it by %2°; Esc or a click beside it gives them back to the view.")
                               .arg(LampGrip::step_mm)
                               .arg(LampGrip::step_deg),
                       this);
  else
    QToolTip::hideText();
  return true;
}

}  // namespace lumifield
