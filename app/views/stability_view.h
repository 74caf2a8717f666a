#pragma once

#include <QTableView>

#include "renderer/study/study.h"

namespace lumifield {

class StabilityModel;

/// The stability table of a study in the window's colours. GUI thread.
class StabilityView : public QTableView {
  Q_OBJECT

 public:
  explicit StabilityView(QWidget* parent = nullptr);

  void set_study(const Study& study);

 protected:
  void changeEvent(QEvent* event) override;

 private:
  StabilityModel* model_;
};

}  // namespace lumifield
