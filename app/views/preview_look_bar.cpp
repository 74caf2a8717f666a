#include "app/views/preview_look_bar.h"

#include <QAction>
#include <QCheckBox>
#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QStackedWidget>
#include <algorithm>
#include <cmath>

#include "app/views/value_spin_box.h"
#include "app/views/value_text.h"

namespace lumifield {
namespace {

constexpr int ticks_per_stop = 10;

QHBoxLayout* row_of(QWidget* page) {
  auto* row = new QHBoxLayout(page);
  row->setContentsMargins(0, 0, 0, 0);
  return row;
}

}  // namespace

PreviewLookBar::PreviewLookBar(QWidget* parent) : QWidget(parent), pages_(new QStackedWidget(this)) {
  false_colour_ = make_action("&False colour",
                              "Y709 = 0.2126 R + 0.7152 G + 0.0722 B as colours, with a scale, instead of the "
                              "tone-mapped picture: BT.709's weights on the camera's primaries, no measured luminance",
                              true);
  hold_ = make_action("&Hold average", {}, true);
  brighter_ = make_action("&Brighter", "Half a stop brighter", false);
  darker_ = make_action("&Darker", "Half a stop darker", false);
  pages_->addWidget(make_exposure());
  pages_->addWidget(make_scale());
  row_of(this)->addWidget(pages_);
  connect(brighter_, &QAction::triggered, this, [this] { stops_->setValue(stops_->value() + stops_per_key); });
  connect(darker_, &QAction::triggered, this, [this] { stops_->setValue(stops_->value() - stops_per_key); });
  connect(hold_, &QAction::toggled, this, &PreviewLookBar::hold_average);
  connect(false_colour_, &QAction::toggled, this, [this](bool on) {
    pages_->setCurrentIndex(on ? 1 : 0);
    PreviewLook look = look_;
    look.false_colour = on;
    tell(look);
  });
  say_average();
}

QAction* PreviewLookBar::make_action(const QString& text, const QString& tip, bool checkable) {
  auto* action = new QAction(text, this);
  action->setCheckable(checkable);
  action->setToolTip(tip);
  return action;
}

QWidget* PreviewLookBar::make_exposure() {
  auto* page = new QWidget(this);
  const QString tip =
      "Exposure in stops: one more doubles the brightness; at 0 the average L̄ shows as a mid grey. It changes the "
      "picture only, no value.";
  slider_ = new QSlider(Qt::Horizontal, page);
  slider_->setRange(static_cast<int>(-most_stops) * ticks_per_stop, static_cast<int>(most_stops) * ticks_per_stop);
  slider_->setPageStep(ticks_per_stop);
  slider_->setMinimumWidth(50);
  slider_->setAccessibleName("Exposure, tenths of a stop");
  stops_ = new QDoubleSpinBox(page);
  stops_->setLocale(QLocale::c());
  stops_->setRange(-most_stops, most_stops);
  stops_->setDecimals(1);
  stops_->setSingleStep(1.0 / ticks_per_stop);
  stops_->setSuffix(" stops");
  stops_->setKeyboardTracking(false);
  stops_->setAccessibleName("Exposure, stops");
  hold_box_ = new QCheckBox("Hold average", page);
  auto* name = new QLabel("Exposure", page);
  for (QWidget* widget : {static_cast<QWidget*>(slider_), static_cast<QWidget*>(stops_), static_cast<QWidget*>(name)})
    widget->setToolTip(tip);
  QHBoxLayout* row = row_of(page);
  row->addWidget(name);
  row->addWidget(slider_, 1);
  row->addWidget(stops_);
  row->addWidget(hold_box_);
  connect(slider_, &QSlider::valueChanged, this, [this](int ticks) { stops_->setValue(ticks * 1.0 / ticks_per_stop); });
  connect(stops_, &QDoubleSpinBox::valueChanged, this, &PreviewLookBar::set_stops);
  connect(hold_box_, &QCheckBox::toggled, hold_, &QAction::setChecked);
  connect(hold_, &QAction::toggled, hold_box_, &QCheckBox::setChecked);
  return page;
}

QWidget* PreviewLookBar::make_scale() {
  auto* page = new QWidget(this);
  fixed_ = new QCheckBox("Fixed scale, up to", page);
  fixed_->setToolTip("Off: the scale ends at the picture's largest Y709. On: at the value beside, for every picture.");
  top_ = new ValueSpinBox(page);
  top_->setValue(1);
  top_->setEnabled(false);
  top_->setKeyboardTracking(false);
  top_->setAccessibleName("Y709 at the scale's end");
  top_->setToolTip("Y709 at the end of the false-colour scale; larger values show the end's colour");
  QHBoxLayout* row = row_of(page);
  row->addWidget(fixed_);
  row->addWidget(top_);
  row->addStretch(1);
  connect(fixed_, &QCheckBox::toggled, this, &PreviewLookBar::fix_scale);
  connect(top_, &QDoubleSpinBox::valueChanged, this, [this] { fix_scale(fixed_->isChecked()); });
  return page;
}

void PreviewLookBar::set_stops(double stops) {
  const QSignalBlocker block(slider_);
  slider_->setValue(static_cast<int>(std::lround(stops * ticks_per_stop)));
  PreviewLook look = look_;
  look.tone.exposure = PreviewLook{}.tone.exposure * std::exp2(stops);
  tell(look);
}

void PreviewLookBar::hold_average(bool hold) {
  PreviewLook look = look_;
  look.tone.white = hold ? average_ : 0;
  tell(look);
  say_average();
}

void PreviewLookBar::say_average() {
  QString tip = "Off: brightness counts from each picture's own average L̄, so a picture that gains light looks alike.";
  tip += " On: L̄ stays as it is, and pictures can be compared.";
  if (look_.tone.white > 0)
    tip += " Held: L̄ = " + value_text(look_.tone.white) + (quantity_ ? " " + unit_text(unit_of(*quantity_)) : "");
  hold_->setToolTip(tip);
  hold_box_->setToolTip(tip);
}

void PreviewLookBar::fix_scale(bool fixed) {
  top_->setEnabled(fixed);
  PreviewLook look = look_;
  look.false_colour_top = fixed ? top_->value() : 0;
  tell(look);
}

void PreviewLookBar::tell(const PreviewLook& look) {
  const auto all = [](const PreviewLook& l) {
    return std::tuple(l.tone.exposure, l.tone.white, l.false_colour, l.false_colour_top);
  };
  if (all(look) == all(look_)) return;
  look_ = look;
  emit lookChanged(look_);
}

void PreviewLookBar::set_quantity(Quantity quantity) {
  if (quantity_ == quantity) return;
  // What was held is in another unit.
  quantity_ = quantity;
  average_ = 0;
  hold_->setChecked(false);
  fixed_->setChecked(false);
  top_->setSuffix(" " + unit_text(unit_of(quantity)));
  say_average();
}

void PreviewLookBar::set_frame(const PreviewFrame& frame) {
  average_ = frame.average;
  if (hold_->isChecked() && look_.tone.white == 0) hold_average(true);  // held while it was dark
  if (fixed_->isChecked() || !(frame.scale_top > 0)) return;
  const QSignalBlocker block(top_);
  top_->setValue(frame.scale_top);
}

}  // namespace lumifield
