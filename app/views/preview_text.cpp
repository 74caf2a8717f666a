#include "app/views/preview_text.h"

#include <QStringList>
#include <algorithm>

#include "app/views/lamp_pose.h"
#include "app/views/value_text.h"

namespace lumifield {
QString progress_text(const PreviewFrame& frame) {
  const double ms = 1000 * (frame.draw_s + frame.sum_s + frame.show_s);
  QString text = QString("%1 of %2 cells · picture %3 ms").arg(frame.cells).arg(frame.total).arg(ms, 0, 'f', 0);
  const MethodInfo& method = info(frame.method.method);
  if (frame.method.method != Method::closed_form) {
    text += " · " + QString::fromUtf8(method.name.data(), static_cast<qsizetype>(method.name.size()));
    if (method.cost != MethodCost::none) text += QString(", %1").arg(frame.method.samples);
    if (method.method == Method::shift_invariant)
      text += QString(", %1").arg(to_string(frame.method.spots.look_up).data());
  }
  if (frame.visibility == Visibility::none)
    text += " · no shadows";
  else
    text += " · shadows: " + QString::fromUtf8(shadows_of(method.method, frame.visibility).data());
  if (frame.environment) text += " · environment";
  if (frame.coarse) text += " · coarse";
  return text;
}

QString missing_text(const PreviewFrame& frame) {
  const int measured = std::max(frame.measured, frame.cells), missing = frame.total - measured;
  const int late = measured - frame.cells;
  QStringList said;
  if (missing > 0 && measured == 0)
    said << QString("none of %1 cells measured yet: the scene is dark").arg(frame.total);
  else if (missing > 0)
    said << QString("%1 of %2 cells not measured yet: their light is missing").arg(missing).arg(frame.total);
  if (late > 0)
    said << QString(late == 1 ? "%1 measured cell is not in the picture yet"
                              : "%1 measured cells are not in the picture yet")
                .arg(late);
  return said.join("; ");
}

QString pixel_text(const Picture& picture, int i, int j, Quantity quantity) {
  const std::size_t pixel =
      static_cast<std::size_t>(j) * static_cast<std::size_t>(picture.width_px) + static_cast<std::size_t>(i);
  if (picture.coverage[pixel] == 0) return "background";
  const float* rgb = &picture.rgb[3 * pixel];
  const double y709 = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  QString text = "Y709 " + value_text(y709) + " " + unit_text(unit_of(quantity));
  if (rgb[0] != rgb[1] || rgb[1] != rgb[2])
    text += " · R " + value_text(rgb[0]) + " G " + value_text(rgb[1]) + " B " + value_text(rgb[2]);
  return text;
}

namespace {

/// So many decimals at most, without zeros at the end; never "−0".
QString short_number(double value, int decimals) {
  QString text = QString::number(value, 'f', decimals);
  while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) text.chop(1);
  if (text == "-0") text = "0";
  return text.replace('-', QChar(0x2212));
}

}  // namespace

QString lamp_place(int number, const ScenePlacement& lamp) {
  return QString("Lamp %1 at %2, %3, %4 mm")
      .arg(number + 1)
      .arg(short_number(lamp.pose(0, 3), 1), short_number(lamp.pose(1, 3), 1), short_number(lamp.pose(2, 3), 1));
}

QString lamp_text(int number, const ScenePlacement& lamp, const Vec3& up) {
  const LampAngles angles = angles_of(lamp.pose, up);
  return lamp_place(number, lamp) + QString(" · yaw %1° · pitch %2° · roll %3° · scale %4")
                                        .arg(short_number(angles.yaw_deg, 1), short_number(angles.pitch_deg, 1),
                                             short_number(angles.roll_deg, 1), value_text(lamp.scale));
}

QString placements_text(const std::vector<ScenePlacement>& lamps) {
  QStringList all;
  for (const ScenePlacement& lamp : lamps) {
    QStringList pose;
    for (int k = 0; k < 16; ++k) pose << QString::number(lamp.pose(k / 4, k % 4), 'g', 12);
    all << "[" + pose.join(", ") + "] " + QString::number(lamp.scale, 'g', 12);
  }
  return "luminaires (pose row by row, mm; scale): " + all.join(", ");
}

}  // namespace lumifield
