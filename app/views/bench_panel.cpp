#include "app/views/bench_panel.h"

#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "app/views/camera_picture_maker.h"
#include "app/views/device_line.h"
#include "app/views/histogram_view.h"
#include "app/views/image_view.h"
#include "app/views/signal_colours.h"
#include "app/views/stage_map.h"

namespace lumifield {

namespace {

constexpr int look_period_ms = 200;
/// Exposures as the camera reports them differ a little from bracket to bracket.
constexpr double same_exposure = 0.02;

QHBoxLayout* tight_row(QWidget* line) {
  auto* row = new QHBoxLayout(line);
  row->setContentsMargins(0, 0, 0, 0);
  return row;
}

QLabel* make_label(QWidget* parent, const QString& name, const QString& tip) {
  auto* label = new QLabel(parent);
  label->setTextFormat(Qt::PlainText);
  label->setAccessibleName(name);
  label->setToolTip(tip);
  return label;
}

}  // namespace

BenchPanel::BenchPanel(QWidget* parent)
    : QWidget(parent),
      look_(new QTimer(this)),
      maker_(new CameraPictureMaker(this)),
      camera_(new DeviceLine("Camera", this)),
      stage_(new DeviceLine("Stage", this)),
      image_(new ImageView(this)),
      histogram_(new HistogramView(this)) {
  setAccessibleName("Bench");
  build();
  look_->setInterval(look_period_ms);
  connect(look_, &QTimer::timeout, this, &BenchPanel::look);
  connect(maker_, &CameraPictureMaker::made, this, &BenchPanel::show_picture);
  connect(image_, &ImageView::hovered, this, &BenchPanel::show_pixel);
  connect(exposures_, &QComboBox::activated, this, &BenchPanel::choose_exposure);
  connect(colours_, &QComboBox::activated, this, &BenchPanel::wish_picture);
  show_bracket();
  show_saturation();
}

void BenchPanel::build() {
  image_->setAccessibleName("Camera's picture");
  image_->set_placeholder("no picture yet");
  histogram_->setAccessibleName("Histogram of the camera's picture");
  histogram_->set_placeholder("no picture yet");
  histogram_->set_logarithmic(true);  // few pixels are lit
  auto* rows = new QVBoxLayout(this);
  rows->addWidget(camera_);
  rows->addWidget(stage_);
  rows->addWidget(make_choices());
  rows->addWidget(image_, 1);
  rows->addWidget(make_figures());
  rows->addWidget(histogram_);
  rows->addWidget(make_stage());
}

QWidget* BenchPanel::make_choices() {
  auto* line = new QWidget(this);
  QHBoxLayout* row = tight_row(line);
  place_ = make_label(line, "Place of the picture", "Where the picture was taken");
  place_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  exposures_ = new QComboBox(line);
  exposures_->setAccessibleName("Exposure shown");
  exposures_->setToolTip("Which exposure of the bracket is shown, in ms or s");
  exposures_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  colours_ = new QComboBox(line);
  colours_->setAccessibleName("Colours shown");
  colours_->setToolTip(
      "How the photosites of a colour sensor are shown: each as grey, or blocks of 2 × 2 as one colour pixel, without "
      "white balance");
  colours_->addItems({"Grey", "Colour"});
  row->addWidget(place_, 1);
  row->addWidget(exposures_);
  row->addWidget(colours_);
  return line;
}

QWidget* BenchPanel::make_figures() {
  auto* line = new QWidget(this);
  QHBoxLayout* row = tight_row(line);
  pixel_ = make_label(line, "Pixel under the cursor", "Column, row and signal under the cursor, in DN");
  pixel_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  saturated_ = make_label(line, "Over-exposed pixels", "");
  row->addWidget(pixel_, 1);
  row->addWidget(saturated_);
  return line;
}

QWidget* BenchPanel::make_stage() {
  auto* line = new QWidget(this);
  QHBoxLayout* row = tight_row(line);
  map_ = new StageMap(line);
  position_ = make_label(line, "Stage's position", "The stage's reading, read back last, in mm");
  row->addWidget(map_);
  row->addWidget(position_, 1);
  show_position();
  return line;
}

void BenchPanel::set_view(std::shared_ptr<BenchView> view) {
  watch(false);
  view_ = std::move(view);
  watch(isVisible());
  now_ = {};
  if (isVisible()) look();
}

void BenchPanel::set_saturation(double dn) {
  saturation_dn_ = dn;
  show_saturation();
  wish_picture();
}

void BenchPanel::set_limits(const StageLimits& limits) {
  map_->set_limits(limits);
  show_position();
}

void BenchPanel::set_cell_targets(std::vector<Vec2> stage_mm) { map_->set_targets(std::move(stage_mm)); }

void BenchPanel::showEvent(QShowEvent* event) {
  watch(true);
  look_->start();
  look();
  QWidget::showEvent(event);
}

void BenchPanel::hideEvent(QHideEvent* event) {
  watch(false);
  look_->stop();
  QWidget::hideEvent(event);
}

void BenchPanel::watch(bool watched) {
  if (view_) view_->set_watched(watched);
}

void BenchPanel::look() {
  if (!view_) return;
  BenchSnapshot now = view_->snapshot();
  if (now.number == now_.number) return;
  const bool another = now.bracket != now_.bracket || now.place != now_.place;
  now_ = std::move(now);
  camera_->show_device(now_.camera);
  stage_->show_device(now_.stage);
  map_->set_position(now_.stage_mm);
  show_position();
  show_place();
  if (another) show_bracket();
}

void BenchPanel::show_bracket() {
  show_exposures();
  const bool colour = now_.bracket && !now_.bracket->empty() && now_.bracket->back().pattern != SensorPattern::mono;
  colours_->setVisible(colour);
  wish_picture();
}

void BenchPanel::show_position() { position_->setText(map_->position_text().replace(", ", "\n")); }

void BenchPanel::show_place() {
  const bool live = now_.camera.link == DeviceView::Link::open;
  const QString place = QString::fromStdString(now_.place);
  place_->setText(live || place.isEmpty() ? place : "last picture: " + place);
}

std::size_t BenchPanel::chosen_exposure() const {
  if (!now_.bracket || now_.bracket->empty()) return 0;
  const std::size_t longest = now_.bracket->size() - 1;
  if (!chosen_s_) return longest;
  for (std::size_t k = 0; k < now_.bracket->size(); ++k)
    if (std::abs((*now_.bracket)[k].exposure_s - *chosen_s_) <= same_exposure * *chosen_s_) return k;
  return longest;
}

/// The box is rebuilt only when it reads otherwise: it may be open.
void BenchPanel::show_exposures() {
  QStringList texts, shown;
  if (now_.bracket)
    for (const RawImage& frame : *now_.bracket) texts << exposure_text(frame.exposure_s);
  if (!texts.isEmpty()) texts.last() += texts.size() > 1 ? " (longest)" : "";
  for (int item = 0; item < exposures_->count(); ++item) shown << exposures_->itemText(item);
  if (texts != shown) {
    exposures_->clear();
    exposures_->addItems(texts);
  }
  exposures_->setVisible(!texts.isEmpty());
  exposures_->setEnabled(texts.size() > 1);
  if (!texts.isEmpty()) exposures_->setCurrentIndex(static_cast<int>(chosen_exposure()));
}

void BenchPanel::choose_exposure(int item) {
  if (!now_.bracket || item < 0 || item >= static_cast<int>(now_.bracket->size())) return;
  const bool longest = item + 1 == static_cast<int>(now_.bracket->size());
  chosen_s_ = longest ? std::nullopt : std::optional((*now_.bracket)[static_cast<std::size_t>(item)].exposure_s);
  wish_picture();
}

void BenchPanel::wish_picture() {
  if (now_.bracket)
    maker_->make({now_.bracket, chosen_exposure(), saturation_dn_,
                  colours_->currentIndex() == 1 ? CameraColours::blocks : CameraColours::photosites});
}

void BenchPanel::show_picture(std::shared_ptr<const CameraPicture> picture) {
  picture_ = std::move(picture);
  image_->set_image(picture_->image, picture_->mask);
  histogram_->set_histogram(picture_->histogram);
  show_saturation();
  show_pixel();
  emit pictureShown();
}

void BenchPanel::show_pixel() {
  const std::optional<QPoint>& at = image_->hovered_pixel();
  pixel_->setText(picture_ && at ? pixel_text(*picture_, at->x(), at->y()) : QString());
}

void BenchPanel::show_saturation() {
  const QString limit = QString::number(saturation_dn_, 'g', 6) + " DN";
  histogram_->set_marker(saturation_dn_, "saturation, " + limit);
  saturated_->setToolTip("Share of the photosites at or above saturation, " + limit + "; marked red in the picture");
  if (!picture_) return saturated_->clear();
  const bool any = picture_->saturated > 0;
  const double percent = 100 * picture_->saturated_share;
  const QString share = any && percent < 0.001 ? QString("< 0.001") : QString::number(percent, 'g', 3);
  saturated_->setText(QString("over-exposed: %1 %").arg(any ? share : "0"));
  QPalette own = palette();
  if (any) own.setColor(QPalette::WindowText, fault_colour(own));
  saturated_->setPalette(own);
}

}  // namespace lumifield
