#pragma once

#include <QString>
#include <QStringList>
#include <filesystem>
#include <map>

namespace lumifield {

/// The files of a scan to come.
struct NewScan {
  std::filesystem::path bench, plan, out;
  std::filesystem::path scene;  ///< lit while it is measured; empty = none
};
enum class NewScanField { bench, plan, out, scene };

/// What such a scan would be, or why it cannot.
struct ScanForecast {
  int columns = 0, rows = 0;
  int done = 0, to_do = 0;  ///< cells that `out` holds already, and the others
  double predicted_s = 0;   ///< for those to do
  double assumed_mm_s = 0;  ///< the stage's speed where the bench file gives none, for the prediction; else 0
  double disk_bytes = 0;    ///< that they take at most
  double free_bytes = -1;   ///< on the disk of `out`; negative: not known
  std::map<NewScanField, QString> faults;  ///< what is wrong with a field, and what to do
  QStringList notes;                       ///< defaults taken, members not known

  bool usable() const { return faults.empty(); }
};

/// Reads and checks the files. A dataset that is there is gone on with, if it was measured with this bench and plan.
/// Takes as long as disks do; reentrant.
ScanForecast forecast(const NewScan& scan);

/// "9 × 7 = 63 cells, about 12:34 (min:s), up to 45.4 MB of the 82.6 GB left".
QString forecast_text(const ScanForecast& forecast);

}  // namespace lumifield
