#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "acquisition/scan/scanner.h"
#include "app/session/bench_devices.h"
#include "app/session/bench_view.h"
#include "app/session/prediction.h"

namespace lumifield {

/// What to try before a scan.
struct RehearsalRequest {
  Bench bench;
  Plan plan;
  std::optional<CellIndex> shot;  ///< the cell of the test shot; absent, the reference cell
  std::filesystem::path out;      ///< where the scan will be stored: its disk's room is looked up; it need not be there
  std::shared_ptr<BenchView> bench_view;  ///< told what the bench sees, when given
  BenchDevices devices;
};

/// What it told.
struct Rehearsal {
  std::string camera, stage;
  int places = 0;              ///< that the stage went to besides: corners of the grid, by pass
  CellIndex shot{0, 0};        ///< the test shot's cell,
  Quality quality;             ///< as the scan would record it,
  double brightest_share = 0;  ///< and its brightest pixel over saturation, of the longest exposure of any pass
  double signal_dn_per_s = 0;  ///< of the reference cell
  double took_s = 0;           ///< the rehearsal
  ScanPrediction scan;         ///< of the whole grid
};

/// Runs on the bench what a scan runs on, in small: a dark set, the grid's corners in every pass inside the limits, the
/// reference cell, and one cell as a test shot, developed but not stored; then parks. It does
/// not wait for a steady lamp. Blocks; `progress` is called at
/// every change of state. Errors: those of make_scan_plan, of the devices, of the scanner, of developing; stopped.
Result<Rehearsal> rehearse(const RehearsalRequest& request, std::stop_token stop,
                           const std::function<void(const ScanProgress&)>& progress);

}  // namespace lumifield
