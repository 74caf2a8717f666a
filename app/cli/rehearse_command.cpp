#include <cstdio>
#include <nlohmann/json.hpp>
#include <stop_token>

#include "app/cli/commands.h"
#include "app/cli/print_result.h"
#include "app/cli/scan_report.h"
#include "app/cli/stop_on_signal.h"
#include "app/session/rehearsal.h"
#include "luminaire/bench.h"
#include "luminaire/plan.h"

namespace lumifield {

namespace {

Result<RehearsalRequest> make_request(const RehearseOptions& options) {
  RehearsalRequest request;
  auto bench = read_bench(options.bench);
  if (!bench) return tl::unexpected(bench.error());
  auto plan = read_plan(options.plan);
  if (!plan) return tl::unexpected(plan.error());
  request.bench = std::move(*bench);
  request.plan = std::move(*plan);
  request.out = options.out;
  if (options.cell.size() == 2) request.shot = CellIndex{options.cell[0], options.cell[1]};
  return request;
}

nlohmann::ordered_json json_of(const Rehearsal& told) {
  nlohmann::ordered_json json;
  json["camera"] = told.camera;
  json["stage"] = told.stage;
  json["places"] = told.places;
  json["took_s"] = told.took_s;
  json["test_shot"] = {{"cell", {told.shot.row, told.shot.column}},
                       {"brightest_share", told.brightest_share},
                       {"saturated_share", told.quality.saturated_share},
                       {"starved_share", told.quality.starved_share},
                       {"median_snr", told.quality.median_snr},
                       {"position_error_mm", told.quality.position_error_mm},
                       {"warnings", told.quality.warnings}};
  json["reference_dn_per_s"] = told.signal_dn_per_s;
  json["scan"] = prediction_json(told.scan);
  return json;
}

std::string words(const Rehearsal& told) {
  const auto format = [](const char* pattern, auto... values) {
    char text[256];
    std::snprintf(text, sizeof text, pattern, values...);
    return std::string(text);
  };
  const Quality& q = told.quality;
  std::string text = "rehearsed on " + told.camera + " and " + told.stage + "\n";
  text += format("  corners   %d places reached, in %s\n", told.places, minutes_text(told.took_s).c_str());
  text += "  test shot cell " + to_string(told.shot) +
          format(": brightest pixel at %.0f %% of saturation, %.2f %% of S saturated, %.1f %% starved, SNR %.0f\n",
                 100 * told.brightest_share, 100 * q.saturated_share, 100 * q.starved_share, q.median_snr);
  for (const std::string& warning : q.warnings) text += "            " + warning + "\n";
  text += format("  reference %.0f DN/s\n", told.signal_dn_per_s);
  return text + "  the scan  " + prediction_line(told.scan) + "\n";
}

}  // namespace

int run_rehearse(const RehearseOptions& options) {
  const auto request = make_request(options);
  if (!request) return report_error(request.error(), options.json);
  std::stop_source stop;
  const sigset_t signals = StopOnSignal::block();
  const StopOnSignal watcher(signals, [&] { stop.request_stop(); });
  StatusLine line;
  const auto told = rehearse(*request, stop.get_token(), [&](const ScanProgress& progress) {
    if (progress.state == ScanState::done) return;  // the test shot is still to be judged
    const bool at_a_place = !progress.place.empty() && !is_final(progress.state);
    line.show(std::string(to_string(progress.state)) + (at_a_place ? ", " + progress.place : ""), at_a_place ? 1 : 0);
  });
  if (told && told->scan.has_room()) line.show("done");
  line.end();
  if (!told) return report_error(told.error(), options.json);
  std::fputs((options.json ? dump_json(json_of(*told)) + "\n" : words(*told)).c_str(), stdout);
  return told->scan.has_room() ? exit_done : exit_failed;
}

}  // namespace lumifield
