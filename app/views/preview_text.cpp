#include "app/views/preview_text.h"

#include <QStringList>
#include <algorithm>
#include <cmath>

#include "app/views/lamp_pose.h"
#include "app/views/value_text.h"

namespace lumifield {
namespace {

QString text_of(std::string_view text) { return QString::fromUtf8(text.data(), static_cast<qsizetype>(text.size())); }

QString method_text(const MethodSettings& settings) {
  const MethodInfo& method = info(settings.method);
  const bool counted = method.cost != MethodCost::none && settings.method != Method::closed_form;
  QString text = text_of(method.name) + (counted ? QString(", %1").arg(settings.samples) : QString());
  if (settings.method == Method::shift_invariant) text += ", " + text_of(to_string(settings.spots.look_up));
  return text;
}

QString shadows_text(Method method, Visibility visibility) {
  if (visibility == Visibility::none) return "no shadows";
  return "shadows: " + text_of(shadows_of(method, visibility));
}

QString light_text(const PreviewChoice& light) {
  return method_text(light.method) + " · " + shadows_text(light.method.method, light.visibility) +
         (light.environment ? " · environment" : "");
}

bool same_method(const MethodSettings& a, const MethodSettings& b) {
  return a.method == b.method &&
         (a.samples == b.samples || info(a.method).cost == MethodCost::none || a.method == Method::closed_form);
}

bool same_light(const PreviewChoice& a, const PreviewChoice& b) {
  return same_method(a.method, b.method) && a.visibility == b.visibility && a.environment == b.environment;
}

/// ", finer in about 12 s"; ", a finer one follows".
QString finer_text(const PreviewProgress& progress) {
  if (!progress.working) return {};
  return !progress.coarse && progress.left_s > 0 ? ", finer in " + about_text(progress.left_s)
                                                 : ", a finer one follows";
}

/// ": 35 %, about 12 s left", once some is done.
QString share_text(const PreviewProgress& progress) {
  if (!(progress.working && progress.share > 0)) return {};
  const QString share = QString(": %1 %").arg(static_cast<int>(100 * progress.share));
  return progress.left_s > 0 ? share + ", " + about_text(progress.left_s) + " left" : share;
}

}  // namespace

QString about_text(double seconds) {
  return seconds < 90 ? QString("about %1 s").arg(std::ceil(seconds))
                      : QString("about %1 min").arg(std::ceil(seconds / 60));
}

QString progress_text(const PreviewFrame& frame, const PreviewProgress& progress) {
  const double ms = 1000 * (frame.draw_s + frame.sum_s + frame.show_s);
  QString text = QString("%1 of %2 cells · picture %3 ms").arg(frame.cells).arg(frame.total).arg(ms, 0, 'f', 0);
  if (frame.method.method != Method::closed_form) text += " · " + method_text(frame.method);
  text += " · " + shadows_text(frame.method.method, frame.visibility);
  if (frame.environment) text += " · environment";
  if (frame.coarse) return text + " · coarse" + finer_text(progress);
  return progress.working && progress.left_s > 0 ? text + " · next in " + about_text(progress.left_s) : text;
}

QString missing_text(const PreviewFrame& frame, PreviewCells now) {
  const int measured = std::max({now.measured, frame.measured, frame.cells}), late = measured - frame.cells;
  const int missing = frame.total - measured - now.damaged;
  QStringList said;
  if (missing > 0 && measured == 0)
    said << QString("none of %1 cells measured yet: the scene is dark").arg(frame.total);
  else if (missing > 0)
    said << QString("%1 of %2 cells not measured yet: their light is missing").arg(missing).arg(frame.total);
  if (now.damaged > 0)
    said << QString(now.damaged == 1 ? "%1 cell is damaged: its light is missing (see Notices)"
                                     : "%1 cells are damaged: their light is missing (see Notices)")
                .arg(now.damaged);
  if (frame.half > 0)
    said << QString(frame.half == 1 ? "%1 cell is shown in one pass alone: the light of the other is missing"
                                    : "%1 cells are shown in one pass alone: the light of the other is missing")
                .arg(frame.half);
  if (late > 0)
    said << QString(late == 1 ? "%1 measured cell is not in the picture yet"
                              : "%1 measured cells are not in the picture yet")
                .arg(late);
  return said.join("; ");
}

QString coming_text(const PreviewFrame* frame, const PreviewProgress& progress, const PreviewChoice& chosen) {
  const PreviewChoice shown = frame ? PreviewChoice{frame->method, frame->visibility, frame->environment} : chosen;
  if (frame && same_light(shown, chosen)) return {};
  const QString instead = frame ? ". Shown: " + light_text(shown) : QString();
  // What is not taken yet has no progress of its own.
  const bool taken = same_method(progress.asked, chosen.method) && progress.visibility == chosen.visibility;
  if (taken && progress.refused)
    return QString("No picture by %1: %2")
        .arg(light_text(chosen), QString::fromStdString(progress.refused->message()) + instead);
  return "Computing " + light_text(chosen) + (taken ? share_text(progress) : QString()) + instead;
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
