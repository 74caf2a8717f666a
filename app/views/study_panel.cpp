#include "app/views/study_panel.h"

#include <QFileDialog>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QStackedWidget>
#include <QTabBar>
#include <QTabWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <set>
#include <utility>

#include "app/session/study_file.h"
#include "app/views/elided_label.h"
#include "app/views/stability_view.h"
#include "app/views/study_chart.h"

namespace lumifield {

namespace {

/// Selectable, so that it can be copied into a terminal.
constexpr const char* command = "lumifield study --luminaire NAME.lumi --scene SCENE.json --out FOLDER";

QString summary_of(const Study& study) {
  std::set<std::string> luminaires;
  for (const StudyPoint& point : study.points) luminaires.insert(point.luminaire);
  QStringList names;
  for (const std::string& name : luminaires) names << QString::fromStdString(name);
  QStringList omitted;
  for (const StudyOmission& each : study.omissions) omitted << QString::fromStdString(each.part);
  return QString("%1 points of %2%3%4")
      .arg(study.points.size())
      .arg(names.isEmpty() ? "no luminaire" : names.join(", "))
      .arg(study.quick ? "; quick study" : "")
      .arg(omitted.isEmpty() ? "" : "; without " + omitted.join("; "));
}

QString stability_title(const Study& study) {
  const auto failed = std::ranges::count(study.stability, StabilityOutcome::failed, &StabilityRow::outcome);
  return failed == 0 ? QString("&Stability") : QString("&Stability (%1 failed)").arg(failed);
}

QPushButton* make_open_button(StudyPanel* panel) {
  auto* button = new QPushButton("&Open study…", panel);
  button->setToolTip("Open the study.json of a study's folder");
  button->setAccessibleDescription(button->toolTip());
  QObject::connect(button, &QPushButton::clicked, panel, &StudyPanel::choose);
  return button;
}

}  // namespace

StudyPanel::StudyPanel(QWidget* parent)
    : QWidget(parent), chart_(new StudyChart(this)), table_(new StabilityView(this)), pages_(new QStackedWidget(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->addWidget(pages_);
  pages_->addWidget(make_empty());
  pages_->addWidget(make_content());
}

QWidget* StudyPanel::make_empty() {
  auto* page = new QWidget(this);
  auto* rows = new QVBoxLayout(page);
  auto* title = new QLabel("No study is open", page);
  QFont large = title->font();
  large.setPointSizeF(1.3 * large.pointSizeF());
  title->setFont(large);
  auto* what = new QLabel(
      "A study sets every method's error against its time on one scene, and tries the cases in which methods fail. "
      "This command makes one (minutes with --quick, else up to an hour):",
      page);
  what->setWordWrap(true);
  auto* how = new QLabel(command, page);
  how->setTextFormat(Qt::PlainText);
  how->setWordWrap(true);
  how->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  how->setAccessibleName("Command that makes a study");
  QFont fixed("monospace");
  fixed.setStyleHint(QFont::Monospace);
  how->setFont(fixed);
  why_ = new QLabel(page);
  why_->setTextFormat(Qt::PlainText);
  why_->setWordWrap(true);
  why_->hide();
  auto* line = new QHBoxLayout;
  line->addWidget(make_open_button(this));
  line->addStretch(1);
  rows->addStretch(1);
  for (QLabel* label : {title, what, how, why_}) rows->addWidget(label);
  rows->addLayout(line);
  rows->addStretch(2);
  return page;
}

QWidget* StudyPanel::make_content() {
  auto* page = new QWidget(this);
  auto* rows = new QVBoxLayout(page);
  rows->setContentsMargins(0, 0, 0, 0);
  name_ = new ElidedLabel(page);
  name_->setAccessibleName("Study");
  auto* line = new QHBoxLayout;
  line->addWidget(name_, 1);
  line->addWidget(make_open_button(this));
  tabs_ = new QTabWidget(page);
  tabs_->setDocumentMode(true);
  for (QWidget* part : {static_cast<QWidget*>(tabs_), static_cast<QWidget*>(tabs_->tabBar())})
    part->setAccessibleName("Parts of the study");
  tabs_->addTab(chart_, "&Chart");
  tabs_->setTabToolTip(0, "Error against time: relative RMSE in % over ms of one picture");
  tabs_->addTab(table_, "&Stability");
  tabs_->setTabToolTip(1, "What each method makes of the cases in which methods fail");
  rows->addLayout(line);
  rows->addWidget(tabs_, 1);
  return page;
}

void StudyPanel::open(const QString& file) {
  remembered_.clear();
  read(file, false);
}

void StudyPanel::remember(const QString& file) {
  remembered_ = file;
  if (isVisible()) showEvent(nullptr);
}

void StudyPanel::showEvent(QShowEvent* event) {
  if (event) QWidget::showEvent(event);
  if (!remembered_.isEmpty()) read(std::exchange(remembered_, QString()), true);
}

void StudyPanel::read(const QString& file, bool remembered) {
  reading_.begin([this, file, remembered]() -> std::function<void()> {
    return [this, file, remembered, study = read_study(file.toStdString())] {
      if (study) return show_study(file, *study);
      const QString fault = QString::fromStdString(study.error().message());
      if (!remembered) return emit noticed({OperatorNotice::Level::fault, fault});
      why_->setText("The last study cannot be shown: " + fault);
      why_->show();
    };
  });
}

void StudyPanel::show_study(const QString& file, const Study& study) {
  chart_->set_study(study);
  table_->set_study(study);
  tabs_->setTabText(1, stability_title(study));
  tabs_->setTabEnabled(1, !study.stability.empty());
  name_->set_text(summary_of(study));
  name_->setToolTip(file.toHtmlEscaped());
  pages_->setCurrentIndex(1);
  emit opened(file);
}

void StudyPanel::choose() {
  auto* chooser = new QFileDialog(this, "Open study", {}, "Studies (study.json *.json);;All files (*)");
  chooser->setAttribute(Qt::WA_DeleteOnClose);
  chooser->setFileMode(QFileDialog::ExistingFile);
  connect(chooser, &QFileDialog::fileSelected, this, &StudyPanel::open);
  chooser->open();
}

}  // namespace lumifield
