#include "app/views/scan_controls.h"

#include <QAction>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPushButton>
#include <QStackedLayout>
#include <utility>

namespace lumifield {

namespace {

constexpr const char* start_tip = "Start the scan";
constexpr const char* rehearse_tip = "Try the scan in small: corners, reference cell, a test shot";

QString with_key(const QString& tip, const QAction& action) {
  return tip + " (" + action.shortcut().toString(QKeySequence::NativeText) + ")";
}

/// A button that presses an action and follows it.
QPushButton* button_for(QAction* action, QWidget* parent) {
  auto* button = new QPushButton(action->text(), parent);
  const auto follow = [button, action] {
    button->setEnabled(action->isEnabled());
    button->setToolTip(with_key(action->toolTip(), *action));
    button->setAccessibleDescription(action->toolTip());
  };
  follow();
  QObject::connect(action, &QAction::changed, button, follow);
  QObject::connect(button, &QPushButton::clicked, action, &QAction::trigger);
  return button;
}

QHBoxLayout* tight_row(QWidget* page) {
  auto* row = new QHBoxLayout(page);
  row->setContentsMargins(0, 0, 0, 0);
  return row;
}

}  // namespace

ScanControls::ScanControls(QWidget* parent) : QWidget(parent), pages_(new QStackedLayout(this)) {
  start_ = make_action("Start", Qt::Key_F5, start_tip);
  rehearse_ = make_action("Rehearse", Qt::CTRL | Qt::Key_F5, rehearse_tip);
  pause_ = make_action("Pause", Qt::Key_F6, "Pause after the step that the bench is at");
  // The same key: never are both possible.
  resume_ = make_action("Resume", Qt::Key_F6, "Go on with the scan");
  stop_ = make_action("Stop…", Qt::SHIFT | Qt::Key_F5, "End the scan; what is stored stays");
  connect(start_, &QAction::triggered, this, &ScanControls::startRequested);
  connect(pause_, &QAction::triggered, this, &ScanControls::pauseRequested);
  connect(resume_, &QAction::triggered, this, &ScanControls::resumeRequested);
  connect(rehearse_, &QAction::triggered, this, &ScanControls::rehearseRequested);
  connect(stop_, &QAction::triggered, this, [this] {
    if (activity_ == ScanActivity::rehearsing) return emit stopRequested();
    ask_to_stop(true);
  });
  pages_->addWidget(make_buttons());
  pages_->addWidget(make_question());
  show_actions();
}

QAction* ScanControls::make_action(const QString& text, const QKeySequence& key, const QString& tip) {
  auto* action = new QAction(text, this);
  action->setShortcut(key);
  action->setToolTip(tip);
  action->setAutoRepeat(false);
  addAction(action);
  return action;
}

QWidget* ScanControls::make_buttons() {
  auto* page = new QWidget(this);
  QHBoxLayout* row = tight_row(page);
  for (QAction* action : {start_, rehearse_, pause_, resume_, stop_}) row->addWidget(button_for(action, page));
  stop_button_ = qobject_cast<QPushButton*>(row->itemAt(4)->widget());
  return page;
}

QWidget* ScanControls::make_question() {
  auto* page = new QWidget(this);
  QHBoxLayout* row = tight_row(page);
  auto* question = new QLabel("Stop? What is stored stays; Start goes on later.", page);
  question->setWordWrap(true);
  question->setMinimumWidth(question->fontMetrics().horizontalAdvance("Stop? What is stored stays;"));
  auto* yes = new QPushButton("&Stop the scan", page);
  keep_ = new QPushButton("&Keep scanning", page);
  yes->setToolTip("Halt the stage and end the scan");
  keep_->setToolTip("Go on as if nothing were pressed (Esc)");
  for (QPushButton* button : {yes, keep_}) button->setAccessibleDescription(question->text() + " " + button->toolTip());
  row->addWidget(question, 1);
  row->addWidget(yes);
  row->addWidget(keep_);
  connect(yes, &QPushButton::clicked, this, [this] {
    ask_to_stop(false);
    emit stopRequested();
  });
  connect(keep_, &QPushButton::clicked, this, [this] { ask_to_stop(false); });
  return page;
}

bool ScanControls::asks_to_stop() const { return pages_->currentIndex() == 1; }

void ScanControls::ask_to_stop(bool ask) {
  if (ask == asks_to_stop()) return;
  const bool focused = isAncestorOf(focusWidget()) || ask;
  pages_->setCurrentIndex(ask ? 1 : 0);
  if (focused) (ask ? keep_ : stop_button_)->setFocus();
}

void ScanControls::set_activity(ScanActivity activity) {
  if (std::exchange(activity_, activity) == activity) return;
  if (activity == ScanActivity::idle || activity == ScanActivity::stopping) ask_to_stop(false);
  show_actions();
}

void ScanControls::set_startable(bool startable, const QString& why_not) {
  startable_ = startable;
  why_not_ = why_not;
  show_actions();
}

void ScanControls::show_actions() {
  using enum ScanActivity;
  for (const auto& [action, tip] : {std::pair(start_, start_tip), {rehearse_, rehearse_tip}}) {
    action->setEnabled(activity_ == idle && startable_);
    action->setToolTip(activity_ == idle && !startable_ ? why_not_ : QString(tip));
  }
  pause_->setEnabled(activity_ == running);
  resume_->setEnabled(activity_ == paused || activity_ == pausing);
  stop_->setEnabled(activity_ != idle && activity_ != stopping);
}

void ScanControls::keyPressEvent(QKeyEvent* event) {
  if (event->key() == Qt::Key_Escape && asks_to_stop()) return ask_to_stop(false);
  auto* chosen = qobject_cast<QPushButton*>(focusWidget());
  if (asks_to_stop() && chosen && (event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter))
    return chosen->click();
  QWidget::keyPressEvent(event);
}

}  // namespace lumifield
