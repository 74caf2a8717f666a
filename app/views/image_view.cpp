#include "app/views/image_view.h"

#include <QKeyEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QWheelEvent>
#include <algorithm>
#include <cmath>

#include "app/views/mask_reduction.h"

namespace lumifield {

namespace {

constexpr double most_zoom = 64, key_step = 1.25;

}  // namespace

ImageView::ImageView(QWidget* parent) : QWidget(parent) {
  setMouseTracking(true);
  setFocusPolicy(Qt::StrongFocus);
  setCursor(Qt::CrossCursor);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setAccessibleName(tr("Image"));
  setToolTip(tr("Wheel or + and − zoom, dragging or arrow keys move, double-click or 0 fits the image"));
  setAccessibleDescription(toolTip());
}

QSize ImageView::sizeHint() const { return {320, 320}; }
QSize ImageView::minimumSizeHint() const { return {120, 100}; }

void ImageView::set_image(const QImage& image, const QImage& mask) {
  const bool same_size = image.size() == image_.size();
  image_ = image;
  mask_ = mask.size() == image.size() ? mask.convertToFormat(QImage::Format_ARGB32_Premultiplied) : QImage();
  reduced_mask_ = QImage();
  if (same_size)
    settle();
  else
    fit();
  update();
}

void ImageView::set_placeholder(const QString& text) {
  placeholder_ = text;
  update();
}

void ImageView::set_pixel_aspect(double aspect) {
  if (aspect == aspect_ || !(aspect > 0) || !std::isfinite(aspect)) return;
  aspect_ = aspect;
  fit();
}

double ImageView::fit_zoom() const {
  if (image_.isNull()) return 1;
  const double zoom = std::min(width() / static_cast<double>(image_.width()), height() / (image_.height() * aspect_));
  return std::max(zoom, 1e-6);
}

QRectF ImageView::image_rect() const {
  const QPointF corner(width() / 2.0 - centre_.x() * scale().x(), height() / 2.0 - centre_.y() * scale().y());
  return {corner, QSizeF(image_.width() * scale().x(), image_.height() * scale().y())};
}

QPointF ImageView::to_image(const QPointF& position) const {
  const QPointF from_corner = position - image_rect().topLeft();
  return {from_corner.x() / scale().x(), from_corner.y() / scale().y()};
}

std::optional<QPoint> ImageView::pixel_at(const QPointF& position) const {
  const QPointF at = to_image(position);
  const QPoint pixel(static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())));
  if (!image_.rect().contains(pixel)) return std::nullopt;
  return pixel;
}

void ImageView::settle() {
  if (fitting_) {
    zoom_ = fit_zoom();
    centre_ = {image_.width() / 2.0, image_.height() / 2.0};
  }
  centre_ = {std::clamp(centre_.x(), 0.0, double(image_.width())),
             std::clamp(centre_.y(), 0.0, double(image_.height()))};
  update_hovered();
  update();
}

void ImageView::fit() {
  const double before = zoom_;
  fitting_ = true;
  settle();
  if (zoom_ != before) emit zoomChanged(zoom_);
}

void ImageView::zoom_by(double factor, const QPointF& about) {
  if (image_.isNull() || !(factor > 0)) return;
  const double before = zoom_, fitted = fit_zoom();
  const QPointF fixed = to_image(about);
  zoom_ = std::clamp(zoom_ * factor, std::min(fitted, 1.0), std::max(fitted, most_zoom));
  fitting_ = zoom_ == fitted;
  const QPointF from_middle = about - QPointF(width() / 2.0, height() / 2.0);
  centre_ = fixed - QPointF(from_middle.x() / scale().x(), from_middle.y() / scale().y());
  settle();
  if (zoom_ != before) emit zoomChanged(zoom_);
}

void ImageView::zoom_in() { zoom_by(key_step, QRectF(rect()).center()); }
void ImageView::zoom_out() { zoom_by(1 / key_step, QRectF(rect()).center()); }

void ImageView::move_by(const QPointF& shift) {
  centre_ -= QPointF(shift.x() / scale().x(), shift.y() / scale().y());
  settle();
}

void ImageView::update_hovered() {
  const std::optional<QPoint> now = cursor_ ? pixel_at(*cursor_) : std::nullopt;
  if (now == hovered_) return;
  hovered_ = now;
  emit hovered(now);
}

void ImageView::resizeEvent(QResizeEvent*) { settle(); }

void ImageView::wheelEvent(QWheelEvent* event) {
  zoom_by(std::pow(key_step, event->angleDelta().y() / 120.0), event->position());
  event->accept();
}

void ImageView::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton && event->button() != Qt::MiddleButton) return QWidget::mousePressEvent(event);
  drag_from_ = event->position();
  setCursor(Qt::ClosedHandCursor);
}

void ImageView::mouseMoveEvent(QMouseEvent* event) {
  cursor_ = event->position();
  if (drag_from_) {
    move_by(event->position() - *drag_from_);
    drag_from_ = event->position();
  }
  update_hovered();
}

void ImageView::mouseReleaseEvent(QMouseEvent*) {
  drag_from_.reset();
  setCursor(Qt::CrossCursor);
}

void ImageView::mouseDoubleClickEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) fit();
}

void ImageView::leaveEvent(QEvent*) {
  cursor_.reset();
  update_hovered();
}

void ImageView::keyPressEvent(QKeyEvent* event) {
  const double x = width() / 8.0, y = height() / 8.0;
  switch (event->key()) {
    case Qt::Key_Plus:
    case Qt::Key_Equal:
      return zoom_in();
    case Qt::Key_Minus:
      return zoom_out();
    case Qt::Key_0:
      return fit();
    case Qt::Key_Left:
      return move_by({x, 0});
    case Qt::Key_Right:
      return move_by({-x, 0});
    case Qt::Key_Up:
      return move_by({0, y});
    case Qt::Key_Down:
      return move_by({0, -y});
    default:
      QWidget::keyPressEvent(event);
  }
}

void ImageView::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), palette().color(QPalette::Window).darker(110));
  if (image_.isNull()) {
    painter.setPen(palette().color(QPalette::WindowText));
    painter.drawText(rect().adjusted(12, 12, -12, -12), Qt::AlignCenter | Qt::TextWordWrap, placeholder_);
  } else {
    // Only the pixels in sight: a strongly enlarged image would be a huge target.
    const QRectF whole = image_rect();
    const QRect source = QRectF(to_image({0, 0}), to_image({double(width()), double(height())}))
                             .toAlignedRect()
                             .intersected(image_.rect());
    const QRectF target(whole.x() + source.x() * scale().x(), whole.y() + source.y() * scale().y(),
                        source.width() * scale().x(), source.height() * scale().y());
    const bool smaller = std::min(scale().x(), scale().y()) * devicePixelRatioF() < 1;
    painter.setRenderHint(QPainter::SmoothPixmapTransform, smaller);
    painter.drawImage(target, image_, source);
    if (!mask_.isNull()) paint_mask(painter, target, source);
  }
  if (hasFocus()) {
    painter.setPen(palette().color(QPalette::Highlight));
    painter.drawRect(rect().adjusted(0, 0, -1, -1));
  }
}

void ImageView::paint_mask(QPainter& painter, const QRectF& target, const QRect& source) {
  painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
  const QRectF whole = image_rect();
  const QSize shown = (whole.size() * devicePixelRatioF()).toSize().expandedTo({1, 1}).boundedTo(mask_.size());
  if (shown == mask_.size()) return painter.drawImage(target, mask_, source);
  if (reduced_mask_.size() != shown) reduced_mask_ = reduce_mask(mask_, shown);
  painter.drawImage(whole, reduced_mask_);
}

}  // namespace lumifield
