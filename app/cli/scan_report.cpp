#include "app/cli/scan_report.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/print_result.h"
#include "luminaire/median.h"

namespace lumifield {

namespace {

std::string format(const char* pattern, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

double median(const std::vector<double>& values) { return values.empty() ? 0 : median_of(values); }

double largest_drift(const ScanSummary& summary) {
  double largest = 0;
  for (const ReferenceReading& reading : summary.references)
    if (std::abs(reading.drift) > std::abs(largest)) largest = reading.drift;
  return largest;
}

/// Apart from the tenths of the cells.
constexpr int stabilising = 100;

std::string bar(int done, int total) {
  constexpr int width = 30;
  const int filled = total > 0 ? width * done / total : 0;
  std::string text(static_cast<std::size_t>(filled), '#');
  text.resize(width, '.');
  return "[" + text + "] " + format("%d of %d cells", done, total);
}

std::string there_before(int cells) { return cells > 0 ? format(", %d there before", cells) : ""; }

}  // namespace

std::string progress_text(const ScanProgress& p) {
  const std::string cells = bar(p.cells_done, p.cells_total) + (p.pass.empty() ? "" : ", pass '" + p.pass + "'") +
                            there_before(p.cells_before);
  const std::string state(to_string(p.state));
  if (is_final(p.state)) return cells + ", " + state + " after " + minutes_text(p.elapsed_s);
  if (const auto& lamp = p.stabilisation)
    return cells + format(", lamp at %.0f DN/s, spread %s of %.2f %% allowed, %s left at most, %-10s",
                          lamp->signal_dn_per_s, lamp->spread ? format("%.2f %%", 100 * *lamp->spread).c_str() : "—",
                          100 * lamp->within, minutes_text(lamp->left_s).c_str(), state.c_str());
  return cells + format(", %s elapsed, %s left, %-10s", minutes_text(p.elapsed_s).c_str(),
                        minutes_text(p.left_s).c_str(), state.c_str());
}

std::string done_text(const ScanSummary& s) {
  const std::string cells = bar(s.coverage.measured, s.coverage.total);
  if (s.nothing_left()) return cells + ", done before";
  return cells + there_before(s.cells_before) + ", done in " + minutes_text(s.timing.total_s);
}

std::string prediction_line(const ScanPrediction& scan) {
  std::string text = format("%d cells, about %s", scan.cells, minutes_text(scan.time_s).c_str());
  if (scan.stabilisation_s > 0)
    text += format(" once the lamp is steady (%s at most)", minutes_text(scan.stabilisation_s).c_str());
  text += format(", up to %.1f MB", scan.bytes / 1e6);
  if (scan.free_bytes) text += format(" of %.1f MB that are free", *scan.free_bytes / 1e6);
  if (const auto& frames = scan.recording) {
    text += format(", recorded frames up to %.1f MB", frames->bytes / 1e6);
    if (frames->on_same_disk) text += " more";
    if (!frames->on_same_disk && frames->free_bytes)
      text += format(" of %.1f MB that are free there", *frames->free_bytes / 1e6);
  }
  return text + (scan.has_room() ? "" : ": TOO LITTLE ROOM, free some");
}

std::string go_on_text(const ScanKept& kept, const Error& error, bool homes) {
  if (kept.cells + kept.half_cells == 0) return {};
  if (kept.cells == kept.total) return format("all %d cells are kept", kept.total);
  std::string text = format("%d of %d cells are kept", kept.cells, kept.total);
  if (kept.half_cells > 0) text += format(", and one pass alone of %d more", kept.half_cells);
  const bool is_at_fault = error.kind == ErrorKind::fault || error.kind == ErrorKind::disk_full;
  text += is_at_fault ? "; when that is mended, run again" : "; run again";
  return text + " with --resume to go on" + (is_at_fault && homes ? " (the stage is homed first)" : "");
}

void ProgressLine::show(const ScanProgress& progress) {
  if (progress.state == ScanState::done) return;
  const int tenth = progress.cells_total > 0 ? 10 * progress.cells_done / progress.cells_total : 0;
  if (is_final(progress.state))
    line_.show(progress_text(progress));
  else if (const auto& lamp = progress.stabilisation)
    line_.show(progress_text(progress), stabilising + static_cast<int>(10 * (1 - lamp->left_s / lamp->limit_s)));
  else
    line_.show(progress_text(progress), tenth);
}

void ProgressLine::done(const ScanSummary& summary) {
  line_.show(done_text(summary));
  line_.end();
}

std::string summary_text(const ScanSummary& s) {
  const ScanTiming& t = s.timing;
  const std::string cells = s.dataset.string() + format(": %d of %d cells", s.coverage.measured, s.coverage.total);
  if (s.nothing_left()) return cells + ", complete before: nothing was left to measure\n";
  std::string text = cells + there_before(s.cells_before) + ", in " + minutes_text(t.total_s) + "\n";
  text += format("  camera    %s\n  stage     %s\n", s.camera.c_str(), s.stage.c_str());
  text +=
      format("  time      move %.1f s, settle %.1f s, exposure %.1f s, readout %.1f s, waiting %.1f s, other %.1f s\n",
             t.move_s, t.settle_s, t.exposure_s, t.readout_s, t.waiting_s, t.other_s);
  text += format("  bench idle %.1f %% of the time\n", 100 * t.idle_share());
  text += format("  per cell  develop %.0f ms, store %.0f ms, render %.0f ms (medians)\n",
                 1e3 * median(s.times.develop_s), 1e3 * median(s.times.store_s), 1e3 * median(s.times.render_s));
  if (const auto& lamp = s.stabilised())
    text += format("  lamp      %s after %s: spread %.2f %%\n", lamp->steady ? "steady" : "NOT STEADY",
                   minutes_text(lamp->watched_s).c_str(), 100 * lamp->spread);
  text += format("  reference %zu readings, largest drift %+.3f %%\n", s.references.size(), 100 * largest_drift(s));
  text +=
      format("  quality   %d cells with warnings, %d frames taken again\n", s.cells_with_warnings, s.frames_retaken);
  if (s.cells_adapted > 0) text += format("            %d cells with adapted exposures\n", s.cells_adapted);
  if (s.cameras_lost > 0) text += format("  camera    was gone %d times, %.1f s in all\n", s.cameras_lost, t.lost_s);
  text += "            (SNR is the median over lit pixels: above 1 % of the reference cell's mean)\n";
  return text;
}

nlohmann::ordered_json prediction_json(const ScanPrediction& scan) {
  nlohmann::ordered_json json{{"cells", scan.cells}, {"predicted_s", scan.time_s}, {"bytes", scan.bytes}};
  if (scan.stabilisation_s > 0) json["stabilisation_s"] = scan.stabilisation_s;
  if (scan.free_bytes) json["free_bytes"] = *scan.free_bytes;
  if (const auto& frames = scan.recording) {
    json["recording"] = {{"bytes", frames->bytes}, {"on_same_disk", frames->on_same_disk}};
    if (frames->free_bytes) json["recording"]["free_bytes"] = *frames->free_bytes;
  }
  json["room"] = scan.has_room();
  return json;
}

std::string summary_json(const ScanSummary& s) {
  const ScanTiming& t = s.timing;
  nlohmann::ordered_json json;
  json["dataset"] = s.dataset.string();
  json["cells"] = s.coverage.measured;
  json["cells_total"] = s.coverage.total;
  json["cells_before"] = s.cells_before;
  json["camera"] = s.camera;
  json["stage"] = s.stage;
  json["timing_s"] = {{"total", t.total_s},       {"move", t.move_s},       {"settle", t.settle_s},
                      {"exposure", t.exposure_s}, {"readout", t.readout_s}, {"waiting", t.waiting_s},
                      {"other", t.other_s},       {"lost", t.lost_s}};
  json["idle_share"] = t.idle_share();
  if (const auto& scan = s.prediction) json["prediction"] = prediction_json(*scan);
  json["median_s"] = {{"develop", median(s.times.develop_s)},
                      {"store", median(s.times.store_s)},
                      {"render", median(s.times.render_s)},
                      {"kernel", median(s.times.kernel_s)}};
  json["reference_drift"] = largest_drift(s);
  if (const auto& lamp = s.stabilised())
    json["stabilisation"] = {{"watched_s", lamp->watched_s}, {"spread", lamp->spread}, {"steady", lamp->steady}};
  json["frames_retaken"] = s.frames_retaken;
  json["cameras_lost"] = s.cameras_lost;
  json["cells_with_warnings"] = s.cells_with_warnings;
  json["cells_with_adapted_exposures"] = s.cells_adapted;
  json["opengl"] = s.opengl;
  json["opencl"] = s.opencl;
  return dump_json(json);
}

}  // namespace lumifield
