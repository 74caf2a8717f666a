#pragma once

#include <QImage>
#include <QString>
#include <QWidget>
#include <optional>

namespace lumifield {

/// One image, zoomed and moved: wheel, + and − zoom (the wheel about the cursor), dragging and the arrow keys move,
/// double-click and 0 fit it again. Enlarged pixels stay sharp squares. A mask of the image's size lies over it, opaque
/// where it marks; where the image is shown smaller, every marked pixel still shows. Images come ready to paint: colour
/// mapping is the caller's. Lengths in device-independent pixels. GUI thread.
class ImageView : public QWidget {
  Q_OBJECT

 public:
  explicit ImageView(QWidget* parent = nullptr);

  /// Keeps zoom and place while the size stays; fits another. Null: the placeholder's text is shown. A mask of another
  /// size than the image is not taken.
  void set_image(const QImage& image, const QImage& mask = {});
  void set_placeholder(const QString& text);
  const QString& placeholder() const { return placeholder_; }
  /// Height of an image pixel over its width, as shown.
  void set_pixel_aspect(double aspect);

  const QImage& image() const { return image_; }
  const QImage& mask() const { return mask_; }
  /// Width of an image pixel.
  double zoom() const { return zoom_; }
  bool fits() const { return fitting_; }
  /// Where the whole image lies, in the view's coordinates.
  QRectF image_rect() const;
  /// Empty outside the image.
  std::optional<QPoint> pixel_at(const QPointF& position) const;
  const std::optional<QPoint>& hovered_pixel() const { return hovered_; }

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 public slots:
  void fit();
  void zoom_by(double factor, const QPointF& about);
  void zoom_in();
  void zoom_out();

 signals:
  /// The pixel under the cursor, column and row of the image; empty when it leaves.
  void hovered(std::optional<QPoint> pixel);
  void zoomChanged(double zoom);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  void leaveEvent(QEvent* event) override;

 private:
  QPointF scale() const { return {zoom_, zoom_ * aspect_}; }
  double fit_zoom() const;
  QPointF to_image(const QPointF& position) const;
  /// The view's middle stays on the image.
  void settle();
  void move_by(const QPointF& shift);
  void update_hovered();
  void paint_mask(QPainter& painter, const QRectF& target, const QRect& source);

  QImage image_, mask_;
  QImage reduced_mask_;  ///< as last shown smaller
  QString placeholder_;
  double aspect_ = 1, zoom_ = 1;
  QPointF centre_;  ///< in image pixels, at the view's centre
  bool fitting_ = true;
  std::optional<QPointF> drag_from_, cursor_;
  std::optional<QPoint> hovered_;
};

}  // namespace lumifield
