#include "app/views/device_line.h"

#include <QEvent>

#include "app/views/signal_colours.h"

namespace lumifield {

namespace {

struct Saying {
  QString mark, text;
  QColor colour;
};

Saying say(const DeviceView& view, const QPalette& palette) {
  const QString name = QString::fromStdString(view.name), error = QString::fromStdString(view.error);
  switch (view.link) {
    case DeviceView::Link::closed:
      return {"○", "closed", palette.color(QPalette::WindowText)};
    case DeviceView::Link::opening:
      return {"◌", name.isEmpty() ? "opening…" : name + ", opening…", information_colour(palette)};
    case DeviceView::Link::open:
      return {"●", name.isEmpty() ? "open" : name, good_colour(palette)};
    case DeviceView::Link::failed:
      return {"✕", error.isEmpty() ? "failed" : error, fault_colour(palette)};
  }
  return {};
}

}  // namespace

DeviceLine::DeviceLine(const QString& device, QWidget* parent) : QLabel(parent), device_(device) {
  setWordWrap(true);
  setTextFormat(Qt::RichText);
  setTextInteractionFlags(Qt::TextSelectableByMouse);
  setToolTip("How the " + device.toLower() + " is connected");
  write();
}

void DeviceLine::show_device(const DeviceView& view) {
  if (view.link == view_.link && view.name == view_.name && view.error == view_.error) return;
  view_ = view;
  write();
}

void DeviceLine::write() {
  const auto [mark, words, colour] = say(view_, palette());
  const bool failed = view_.link == DeviceView::Link::failed;
  setText(QString("<span style='color:%1'>%2</span> <b>%3</b> %4")
              .arg(colour.name(), mark, device_, failed ? "failed: " + words.toHtmlEscaped() : words.toHtmlEscaped()));
  setAccessibleName(device_ + ": " + (failed ? "failed: " : "") + words);
}

void DeviceLine::changeEvent(QEvent* event) {
  if (event->type() == QEvent::PaletteChange) write();
  QLabel::changeEvent(event);
}

}  // namespace lumifield
