#include "app/views/start_page.h"

#include <QDragEnterEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QMimeData>
#include <QPushButton>
#include <QShortcut>
#include <QUrl>
#include <QVBoxLayout>
#include <filesystem>

#include "app/views/new_scan_dialog.h"

namespace lumifield {

namespace {

constexpr int widest_px = 560;
constexpr int folder_role = Qt::UserRole;

/// The one local folder that is dropped; empty: none.
QString dropped_folder(const QMimeData* data) {
  const QList<QUrl> urls = data->urls();
  return urls.size() == 1 && urls.front().isLocalFile() ? urls.front().toLocalFile() : QString();
}

QStringList missing_of(const QStringList& folders) {
  QStringList missing;
  for (const QString& folder : folders) {
    std::error_code code;
    if (!std::filesystem::exists(folder.toStdString(), code)) missing << folder;
  }
  return missing;
}

QString line_text(const QString& folder, bool missing) {
  return QFileInfo(folder).completeBaseName() + (missing ? " (not found)" : "") + "  —  " + folder;
}

}  // namespace

StartPage::StartPage(QWidget* parent)
    : QWidget(parent), recent_name_(new QLabel("&Last luminaires", this)), recent_(new QListWidget(this)) {
  setAcceptDrops(true);
  setAccessibleName("Start");
  auto* page = new QWidget(this);
  page->setMaximumWidth(widest_px);
  auto* around = new QHBoxLayout(this);
  around->addStretch(1);
  around->addWidget(page, 8);
  around->addStretch(1);
  auto* rows = new QVBoxLayout(page);
  auto* title = new QLabel("No luminaire is open", page);
  QFont large = title->font();
  large.setPointSizeF(1.5 * large.pointSizeF());
  title->setFont(large);
  auto* hint = new QLabel("Or drop a luminaire's folder, NAME.lumi, onto this window.", page);
  hint->setWordWrap(true);
  recent_name_->setBuddy(recent_);
  recent_->setAccessibleName("Last luminaires");
  recent_->setToolTip("Click, or press Enter, to open");
  recent_->setTextElideMode(Qt::ElideMiddle);
  recent_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  recent_->setAlternatingRowColors(true);
  rows->addStretch(1);
  rows->addWidget(title);
  rows->addSpacing(8);
  rows->addWidget(make_buttons());
  rows->addWidget(hint);
  rows->addSpacing(16);
  rows->addWidget(recent_name_);
  rows->addWidget(recent_, 6);
  rows->addStretch(1);
  connect(recent_, &QListWidget::itemClicked, this, &StartPage::open_recent);
  for (const Qt::Key key : {Qt::Key_Return, Qt::Key_Enter}) {
    auto* enter = new QShortcut(key, recent_, nullptr, nullptr, Qt::WidgetShortcut);
    connect(enter, &QShortcut::activated, this, [this] { open_recent(recent_->currentItem()); });
  }
  set_recent({});
}

QWidget* StartPage::make_buttons() {
  auto* line = new QWidget(this);
  auto* row = new QHBoxLayout(line);
  row->setContentsMargins(0, 0, 0, 0);
  auto* scan = new QPushButton("&New scan…", line);
  auto* open = new QPushButton("&Open luminaire…", line);
  scan->setToolTip("Choose bench, plan and a place for the luminaire");
  open->setToolTip("Open a luminaire's folder, measured whole or in part");
  for (QPushButton* button : {scan, open}) {
    button->setAccessibleDescription(button->toolTip());
    button->setMinimumHeight(2 * button->fontMetrics().height() + 6);
    row->addWidget(button);
  }
  connect(scan, &QPushButton::clicked, this, &StartPage::choose_scan);
  connect(open, &QPushButton::clicked, this, &StartPage::choose_luminaire);
  return line;
}

void StartPage::set_recent(const QStringList& folders) {
  recent_->clear();
  for (const QString& folder : folders) {
    auto* item = new QListWidgetItem(line_text(folder, false), recent_);
    item->setData(folder_role, folder);
    item->setToolTip(folder);
  }
  for (QWidget* part : {static_cast<QWidget*>(recent_name_), static_cast<QWidget*>(recent_)})
    part->setVisible(!folders.isEmpty());
  reading_.begin([this, folders]() -> std::function<void()> {
    return [this, missing = missing_of(folders)] { show_missing(missing); };
  });
}

void StartPage::open_recent(const QListWidgetItem* item) {
  if (item && item->flags() & Qt::ItemIsEnabled) emit openRequested(item->data(folder_role).toString());
}

void StartPage::show_missing(const QStringList& missing) {
  for (int row = 0; row < recent_->count(); ++row) {
    QListWidgetItem* item = recent_->item(row);
    const QString folder = item->data(folder_role).toString();
    if (!missing.contains(folder)) continue;
    item->setFlags(item->flags() & ~Qt::ItemIsEnabled);
    item->setText(line_text(folder, true));
    item->setToolTip(folder + " is not there any more, or its disk is not mounted");
  }
}

void StartPage::choose_scan() {
  auto* dialog = new NewScanDialog(this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->set_scan(NewScanDialog::suggested());
  connect(dialog, &NewScanDialog::newScanRequested, this, &StartPage::newScanRequested);
  dialog->open();
}

void StartPage::choose_luminaire() {
  auto* chooser = new QFileDialog(this, "Open luminaire");
  chooser->setAttribute(Qt::WA_DeleteOnClose);
  chooser->setFileMode(QFileDialog::Directory);
  chooser->setOption(QFileDialog::ShowDirsOnly);
  connect(chooser, &QFileDialog::fileSelected, this, &StartPage::openRequested);
  chooser->open();
}

void StartPage::dragEnterEvent(QDragEnterEvent* event) {
  if (!dropped_folder(event->mimeData()).isEmpty()) event->acceptProposedAction();
}

void StartPage::dropEvent(QDropEvent* event) {
  const QString folder = dropped_folder(event->mimeData());
  if (folder.isEmpty()) return;
  event->acceptProposedAction();
  emit openRequested(folder);
}

}  // namespace lumifield
