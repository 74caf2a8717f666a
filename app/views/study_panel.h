#pragma once

#include <QWidget>

#include "app/views/latest_reading.h"
#include "app/views/operator_notice.h"
#include "luminaire/error.h"
#include "renderer/study/study.h"

class QLabel;
class QStackedWidget;
class QTabWidget;

namespace lumifield {

class ElidedLabel;
class StabilityView;
class StudyChart;

/// The last study: chart and stability table, or how to make one. Files are read off the GUI thread; one that cannot be
/// read changes nothing. GUI thread.
class StudyPanel : public QWidget {
  Q_OBJECT

 public:
  explicit StudyPanel(QWidget* parent = nullptr);

  /// Reads and shows a study.json; `opened` follows, or `noticed` with what is wrong.
  void open(const QString& file);
  /// The study of last time: read when the panel is first seen, and told of only there.
  void remember(const QString& file);
  StudyChart& chart() { return *chart_; }
  StabilityView& table() { return *table_; }

 public slots:
  void choose();

 signals:
  void opened(const QString& file);
  void noticed(const lumifield::OperatorNotice& notice);

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  QWidget* make_content();
  QWidget* make_empty();
  void read(const QString& file, bool remembered);
  void show_study(const QString& file, const Study& study);

  StudyChart* chart_;
  StabilityView* table_;
  QStackedWidget* pages_;
  QTabWidget* tabs_ = nullptr;
  ElidedLabel* name_ = nullptr;
  QLabel* why_ = nullptr;
  QString remembered_;
  LatestReading reading_{this};
};

}  // namespace lumifield
