#pragma once

#include <QWidget>

#include "app/views/notices_model.h"

class QLabel;
class QListView;
class QPushButton;

namespace lumifield {

/// What the operator was told: level, time, text; newest last. It follows the newest while the last one is in sight,
/// and never takes the focus. Ctrl+C copies what is selected, else all. GUI thread.
class NoticesPanel : public QWidget {
  Q_OBJECT

 public:
  explicit NoticesPanel(QWidget* parent = nullptr);

  const NoticesModel& notices() const { return *model_; }

 public slots:
  void add(const lumifield::OperatorNotice& notice);
  void clear();
  void copy();
  /// Whether the operator sees the list: what is in it then is read.
  void set_in_sight(bool in_sight);

 signals:
  /// How many different notices of each level are listed, for a badge.
  void countsChanged(int information, int warnings, int faults);
  /// How many came since the list was in sight.
  void unreadChanged(int unread);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  QWidget* make_buttons();
  void show_counts(int information, int warnings, int faults);

  void set_unread(int unread);

  bool in_sight_ = false;
  int unread_ = 0;
  NoticesModel* model_;
  QListView* list_;
  QLabel* counts_ = nullptr;
  QPushButton *copy_ = nullptr, *clear_ = nullptr;
};

}  // namespace lumifield
