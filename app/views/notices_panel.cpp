#include "app/views/notices_panel.h"

#include <QAccessible>
#include <QClipboard>
#include <QGuiApplication>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QListView>
#include <QPushButton>
#include <QScrollBar>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "app/views/notice_delegate.h"

namespace lumifield {

namespace {

QString counted(int count, const QString& one, const QString& many) {
  return QString("%1 %2").arg(count).arg(count == 1 ? one : many);
}

}  // namespace

NoticesPanel::NoticesPanel(QWidget* parent)
    : QWidget(parent), model_(new NoticesModel(this)), list_(new QListView(this)) {
  list_->setModel(model_);
  list_->setItemDelegate(new NoticeDelegate(list_));
  list_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  list_->setVerticalScrollMode(QAbstractItemView::ScrollPerPixel);
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  list_->setResizeMode(QListView::Adjust);
  list_->setWordWrap(true);  // laid out anew when the width changes
  list_->setAccessibleName("Notices");
  list_->setAccessibleDescription("What happened, where, and what to do; newest last");
  list_->installEventFilter(this);
  auto* rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->addWidget(list_, 1);
  rows->addWidget(make_buttons());
  connect(model_, &NoticesModel::countsChanged, this, &NoticesPanel::show_counts);
  connect(model_, &NoticesModel::countsChanged, this, &NoticesPanel::countsChanged);
  show_counts(0, 0, 0);
}

QWidget* NoticesPanel::make_buttons() {
  auto* line = new QWidget(this);
  auto* row = new QHBoxLayout(line);
  row->setContentsMargins(8, 0, 8, 6);
  counts_ = new QLabel(line);
  counts_->setAccessibleName("Number of notices");
  copy_ = new QPushButton("Copy", line);
  copy_->setToolTip("Copy the selected notices, or all (Ctrl+C)");
  copy_->setAccessibleDescription(copy_->toolTip());
  clear_ = new QPushButton("Clear", line);
  clear_->setToolTip("Empty the list");
  clear_->setAccessibleDescription(clear_->toolTip());
  row->addWidget(counts_, 1);
  row->addWidget(copy_);
  row->addWidget(clear_);
  connect(copy_, &QPushButton::clicked, this, &NoticesPanel::copy);
  connect(clear_, &QPushButton::clicked, this, &NoticesPanel::clear);
  return line;
}

void NoticesPanel::add(const OperatorNotice& notice) {
  const QScrollBar* bar = list_->verticalScrollBar();
  const bool follow = bar->value() >= bar->maximum();
  model_->add(notice);
  if (!in_sight_) set_unread(unread_ + 1);
  if (follow) list_->scrollToBottom();
  if (notice.level == OperatorNotice::Level::information) return;
  QAccessibleEvent alert(list_, QAccessible::Alert);
  QAccessible::updateAccessibility(&alert);
}

void NoticesPanel::clear() {
  model_->clear();
  set_unread(0);
}

void NoticesPanel::set_in_sight(bool in_sight) {
  in_sight_ = in_sight;
  if (in_sight) set_unread(0);
}

void NoticesPanel::set_unread(int unread) {
  if (std::exchange(unread_, unread) != unread) emit unreadChanged(unread);
}

void NoticesPanel::copy() {
  QModelIndexList chosen = list_->selectionModel()->selectedIndexes();
  std::sort(chosen.begin(), chosen.end());
  QStringList lines;
  for (const QModelIndex& index : chosen) lines << model_->line(index.row());
  if (chosen.isEmpty())
    for (int row = 0; row < model_->rowCount(); ++row) lines << model_->line(row);
  if (!lines.isEmpty()) QGuiApplication::clipboard()->setText(lines.join('\n'));
}

bool NoticesPanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == list_ && event->type() == QEvent::KeyPress &&
      static_cast<QKeyEvent*>(event)->matches(QKeySequence::Copy)) {
    copy();
    return true;
  }
  return QWidget::eventFilter(watched, event);
}

void NoticesPanel::show_counts(int information, int warnings, int faults) {
  QStringList parts;
  if (faults > 0) parts << counted(faults, "fault", "faults");
  if (warnings > 0) parts << counted(warnings, "warning", "warnings");
  if (information > 0) parts << counted(information, "note", "notes");
  counts_->setText(parts.isEmpty() ? QString("Nothing to tell") : parts.join(", "));
  for (QPushButton* button : {copy_, clear_}) button->setEnabled(!parts.isEmpty());
}

}  // namespace lumifield
