#include "app/views/scan_words.h"

#include <QDateTime>
#include <QLocale>
#include <array>
#include <cmath>

namespace lumifield {

namespace {

QString words(ScanState state, const QString& place) {
  switch (state) {
    case ScanState::homing:
      return "Homing the stage";
    case ScanState::moving:
      return "Moving the stage, " + place;
    case ScanState::settling:
      return "Letting the stage settle, " + place;
    case ScanState::exposing:
      return "Exposing, " + place;
    case ScanState::stabilising:
      return "Waiting for a steady lamp, " + place;
    case ScanState::delivering:
      return "Handing on " + place;
    case ScanState::parking:
      return "Parking the stage behind the opaque patch";
    case ScanState::done:
      return "Done";
    case ScanState::stopped:
      return "Stopped; the stage stays where it is";
    case ScanState::failed:
      return "Failed";
    case ScanState::idle:
      return "About to begin";
    case ScanState::reconnecting:
      return "The camera is gone: opening it again, " + place;
    case ScanState::paused:
      return "Paused";
  }
  return {};
}

QString words(const ScanProgress& progress) {
  const auto& lamp = progress.stabilisation;
  if (!lamp) return words(progress.state, QString::fromStdString(progress.place));
  const auto percent = [](double share) { return QString::number(100 * share, 'f', 2); };
  return QString("Lamp %1 DN/s, spread %2 of %3 %, %4 at most: waiting until it is steady")
      .arg(lamp->signal_dn_per_s, 0, 'f', 0)
      .arg(lamp->spread ? percent(*lamp->spread) : "—", percent(lamp->within), duration_text(lamp->left_s));
}

}  // namespace

QString bench_words(ScanActivity activity, const ScanProgress& progress) {
  switch (activity) {
    case ScanActivity::idle:
      return "No scan is running";
    case ScanActivity::rehearsing:
      return "Rehearsing: " + words(progress);
    case ScanActivity::starting:
      return progress.state == ScanState::idle ? "Starting: checking plan, bench and devices" : words(progress);
    case ScanActivity::running:
      return words(progress);
    case ScanActivity::pausing:
      return "Pausing after this step: " + words(progress);
    case ScanActivity::paused:
      return progress.trouble.empty() ? "Paused; the reference cell is read first when the scan goes on"
                                      : "Paused: " + QString::fromStdString(progress.trouble);
    case ScanActivity::stopping:
      return "Stopping: what is measured is stored";
  }
  return {};
}

QString rehearsal_text(const Rehearsal& told) {
  const Quality& q = told.quality;
  QString text =
      QString(
          "Rehearsed in %1 on %2 and %3: %4 corner places reached; test shot of cell %5: brightest pixel at %6 % of "
          "saturation, %7 % of S saturated, %8 % starved, SNR %9")
          .arg(duration_text(told.took_s), QString::fromStdString(told.camera), QString::fromStdString(told.stage))
          .arg(told.places)
          .arg(QString::fromStdString(to_string(told.shot)))
          .arg(100 * told.brightest_share, 0, 'f', 0)
          .arg(100 * q.saturated_share, 0, 'f', 2)
          .arg(100 * q.starved_share, 0, 'f', 1)
          .arg(q.median_snr, 0, 'f', 0);
  for (const std::string& warning : q.warnings) text += ", " + QString::fromStdString(warning);
  return text + QString("; reference cell: %1 DN/s; the scan: %2")
                    .arg(told.signal_dn_per_s, 0, 'f', 0)
                    .arg(prediction_text(told.scan));
}

QString prediction_text(const ScanPrediction& scan) {
  QString text = QString("%1 cells, about %2 (min:s)").arg(scan.cells).arg(duration_text(scan.time_s));
  if (scan.stabilisation_s > 0)
    text += QString(" once the lamp is steady, at most %1 before").arg(duration_text(scan.stabilisation_s));
  text += ", up to " + bytes_text(scan.bytes);
  if (scan.free_bytes) text += QString(" of the %1 that are free").arg(bytes_text(*scan.free_bytes));
  return scan.has_room() ? text : text + ": too little room, free some";
}

QString duration_text(double seconds) {
  if (!(seconds >= 0) || seconds > 1e9) return "—";
  const auto whole = std::llround(seconds);
  const QString minutes = QString("%1:%2").arg(whole / 60 % 60, 2, 10, QChar('0')).arg(whole % 60, 2, 10, QChar('0'));
  return whole < 3600 ? minutes : QString("%1:%2").arg(whole / 3600).arg(minutes);
}

QString clock_text(const QDateTime& when, const QDateTime& now) {
  const qint64 days = now.date().daysTo(when.date());
  const QString time = when.toString("HH:mm");
  if (days == 0) return time;
  const QLocale english(QLocale::English);
  return english.toString(when.date(), days > 0 && days < 7 ? "ddd" : "d MMM") + " " + time;
}

QString bytes_text(double bytes) {
  constexpr std::array units{"B", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < units.size()) {
    bytes /= 1000;
    ++unit;
  }
  const int decimals = unit == 0 || bytes >= 99.95 ? 0 : 1;
  return QString::number(bytes, 'f', decimals) + " " + units[unit];
}

QString drift_text(double drift) {
  if (!std::isfinite(drift)) return "—";
  const QString figure = QString::number(std::abs(100 * drift), 'f', 2);
  return (drift < 0 ? "−" : "+") + figure + " %";
}

QString room_text(double free_bytes, double cell_bytes, int cells) {
  if (!(cell_bytes > 0)) return {};
  const double room = std::floor(free_bytes / cell_bytes);
  const bool scans = cells > 0 && room >= cells;
  const double count = scans ? std::floor(room / cells) : room;
  const QString number = count > 9999 ? QString("over 9999") : QString::number(count, 'f', 0);
  return QString("room for %1 %2%3").arg(number, scans ? "scan" : "cell", count == 1 ? "" : "s");
}

}  // namespace lumifield
