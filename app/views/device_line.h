#pragma once

#include <QLabel>

#include "app/session/bench_view.h"

namespace lumifield {

/// How a device is connected, at a glance: a mark, its name, and when it failed why and what to do. GUI thread.
class DeviceLine : public QLabel {
 public:
  explicit DeviceLine(const QString& device, QWidget* parent = nullptr);

  void show_device(const DeviceView& view);

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void write();

  QString device_;
  DeviceView view_;
};

}  // namespace lumifield
