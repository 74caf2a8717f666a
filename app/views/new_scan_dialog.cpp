#include "app/views/new_scan_dialog.h"

#include <QDateTime>
#include <QDialogButtonBox>
#include <QFileDialog>
#include <QFileInfo>
#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSettings>
#include <QStandardPaths>
#include <QTimer>
#include <QVBoxLayout>
#include <algorithm>

#include "app/views/signal_colours.h"

namespace lumifield {

namespace {

constexpr int typing_pause_ms = 250;

QString text(const std::filesystem::path& path) { return QString::fromStdString(path.string()); }

std::filesystem::path path_of(const QString& text) { return text.trimmed().toStdString(); }

}  // namespace

NewScanDialog::NewScanDialog(QWidget* parent) : QDialog(parent), check_soon_(new QTimer(this)) {
  setWindowTitle("New scan");
  auto* column = new QVBoxLayout(this);
  auto* grid = new QGridLayout;
  column->addLayout(grid);
  add_row(grid, NewScanField::bench, "&Bench file", "Camera, stage, filter slide and their calibration (JSON)");
  add_row(grid, NewScanField::plan, "&Plan file", "Grid of cells, exposures and limits (JSON)");
  add_row(grid, NewScanField::out, "&Luminaire", "Folder that the scan makes, NAME.lumi");
  add_row(grid, NewScanField::scene, "Preview &scene",
          "Scene that the luminaire lights while it is measured (optional)");
  forecast_ = new QLabel(this);
  forecast_->setTextFormat(Qt::PlainText);
  forecast_->setWordWrap(true);
  forecast_->setAccessibleName("Forecast");
  forecast_->setMinimumHeight(3 * forecast_->fontMetrics().lineSpacing());
  column->addWidget(forecast_, 1, Qt::AlignTop);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel, this);
  take_ = buttons->button(QDialogButtonBox::Ok);
  take_->setText("Set up scan");
  take_->setToolTip("Take these files; the scan begins with Start");
  column->addWidget(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &NewScanDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &NewScanDialog::reject);
  check_soon_->setSingleShot(true);
  connect(check_soon_, &QTimer::timeout, this, &NewScanDialog::check);
  resize(600, sizeHint().height());
  set_scan({});
}

void NewScanDialog::add_row(QGridLayout* grid, NewScanField field, const QString& name, const QString& hint) {
  const int line = grid->rowCount();
  auto* label = new QLabel(name, this);
  auto* path = new QLineEdit(this);
  auto* browse_button = new QPushButton("Browse…", this);
  auto* fault = new QLabel(this);
  const QString plain = QString(name).remove('&');
  label->setBuddy(path);
  path->setToolTip(hint);
  path->setPlaceholderText(hint);
  path->setAccessibleName(plain);
  browse_button->setToolTip("Choose: " + hint);
  browse_button->setAccessibleName("Browse for the " + plain.toLower());
  browse_button->setAutoDefault(false);
  fault->setTextFormat(Qt::PlainText);
  fault->setWordWrap(true);
  fault->setTextInteractionFlags(Qt::TextSelectableByMouse);
  fault->hide();
  grid->addWidget(label, line, 0);
  grid->addWidget(path, line, 1);
  grid->addWidget(browse_button, line, 2);
  grid->addWidget(fault, line + 1, 1, 1, 2);
  rows_[field] = {path, fault};
  connect(browse_button, &QPushButton::clicked, this, [this, field] { browse(field); });
  connect(path, &QLineEdit::textChanged, this, [this] {
    take_->setEnabled(false);
    check_soon_->start(typing_pause_ms);
  });
}

void NewScanDialog::browse(NewScanField field) {
  auto* chooser = new QFileDialog(this, rows_[field].path->accessibleName(), rows_[field].path->text());
  chooser->setAttribute(Qt::WA_DeleteOnClose);
  if (field == NewScanField::out) {
    chooser->setAcceptMode(QFileDialog::AcceptSave);
    chooser->setOption(QFileDialog::DontConfirmOverwrite);
    chooser->setNameFilter("Luminaires (*.lumi)");
  } else {
    chooser->setFileMode(QFileDialog::ExistingFile);
    chooser->setNameFilters({"JSON files (*.json)", "All files (*)"});
  }
  connect(chooser, &QFileDialog::fileSelected, rows_[field].path, &QLineEdit::setText);
  chooser->open();
}

NewScan NewScanDialog::scan() const {
  const auto path = [this](NewScanField field) { return path_of(rows_.at(field).path->text()); };
  return {path(NewScanField::bench), path(NewScanField::plan), path(NewScanField::out), path(NewScanField::scene)};
}

void NewScanDialog::set_scan(const NewScan& scan) {
  rows_[NewScanField::bench].path->setText(text(scan.bench));
  rows_[NewScanField::plan].path->setText(text(scan.plan));
  rows_[NewScanField::out].path->setText(text(scan.out));
  rows_[NewScanField::scene].path->setText(text(scan.scene));
  check();
}

NewScan NewScanDialog::suggested() {
  const QSettings settings;
  const QString environment = qEnvironmentVariable("LUMIFIELD_BENCH");
  const QString last = settings.value("new_scan/out").toString();
  const QString folder =
      last.isEmpty() ? QStandardPaths::writableLocation(QStandardPaths::DocumentsLocation) : QFileInfo(last).path();
  const QString name = QDateTime::currentDateTime().toString("yyyyMMdd-HHmmss") + ".lumi";
  return {path_of(environment.isEmpty() ? settings.value("new_scan/bench").toString() : environment),
          path_of(settings.value("new_scan/plan").toString()), path_of(folder + "/" + name),
          path_of(settings.value("new_scan/scene").toString())};
}

void NewScanDialog::check() {
  check_soon_->stop();
  take_->setEnabled(false);
  reading_.begin([this, scan = scan()]() -> std::function<void()> {
    return [this, result = forecast(scan)] { show_forecast(result); };
  });
}

void NewScanDialog::show_forecast(const ScanForecast& forecast) {
  for (auto& [field, row] : rows_) {
    const auto fault = forecast.faults.find(field);
    const bool wrong = fault != forecast.faults.end();
    // A field that nobody has filled in yet is asked for, not complained about.
    const bool empty = row.path->text().trimmed().isEmpty();
    QPalette own = palette();
    if (wrong && !empty) own.setColor(QPalette::WindowText, fault_colour(own));
    row.fault->setPalette(own);
    row.fault->setText(wrong ? fault->second : QString());
    row.fault->setVisible(wrong);
    row.path->setAccessibleDescription(wrong ? fault->second : row.path->toolTip());
  }
  forecast_->setText(forecast_text(forecast));
  forecast_->setToolTip(forecast.notes.join('\n'));
  take_->setEnabled(forecast.usable());
  // Long faults take several lines.
  layout()->activate();
  resize(width(), std::max(height(), layout()->totalHeightForWidth(width())));
}

void NewScanDialog::accept() {
  if (!take_->isEnabled()) return;
  const NewScan chosen = scan();
  QSettings settings;
  settings.setValue("new_scan/bench", text(chosen.bench));
  settings.setValue("new_scan/plan", text(chosen.plan));
  settings.setValue("new_scan/out", text(chosen.out));
  settings.setValue("new_scan/scene", text(chosen.scene));
  QDialog::accept();
  emit newScanRequested(text(chosen.bench), text(chosen.plan), text(chosen.out), text(chosen.scene));
}

}  // namespace lumifield
