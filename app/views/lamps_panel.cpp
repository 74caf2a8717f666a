#include "app/views/lamps_panel.h"

#include <QDoubleSpinBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <array>

#include "app/views/lamp_arrangement.h"
#include "app/views/lamp_pose.h"
#include "app/views/preview_text.h"

namespace lumifield {

namespace {

constexpr double farthest_mm = 1e6;

struct Kind {
  const char *name, *accessible, *tip, *suffix;
  double least, most, step;
  int decimals;
  bool wraps;
};
/// In the order of LampsPanel::Figure.
constexpr std::array kinds{
    Kind{QT_TR_NOOP("x"), QT_TR_NOOP("Lamp's x, mm"), QT_TR_NOOP("Where the lamp stands in the scene, mm"), " mm",
         -farthest_mm, farthest_mm, 10, 1, false},
    Kind{QT_TR_NOOP("y"), QT_TR_NOOP("Lamp's y, mm"), QT_TR_NOOP("Where the lamp stands in the scene, mm"), " mm",
         -farthest_mm, farthest_mm, 10, 1, false},
    Kind{QT_TR_NOOP("z"), QT_TR_NOOP("Lamp's z, mm"), QT_TR_NOOP("Where the lamp stands in the scene, mm"), " mm",
         -farthest_mm, farthest_mm, 10, 1, false},
    Kind{QT_TR_NOOP("Yaw"), QT_TR_NOOP("Lamp's yaw, degrees"),
         QT_TR_NOOP("Where the beam points about the scene's up, counter-clockwise seen from above"), "°", -180, 180, 1,
         2, true},
    Kind{QT_TR_NOOP("Pitch"), QT_TR_NOOP("Lamp's pitch, degrees"),
         QT_TR_NOOP("How far the beam points above the horizon"), "°", -90, 90, 1, 2, false},
    Kind{QT_TR_NOOP("Roll"), QT_TR_NOOP("Lamp's roll, degrees"),
         QT_TR_NOOP("How far the lamp is turned about its beam; at 0 its x axis is level"), "°", -180, 180, 1, 2, true},
    Kind{QT_TR_NOOP("Scale"), QT_TR_NOOP("Lamp's scale"), QT_TR_NOOP("Multiplies the lamp's light"), "", 0,
         LampArrangement::largest_scale, 0.1, 3, false},
};

}  // namespace

LampsPanel::LampsPanel(LampArrangement& lamps, QWidget* parent)
    : QWidget(parent), lamps_(lamps), list_(new QListWidget(this)) {
  setAccessibleName(tr("Lamps"));
  list_->setAccessibleName(tr("Lamps"));
  list_->setToolTip(tr("The scene's lamps: all of them shine with the light of the luminaire"));
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  list_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Expanding);
  list_->setMinimumHeight(3 * list_->fontMetrics().height());
  auto* rows = new QVBoxLayout(this);
  rows->addWidget(list_, 1);
  auto* grid = new QGridLayout;
  make_figures(grid);
  rows->addLayout(grid);
  rows->addWidget(make_buttons());
  connect(list_, &QListWidget::currentRowChanged, this, [this](int row) { lamps_.choose(row); });
  connect(&lamps_, &LampArrangement::changed, this, [this] {
    show_lamps();
    show_figures();
  });
  show_lamps();
  show_figures();
}

void LampsPanel::make_figures(QGridLayout* grid) {
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(4);
  for (int k = 0; k < static_cast<int>(kinds.size()); ++k) {
    const Kind& kind = kinds[static_cast<std::size_t>(k)];
    QDoubleSpinBox* box = make_figure(static_cast<Figure>(k));
    auto* name = new QLabel(tr(kind.name), this);
    name->setToolTip(tr(kind.tip));
    name->setBuddy(box);
    // Position and angles side by side, scale below.
    const int row = k < 6 ? k % 3 : 3, column = k < 6 ? 2 * (k / 3) : 0;
    grid->addWidget(name, row, column, Qt::AlignRight | Qt::AlignVCenter);
    grid->addWidget(box, row, column + 1);
    figures_.push_back(box);
  }
  for (const int column : {1, 3}) grid->setColumnStretch(column, 1);
}

QDoubleSpinBox* LampsPanel::make_figure(Figure figure) {
  const Kind& kind = kinds[static_cast<std::size_t>(figure)];
  auto* box = new QDoubleSpinBox(this);
  box->setLocale(QLocale::c());
  box->setDecimals(kind.decimals);
  box->setRange(kind.least, kind.most);
  box->setSingleStep(kind.step);
  box->setSuffix(QString::fromUtf8(kind.suffix));
  box->setWrapping(kind.wraps);
  box->setKeyboardTracking(false);
  box->setMinimumWidth(box->fontMetrics().horizontalAdvance("−10000.0 mm") + 2 * box->fontMetrics().height());
  box->setAccessibleName(tr(kind.accessible));
  box->setToolTip(tr(kind.tip));
  connect(box, &QDoubleSpinBox::valueChanged, this, [this, figure](double value) { change(figure, value); });
  return box;
}

QWidget* LampsPanel::make_buttons() {
  auto* line = new QWidget(this);
  auto* row = new QHBoxLayout(line);
  row->setContentsMargins(0, 0, 0, 0);
  const auto button = [&](const QString& text, const QString& tip, void (LampArrangement::*does)()) {
    auto* made = new QPushButton(text, line);
    made->setToolTip(tip);
    made->setAccessibleDescription(tip);
    connect(made, &QPushButton::clicked, &lamps_, does);
    row->addWidget(made);
    return made;
  };
  add_ = button(tr("Add a lamp"), tr("A copy beside the chosen lamp"), &LampArrangement::add_copy);
  remove_ = button(tr("Remove"), tr("Remove the chosen lamp; one stays"), &LampArrangement::remove_chosen);
  back_ = button(tr("Back to the scene's"), tr("The lamps of the scene's file again"), &LampArrangement::back_to_scene);
  return line;
}

/// One number changes, the others keep all their digits.
void LampsPanel::change(Figure figure, double value) {
  if (lamps_.chosen() < 0) return;
  ScenePlacement lamp = lamps_.lamp(lamps_.chosen());
  if (figure == Figure::scale) {
    lamp.scale = value;
  } else if (figure <= Figure::z) {
    lamp.pose = rigid(lamp.pose);
    lamp.pose(static_cast<int>(figure), 3) = value;
  } else {
    LampAngles angles = angles_of(lamp.pose, lamps_.up());
    (figure == Figure::yaw ? angles.yaw_deg : figure == Figure::pitch ? angles.pitch_deg : angles.roll_deg) = value;
    lamp.pose = with_angles(lamp.pose, lamps_.shape().pivot(), angles, lamps_.up());
  }
  lamps_.place(lamps_.chosen(), lamp, true);
}

void LampsPanel::show_lamps() {
  const QSignalBlocker quiet(list_);
  while (list_->count() > lamps_.count()) delete list_->takeItem(list_->count() - 1);
  for (int k = 0; k < lamps_.count(); ++k) {
    if (k == list_->count()) list_->addItem(QString());
    list_->item(k)->setText(lamp_place(k, lamps_.lamp(k)));
    list_->item(k)->setToolTip(lamp_text(k, lamps_.lamp(k), lamps_.up()));
  }
  list_->setCurrentRow(lamps_.chosen());
  add_->setEnabled(lamps_.can_add());
  remove_->setEnabled(lamps_.can_remove());
  back_->setEnabled(lamps_.count() > 0);
}

void LampsPanel::show_figures() {
  const bool chosen = lamps_.chosen() >= 0;
  const ScenePlacement lamp = chosen ? lamps_.lamp(lamps_.chosen()) : ScenePlacement{};
  const LampAngles angles = angles_of(lamp.pose, lamps_.up());
  const std::array values{lamp.pose(0, 3),  lamp.pose(1, 3), lamp.pose(2, 3), angles.yaw_deg,
                          angles.pitch_deg, angles.roll_deg, lamp.scale};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const QSignalBlocker quiet(figures_[k]);
    figures_[k]->setEnabled(chosen);
    figures_[k]->setValue(values[k]);
  }
}

}  // namespace lumifield
