#pragma once

#include <QWidget>
#include <memory>
#include <optional>
#include <vector>

#include "app/session/bench_view.h"
#include "app/views/camera_picture.h"
#include "luminaire/bench.h"

class QComboBox;
class QLabel;
class QTimer;

namespace lumifield {

class CameraPictureMaker;
class DeviceLine;
class HistogramView;
class ImageView;
class StageMap;

/// What the bench sees now: how camera and stage are connected, the camera's last picture with its over-exposed pixels
/// marked, one exposure of the bracket at a time, its histogram, and where the stage stands. It looks into a BenchView
/// five times a second, and has it watched, while it is visible; pictures are made on a thread of their own. GUI
/// thread.
class BenchPanel : public QWidget {
  Q_OBJECT

 public:
  explicit BenchPanel(QWidget* parent = nullptr);

  /// Null: nothing to show.
  void set_view(std::shared_ptr<BenchView> view);
  /// DN at or above are over-exposed.
  void set_saturation(double dn);
  void set_limits(const StageLimits& limits);
  /// Stage readings of the cells.
  void set_cell_targets(std::vector<Vec2> stage_mm);

  /// The picture shown; null before the first.
  const CameraPicture* picture() const { return picture_.get(); }
  /// The frame chosen, of those of the last bracket: the longest unless another was.
  std::size_t chosen_exposure() const;

 signals:
  /// Another picture is on the screen.
  void pictureShown();

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  void build();
  QWidget* make_choices();
  QWidget* make_figures();
  QWidget* make_stage();
  void watch(bool watched);
  void look();
  void show_bracket();
  void show_position();
  void show_place();
  void show_exposures();
  void choose_exposure(int item);
  void wish_picture();
  void show_picture(std::shared_ptr<const CameraPicture> picture);
  void show_pixel();
  void show_saturation();

  std::shared_ptr<BenchView> view_;
  BenchSnapshot now_;
  std::shared_ptr<const CameraPicture> picture_;
  std::optional<double> chosen_s_;  ///< empty: the longest
  double saturation_dn_ = 4095;

  QTimer* look_;
  CameraPictureMaker* maker_;
  DeviceLine *camera_, *stage_;
  QComboBox *exposures_ = nullptr, *colours_ = nullptr;
  QLabel *place_ = nullptr, *pixel_ = nullptr, *saturated_ = nullptr, *position_ = nullptr;
  ImageView* image_;
  HistogramView* histogram_;
  StageMap* map_ = nullptr;
};

}  // namespace lumifield
