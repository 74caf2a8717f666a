#include "app/views/preview_view.h"

#include <QImage>
#include <QPaintEvent>
#include <QPainter>
#include <QStringList>
#include <algorithm>
#include <cmath>
#include <utility>

#include "app/views/lamp_paint.h"
#include "app/views/preview_paint.h"
#include "app/views/preview_text.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {

/// Bilinear: a fifth of the time of QImage::scaled, and pictures are seldom larger than their place.
QImage enlarged(const QImage& image, const QSize& size) {
  QImage made(size, QImage::Format_RGB32);
  QPainter painter(&made);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  painter.setCompositionMode(QPainter::CompositionMode_Source);
  painter.drawImage(QRect({0, 0}, size), image.convertToFormat(QImage::Format_RGB32));
  return made;
}

/// Of the same aspect but for rounding: a picture of it, often coarse, may be a pixel off.
bool alike(const QSize& picture, const QSize& place) {
  const double width = picture.width(), height = picture.height();
  return std::abs(width * place.height() - height * place.width()) <= std::max(place.width(), place.height());
}

}  // namespace

PreviewView::PreviewView(QWidget* parent) : QWidget(parent), lamps_(new LampArrangement(this)), grip_(*lamps_) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setCursor(Qt::CrossCursor);
  setAccessibleName("Preview picture");
  for (QTimer* timer : {&rest_, &size_rest_}) {
    timer->setSingleShot(true);
    timer->setInterval(rest_ms);
  }
  connect(&rest_, &QTimer::timeout, this, [this] { emit cameraChanged(orbit_.camera(), false); });
  connect(&size_rest_, &QTimer::timeout, this, &PreviewView::want_size);
  watch_lamps();
  say_state();
}

void PreviewView::set_scene(const SceneCamera& home, const std::vector<ScenePlacement>& lamps) {
  rest_.stop();
  set_drag(Drag::none);
  orbit_ = OrbitCamera(home);
  lamps_->set_scene(lamps, home.up);
  has_scene_ = true;
  failure_.reset();
  show_frame(nullptr);
}

void PreviewView::set_luminaire(const LuminaireGeometry& geometry) {
  quantity_ = geometry.quantity;
  lamps_->set_shape(shape_of(geometry.sampling));
  show_frame(nullptr);
}

void PreviewView::show_frame(std::shared_ptr<const PreviewFrame> frame) {
  if (frame) failure_.reset();
  frame_ = std::move(frame);
  scaled_ = QPixmap();
  say_state();
  point_at_lamps();
  tell_pointed();
  update();
}

void PreviewView::show_failure(const Error& error) {
  failure_ = error;
  say_state();
  update();
}

void PreviewView::set_chosen(const PreviewChoice& chosen) {
  chosen_ = chosen;
  say_state();
  update();
}

void PreviewView::show_progress(const PreviewProgress& progress) {
  progress_ = progress;
  say_state();
  update();
}

void PreviewView::set_cells(PreviewCells cells) {
  cells_ = cells;
  say_state();
  update();
}

void PreviewView::set_handles_shown(bool shown) {
  handles_shown_ = shown;
  if (!shown) lamps_->choose(-1);
  point_at_lamps();
  update();
}

/// What went wrong, and of a choice that the picture does not show.
QStringList PreviewView::warnings() const {
  QStringList said;
  const QString coming = quantity_ ? coming_text(frame_.get(), progress_, chosen_) : QString();
  const bool told = failure_ && progress_.refused && progress_.refused->message() == failure_->message();
  if (failure_ && !(told && !coming.isEmpty())) said << QString::fromStdString(failure_->message());
  if (frame_ && !coming.isEmpty()) said << coming;
  return said;
}

void PreviewView::say_state() {
  QStringList said = warnings();
  if (!has_scene_)
    said << "no scene";
  else if (!quantity_)
    said << "no luminaire";
  else if (frame_)
    said << QString("%1 of %2 cells").arg(frame_->cells).arg(frame_->total);
  if (frame_ && lamps_->chosen() >= 0)
    said << lamp_text(lamps_->chosen(), lamps_->lamp(lamps_->chosen()), lamps_->up());
  if (const QString missing = frame_ ? missing_text(*frame_, cells_) : QString(); !missing.isEmpty()) said << missing;
  const QString text = said.join("; ");
  if (text != accessibleDescription()) setAccessibleDescription(text);
}

void PreviewView::reset_view() {
  if (!has_scene_) return;
  orbit_.reset();
  camera_moved();
}

void PreviewView::camera_moved() {
  rest_.start();
  emit cameraChanged(orbit_.camera(), true);
}

void PreviewView::want_size() {
  const double ratio = devicePixelRatioF(), pixels = width() * ratio * height() * ratio;
  const double scale = ratio * std::min(1.0, std::sqrt(most_pixels / std::max(pixels, 1.0)));
  const QSize size(static_cast<int>(width() * scale), static_cast<int>(height() * scale));
  if (size.isEmpty() || size == wanted_) return;
  wanted_ = size;
  emit sizeWanted(size.width(), size.height());
}

void PreviewView::tell_pointed() {
  if (const QString words = lamp_words(); !words.isEmpty()) return emit pointed(words);
  const QRectF rect = picture_rect();
  if (!cursor_inside_ || !rect.contains(cursor_) || !frame_->radiance) return emit pointed({});
  // A coarse picture's values, at the places of the full one.
  const Picture& picture = *frame_->radiance;
  const QSize own(picture.width_px, picture.height_px), full = frame_->coarse && !wanted_.isEmpty() ? wanted_ : own;
  const QPointF share((cursor_.x() - rect.left()) / rect.width(), (cursor_.y() - rect.top()) / rect.height());
  const auto pixel = [&share](const QSize& size) {
    return QPoint(std::min(static_cast<int>(share.x() * size.width()), size.width() - 1),
                  std::min(static_cast<int>(share.y() * size.height()), size.height() - 1));
  };
  const QPoint at = pixel(own), place = pixel(full);
  emit pointed(QString("pixel %1, %2: ").arg(place.x()).arg(place.y()) +
               pixel_text(picture, at.x(), at.y(), *quantity_));
}

QRectF PreviewView::picture_rect() const {
  if (!frame_ || !quantity_ || !has_scene_ || frame_->shown.width_px < 1 || frame_->shown.height_px < 1) return {};
  // Whole device pixels, so that a picture of the widget's size is painted as it is.
  const double ratio = devicePixelRatioF();
  const QSize device(static_cast<int>(width() * ratio), static_cast<int>(height() * ratio));
  const QSize shown(frame_->shown.width_px, frame_->shown.height_px);
  const QSize fit = alike(shown, device) ? device : shown.scaled(device, Qt::KeepAspectRatio);
  const QPoint corner((device.width() - fit.width()) / 2, (device.height() - fit.height()) / 2);
  return QRectF(QPointF(corner) / ratio, QSizeF(fit) / ratio);
}

double PreviewView::view_height() const {
  const QRectF rect = picture_rect();
  return rect.isEmpty() ? height() : rect.height();
}

Vec2 PreviewView::from_centre(const QPointF& position) const {
  return {position.x() - width() / 2.0, position.y() - height() / 2.0};
}

void PreviewView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  if (picture_rect().isEmpty())
    draw_reason(painter);
  else
    draw_picture(painter);
  if (hasFocus()) {
    painter.setPen(palette().color(QPalette::Highlight));
    painter.setBrush(Qt::NoBrush);
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
  painter.end();
  if (frame_ && frame_ != painted_frame_) {
    painted_frame_ = frame_;
    emit painted(frame_);
  }
}

void PreviewView::draw_picture(QPainter& painter) {
  const QRectF at = picture_rect();
  const double ratio = devicePixelRatioF();
  const QSize size = (at.size() * ratio).toSize();
  if (scaled_.size() != size) {
    const Picture8& shown = frame_->shown;
    const QImage image(shown.srgb.data(), shown.width_px, shown.height_px, 3 * shown.width_px, QImage::Format_RGB888);
    scaled_ = QPixmap::fromImage(image.size() == size ? image : enlarged(image, size));
    scaled_.setDevicePixelRatio(ratio);
  }
  painter.drawPixmap(at.topLeft(), scaled_);
  if (const auto view = projection()) draw_lamps(painter, *view, grip_.handles(*view), grip_.at(), lamps_->chosen());
  // The time to a picture by what is chosen stands with the choice.
  const bool other = !coming_text(frame_.get(), progress_, chosen_).isEmpty();
  const QString warning = (warnings() << missing_text(*frame_, cells_)).join("\n").trimmed();
  const double strip =
      draw_strip(painter, rect(), warning, progress_text(*frame_, other ? PreviewProgress() : progress_));
  if (frame_->look.false_colour)
    draw_scale_bar(painter, QRectF(rect()).adjusted(0, 0, 0, -strip), frame_->scale_top,
                   frame_->look.false_colour_top > 0, unit_text(unit_of(*quantity_)));
}

void PreviewView::draw_reason(QPainter& painter) {
  QString title = "Preparing the picture…", text = coming_text(nullptr, progress_, chosen_);
  if (failure_) {
    title = "No picture";
    text = QString::fromStdString(Error{failure_->what, failure_->where, {}, {}}.message());
    if (!failure_->remedy.empty()) text += "\n\nWhat to do: " + QString::fromStdString(failure_->remedy);
  } else if (!has_scene_) {
    title = "No scene";
    text = "Choose a scene: the luminaire lights it here.";
  } else if (!quantity_) {
    title = "No luminaire";
    text = "Start a scan or open a dataset. Each cell lights the scene as soon as it is measured.";
  }
  draw_placeholder(painter, rect(), palette(), title, text, failure_.has_value());
}

void PreviewView::resizeEvent(QResizeEvent*) { size_rest_.start(); }

}  // namespace lumifield
