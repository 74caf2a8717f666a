#pragma once

#include <QPixmap>
#include <QString>
#include <QStringList>
#include <QTimer>
#include <QWidget>
#include <memory>
#include <optional>

#include "app/session/live_preview.h"
#include "app/views/lamp_grip.h"
#include "app/views/orbit_camera.h"
#include "app/views/preview_text.h"

namespace lumifield {

/// The canvas of the preview: the latest picture, as large as fits, and what there is to know about it; it never shows
/// light that is not measured, and says what is missing. Left drag and arrow keys orbit; right, middle or shift drag
/// and shift + arrow keys pan; wheel and + − zoom; double click or R goes back to the scene's own camera.
///
/// Each luminaire has a handle over the picture. Dragged, it moves across the view, with Shift along its beam; with
/// Ctrl, or by its arrow's tip, it turns; Esc cancels. A click chooses it, as does L: then arrow keys move it, with
/// Shift along its beam, and with Ctrl turn it, until Esc or a click beside it. GUI thread.
class PreviewView : public QWidget {
  Q_OBJECT

 public:
  /// The full picture is as large as the widget in device pixels, but no more than this.
  static constexpr int most_pixels = 1024 * 768;
  /// The view rests this long after the last change of camera or size.
  static constexpr int rest_ms = 150;
  static constexpr double orbit_deg_per_px = 0.4, orbit_deg_per_key = 5, pan_px_per_key = 20;

  explicit PreviewView(QWidget* parent = nullptr);

  /// Another scene, seen by its own camera, and its luminaires. Its picture comes with the next frame.
  void set_scene(const SceneCamera& home, const std::vector<ScenePlacement>& lamps = {});
  void set_luminaire(const LuminaireGeometry& geometry);
  void show_frame(std::shared_ptr<const PreviewFrame> frame);
  /// Said until the next frame; an older picture stays below it.
  void show_failure(const Error& error);
  /// What is asked of the render thread, which the picture may not show yet; what it is at; and the cells by now.
  void set_chosen(const PreviewChoice& chosen);
  void show_progress(const PreviewProgress& progress);
  void set_cells(PreviewCells cells);
  /// Lamps' handles, drawn and to be grasped; they are until told otherwise.
  void set_handles_shown(bool shown);

  /// Null while there is none.
  const std::shared_ptr<const PreviewFrame>& frame() const { return frame_; }
  const OrbitCamera& orbit() const { return orbit_; }
  LampArrangement& lamps() { return *lamps_; }
  /// Where the picture stands, logical pixels; empty without one.
  QRectF picture_rect() const;
  /// The last `sizeWanted`; empty before it.
  const QSize& wanted_size() const { return wanted_; }
  QSize sizeHint() const override { return {640, 480}; }
  QSize minimumSizeHint() const override { return {160, 120}; }

 public slots:
  void reset_view();

 signals:
  /// `moving` until the camera rests.
  void cameraChanged(const lumifield::SceneCamera& camera, bool moving);
  /// Size of the full picture, once the widget's size rests.
  void sizeWanted(int width_px, int height_px);
  /// The value under the cursor, or what can be done with the lamp there; empty when there is none.
  void pointed(const QString& text);
  /// A frame is on the screen's way for the first time.
  void painted(const std::shared_ptr<const lumifield::PreviewFrame>& frame);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void wheelEvent(QWheelEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;
  bool event(QEvent* event) override;

 private:
  enum class Drag { none, orbit, pan, lamp };
  void set_drag(Drag drag);
  void show_cursor();
  void camera_moved();
  void want_size();
  void tell_pointed();
  void say_state();
  QStringList warnings() const;
  double view_height() const;
  Vec2 from_centre(const QPointF& position) const;
  void draw_picture(QPainter& painter);
  void draw_reason(QPainter& painter);

  // preview_view_lamps.cpp
  std::optional<PictureProjection> projection() const;
  void watch_lamps();
  bool press_lamp(QMouseEvent* event);
  bool lamp_key(const QKeyEvent* event);
  bool lamp_arrow(const QKeyEvent* event);
  void point_at_lamps();
  QString lamp_words() const;

  std::shared_ptr<const PreviewFrame> frame_, painted_frame_;
  QPixmap scaled_;  ///< frame_ in the widget's device pixels; null when it is to be made
  std::optional<Error> failure_;
  PreviewChoice chosen_;
  PreviewProgress progress_;
  PreviewCells cells_;
  bool handles_shown_ = true;
  bool has_scene_ = false;
  std::optional<Quantity> quantity_;  ///< empty without a luminaire
  OrbitCamera orbit_;
  LampArrangement* lamps_;
  LampGrip grip_;
  bool dragged_ = false;       ///< since the button was pressed
  bool lamp_stepped_ = false;  ///< by a key, since the cursor moved
  Drag drag_ = Drag::none;
  QPointF cursor_;
  bool cursor_inside_ = false;
  QSize wanted_;
  QTimer rest_, size_rest_;
};

}  // namespace lumifield
