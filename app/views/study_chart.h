#pragma once

#include <QWidget>
#include <filesystem>
#include <memory>

#include "luminaire/error.h"
#include "renderer/study/study.h"

class QGraphicsView;

namespace lumifield {

class StudyDrawing;

/// The chart of a study in the window's colours: error against time, a plot for each luminaire, wrapped to the width
/// and scrolled where the height does not do. The tooltip of a mark tells its point. GUI thread.
class StudyChart : public QWidget {
  Q_OBJECT

 public:
  explicit StudyChart(QWidget* parent = nullptr);
  ~StudyChart() override;

  void set_study(const Study& study);
  QGraphicsView& view() { return *view_; }
  QSize sizeHint() const override { return {960, 420}; }

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void changeEvent(QEvent* event) override;

 private:
  void draw();
  void fit();

  QGraphicsView* view_;
  Study study_;
  std::unique_ptr<StudyDrawing> drawing_;
};

/// Writes the chart as study.svg and study.png (twice as fine) into `folder`, dark on white. Needs no display: where no
/// application runs, one is made for the time of the call, which then belongs to the main thread.
Status write_study_chart(const Study& study, const std::filesystem::path& folder);

}  // namespace lumifield
