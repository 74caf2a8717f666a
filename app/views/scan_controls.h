#pragma once

#include <QWidget>

#include "app/views/scan_activity.h"

class QAction;
class QKeySequence;
class QPushButton;
class QStackedLayout;

namespace lumifield {

/// Start, rehearse, pause, resume and stop, as the scan allows. Stop asks first, in the place of the buttons, but in a
/// rehearsal, which has nothing to lose; Escape or the other answer goes on. GUI thread.
class ScanControls : public QWidget {
  Q_OBJECT

 public:
  explicit ScanControls(QWidget* parent = nullptr);

  void set_activity(ScanActivity activity);
  /// Whether there is something to start; `why_not` is the button's tooltip if not.
  void set_startable(bool startable, const QString& why_not);

  /// For menus and keys; enabled as the scan allows.
  QAction* start_action() const { return start_; }
  QAction* rehearse_action() const { return rehearse_; }
  QAction* pause_action() const { return pause_; }
  QAction* resume_action() const { return resume_; }
  QAction* stop_action() const { return stop_; }
  bool asks_to_stop() const;

 signals:
  void startRequested();
  void rehearseRequested();
  void pauseRequested();
  void resumeRequested();
  void stopRequested();

 protected:
  void keyPressEvent(QKeyEvent* event) override;

 private:
  QAction* make_action(const QString& text, const QKeySequence& key, const QString& tip);
  QWidget* make_buttons();
  QWidget* make_question();
  void ask_to_stop(bool ask);
  void show_actions();

  ScanActivity activity_ = ScanActivity::idle;
  bool startable_ = true;
  QString why_not_;
  QAction *start_, *rehearse_, *pause_, *resume_, *stop_;
  QStackedLayout* pages_;
  QPushButton *stop_button_ = nullptr, *keep_ = nullptr;
};

}  // namespace lumifield
