#include "app/views/preview_method_bar.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSpinBox>
#include <QToolButton>

namespace lumifield {

namespace {

constexpr int most_offered = 1'000'000;

QString text_of(std::string_view text) { return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size())); }

/// What the samples of a method are; empty where it has none.
QString samples_tip(Method method) {
  switch (info(method).cost) {
    case MethodCost::samples:
      return PreviewMethodBar::tr(
          "Samples for each pixel: four times as many halve the noise and take four times as long");
    case MethodCost::lights:
      return PreviewMethodBar::tr("Light samples of the whole luminaire, shared by all pixels");
    case MethodCost::none:
    case MethodCost::pixels_per_support:
      return {};
  }
  return {};
}

}  // namespace

PreviewMethodBar::PreviewMethodBar(QWidget* parent)
    : QWidget(parent),
      methods_(new QComboBox(this)),
      samples_(new QSpinBox(this)),
      shadows_(new QComboBox(this)),
      refresh_(new QToolButton(this)),
      environment_(new QCheckBox(tr("Environment"), this)) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  add_methods(row);
  add_shadows(row);
  environment_->setChecked(true);
  environment_->setToolTip(
      tr("Whether the lab around the lamp lights the scene: the environment that the scene names. It is reflected by "
         "surfaces, and not shown behind them."));
  environment_->hide();
  row->addWidget(environment_);
  connect(environment_, &QCheckBox::toggled, this, &PreviewMethodBar::environmentSwitched);
  row->addStretch(1);
  choose(Method::closed_form);
}

void PreviewMethodBar::add_methods(QHBoxLayout* row) {
  for (const MethodInfo& each : lumifield::methods()) {
    if (each.method == Method::reference) continue;
    methods_->addItem(text_of(each.name), static_cast<int>(each.method));
    methods_->setItemData(methods_->count() - 1, text_of(each.what), Qt::ToolTipRole);
  }
  methods_->setAccessibleName(tr("Method that computes the light"));
  methods_->setMinimumWidth(methods_->fontMetrics().horizontalAdvance("position-dependent"));  // the others give way
  samples_->setLocale(QLocale::c());
  samples_->setRange(1, most_offered);
  samples_->setValue(static_cast<int>(method_.samples));
  samples_->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
  samples_->setKeyboardTracking(false);
  samples_->setAccessibleName(tr("Samples"));
  samples_->setToolTip(samples_tip(Method::position_dependent));
  auto* name = new QLabel(tr("Light by"), this);
  name->setBuddy(methods_);
  row->addWidget(name);
  row->addWidget(methods_);
  row->addWidget(samples_);
  connect(methods_, &QComboBox::currentIndexChanged, this,
          [this] { choose(static_cast<Method>(methods_->currentData().toInt())); });
  connect(samples_, &QSpinBox::valueChanged, this, [this](int samples) {
    MethodSettings method = method_;
    method.samples = samples;
    tell(method);
  });
}

void PreviewMethodBar::add_shadows(QHBoxLayout* row) {
  for (const VisibilityInfo& each : visibilities()) {
    shadows_->addItem(text_of(each.name), static_cast<int>(each.visibility));
    shadows_->setItemData(shadows_->count() - 1, text_of(each.what), Qt::ToolTipRole);
  }
  shadows_->setCurrentIndex(static_cast<int>(Visibility::tile));
  shadows_->setAccessibleName(tr("What casts shadows"));
  refresh_->setText(tr("Refresh"));
  refresh_->setToolTip(
      tr("Published shadows stand where the first cells had their light: from now on where all have it"));
  auto* name = new QLabel(tr("Shadows"), this);
  name->setBuddy(shadows_);
  row->addWidget(name);
  row->addWidget(shadows_);
  row->addWidget(refresh_);
  explain_shadows();
  connect(shadows_, &QComboBox::currentIndexChanged, this, [this] {
    explain_shadows();
    emit visibilityChanged(visibility());
  });
  connect(refresh_, &QToolButton::clicked, this, &PreviewMethodBar::shadowsToBeRefreshed);
}

void PreviewMethodBar::explain_shadows() {
  const bool own = has_own_shadows(method_.method) && visibility() != Visibility::none;
  shadows_->setToolTip(
      own ? tr("What casts shadows: %1 has %2, a depth map of each, whatever is chosen but none")
                .arg(text_of(to_string(method_.method)), text_of(shadows_of(method_.method, visibility())))
          : tr("What casts shadows: %1").arg(text_of(info(visibility()).what)));
  refresh_->setVisible(!own && visibility() == Visibility::published);
}

Visibility PreviewMethodBar::visibility() const { return static_cast<Visibility>(shadows_->currentData().toInt()); }

bool PreviewMethodBar::environment() const { return environment_->isChecked(); }

void PreviewMethodBar::offer_environment(bool offered) { environment_->setVisible(offered); }

void PreviewMethodBar::choose(Method chosen) {
  const MethodCost cost = info(chosen).cost;
  samples_->setVisible(info(chosen).samples > 0);
  samples_->setSuffix(cost == MethodCost::lights ? tr(" lights") : tr(" samples"));
  if (const QString tip = samples_tip(chosen); !tip.isEmpty()) samples_->setToolTip(tip);
  methods_->setToolTip(tr("How the light is computed: %1").arg(text_of(info(chosen).what)));
  MethodSettings method = method_;
  method.method = chosen;
  method.spots = {};
  if (chosen == Method::shift_invariant) method.spots.look_up = SpotLookUp::textured;
  // Lights in all are other numbers than samples for each pixel.
  if (info(chosen).samples > 0 && cost != info(counted_).cost) {
    const QSignalBlocker quiet(samples_);
    samples_->setValue(static_cast<int>(info(chosen).samples));
    method.samples = info(chosen).samples;
  }
  if (info(chosen).samples > 0) counted_ = chosen;
  tell(method);
}

void PreviewMethodBar::tell(const MethodSettings& method) {
  if (method.method == method_.method && method.samples == method_.samples) return;
  method_ = method;
  explain_shadows();
  emit methodChanged(method_);
}

}  // namespace lumifield
