#pragma once

#include <QStringList>
#include <QWidget>

#include "app/views/latest_reading.h"

class QLabel;
class QListWidget;
class QListWidgetItem;
class QPushButton;

namespace lumifield {

/// What the window shows while no luminaire is open: a new scan, a luminaire's folder to open, chosen, dropped, or one
/// of the last. Those that are not there any more are greyed; their disks are asked off the GUI thread. GUI thread.
class StartPage : public QWidget {
  Q_OBJECT

 public:
  explicit StartPage(QWidget* parent = nullptr);

  /// Folders, the latest first.
  void set_recent(const QStringList& folders);

 public slots:
  /// Opens the dialog of a new scan, with the last one's files.
  void choose_scan();
  void choose_luminaire();

 signals:
  void openRequested(const QString& folder);
  /// Checked. `scene` may be empty.
  void newScanRequested(const QString& bench, const QString& plan, const QString& out, const QString& scene);

 protected:
  void dragEnterEvent(QDragEnterEvent* event) override;
  void dropEvent(QDropEvent* event) override;

 private:
  QWidget* make_buttons();
  void open_recent(const QListWidgetItem* item);
  void show_missing(const QStringList& missing);

  QLabel* recent_name_;
  QListWidget* recent_;
  LatestReading reading_{this};
};

}  // namespace lumifield
