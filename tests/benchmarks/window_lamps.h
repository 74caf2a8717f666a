#pragma once

#include <QComboBox>
#include <QDockWidget>
#include <QTest>

#include "tests/benchmarks/window_series.h"

namespace lumifield {

/// Drags a lamp by its body for five seconds, and lets it go.
inline int drag_lamp(Shown& shown, PreviewView& view, QPoint from, Qt::KeyboardModifiers keys, const char* what) {
  const int before = shown.pictures;
  Series draw, sum, show;
  const auto note = QObject::connect(&view, &PreviewView::painted, [&](const auto& frame) {
    draw.values.push_back(1000 * frame->draw_s);
    sum.values.push_back(1000 * frame->sum_s);
    show.values.push_back(1000 * frame->show_s);
  });
  const auto start = Clock::now();
  QPoint at = from;
  int moves = 0;
  QTest::mousePress(&view, Qt::LeftButton, keys, at);
  for (; ms_since(start) < 5000; ++moves) {
    at += QPoint(moves / 40 % 2 ? -1 : 1, moves / 20 % 2 ? -1 : 1);
    QTest::mouseMove(&view, at);
    QTest::qWait(10);
  }
  QObject::disconnect(note);
  std::printf("%s: %.1f pictures/s, last %dx%d of %dx%d; to draw %.1f, to sum %.1f, to show %.1f ms (medians)\n", what,
              (shown.pictures - before) / 5.0, shown.last->shown.width_px, shown.last->shown.height_px,
              view.wanted_size().width(), view.wanted_size().height(), draw.at(0.5), sum.at(0.5), show.at(0.5));
  QTest::mouseRelease(&view, Qt::LeftButton, {}, at);
  shown.last.reset();
  const auto released = Clock::now();
  if (!wait_until([&] { return shown.last && !shown.last->coarse; }, 60'000)) return 1;
  std::printf("full picture %.0f ms after it was let go\n", ms_since(released));
  return 0;
}

inline int lamps(const QString& dataset, const QString& folder, const QString& file) {
  MainWindow window;
  window.show();
  Shown shown(window);
  window.show_scene(file);
  window.open(dataset);
  const auto full = [&] {
    return shown.last && shown.last->cells == window.workbench().model().total() && !shown.last->coarse;
  };
  if (!QTest::qWaitFor(full, 120'000)) return 1;
  QTest::qWait(500);
  shoot(window, folder, "lamps");
  auto* view = window.findChild<PreviewView*>();
  LampArrangement& all = view->lamps();
  const QRectF rect = view->picture_rect();
  const PictureProjection projection(shown.last->camera, {rect.left(), rect.top()}, {rect.width(), rect.height()});
  const auto stands = [&](int lamp) {
    const Vec2 px = *projection.to_px(transform_point(all.lamp(lamp).pose, all.shape().pivot()));
    return QPoint(qRound(px.x()), qRound(px.y()));
  };
  if (drag_lamp(shown, *view, stands(0), {}, "lamp moved") != 0) return 1;
  if (drag_lamp(shown, *view, stands(0), Qt::ControlModifier, "lamp turned") != 0) return 1;
  for (auto* box : window.findChildren<QComboBox*>())
    if (box->accessibleName() == "What casts shadows") box->setCurrentText("none");
  if (drag_lamp(shown, *view, stands(0), {}, "lamp moved, no shadows") != 0) return 1;
  for (auto* box : window.findChildren<QComboBox*>())
    if (box->accessibleName() == "What casts shadows") box->setCurrentText("tile");
  all.choose(0);
  all.add_copy();
  auto* dock = window.findChild<QDockWidget*>("lamps");
  dock->show();
  dock->raise();
  shown.last.reset();
  if (!QTest::qWaitFor(full, 60'000)) return 1;
  QTest::mouseMove(view, stands(0));
  QTest::qWait(500);
  shoot(window, folder, "lamps_two");
  return drag_lamp(shown, *view, stands(1), {}, "one of several moved");
}

}  // namespace lumifield
