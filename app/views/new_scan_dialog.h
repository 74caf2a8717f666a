#pragma once

#include <QDialog>
#include <map>

#include "app/views/latest_reading.h"
#include "app/views/scan_forecast.h"

class QGridLayout;
class QLabel;
class QLineEdit;
class QPushButton;
class QTimer;

namespace lumifield {

/// The files of a new scan: bench, plan, where the luminaire is stored, and a scene that it lights meanwhile. They are
/// read as they are named, off the GUI thread: cells, predicted time and disk space, or what is wrong with which and
/// what to do. Not modal when opened with `show`. GUI thread.
class NewScanDialog : public QDialog {
  Q_OBJECT

 public:
  explicit NewScanDialog(QWidget* parent = nullptr);

  NewScan scan() const;
  void set_scan(const NewScan& scan);
  /// The last scan's files; $LUMIFIELD_BENCH before its bench; a new name beside its luminaire, or in the documents.
  static NewScan suggested();

  void accept() override;

 signals:
  /// Checked. `scene` may be empty.
  void newScanRequested(const QString& bench, const QString& plan, const QString& out, const QString& scene);

 private:
  struct Row {
    QLineEdit* path = nullptr;
    QLabel* fault = nullptr;
  };

  void add_row(QGridLayout* grid, NewScanField field, const QString& name, const QString& hint);
  void browse(NewScanField field);
  void check();
  void show_forecast(const ScanForecast& forecast);

  std::map<NewScanField, Row> rows_;
  QLabel* forecast_ = nullptr;
  QPushButton* take_ = nullptr;
  QTimer* check_soon_;
  LatestReading reading_{this};
};

}  // namespace lumifield
