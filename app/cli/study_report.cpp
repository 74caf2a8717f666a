#include "app/cli/study_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cli/print_result.h"
#include "app/cli/status_line.h"
#include "app/session/study_plots.h"

namespace lumifield {

namespace {

std::ptrdiff_t count_of(const Study& study, StabilityOutcome outcome) {
  return std::ranges::count(study.stability, outcome, &StabilityRow::outcome);
}

/// Of the point with the least error, and of those the fastest.
std::string best_text(const StudySeries& series) {
  std::vector<StudyPoint> points = series.line;
  points.insert(points.end(), series.exact.begin(), series.exact.end());
  if (points.empty()) return {};
  const auto worse = [](const StudyPoint& a, const StudyPoint& b) {
    return std::pair(a.rel_rmse, a.time_ms) < std::pair(b.rel_rmse, b.time_ms);
  };
  const StudyPoint& best = *std::ranges::min_element(points, worse);
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "    %-27s least error %8.3g %% in %8.3g ms  %s\n",
                std::string(to_string(best.method)).c_str(), 100 * best.rel_rmse, best.time_ms,
                cost_text(best).c_str());
  return text.data();
}

}  // namespace

std::string study_summary_text(const Study& study, const std::filesystem::path& out, double time_s) {
  std::string text = out.string() + ": " + std::to_string(study.points.size()) + " points, " +
                     std::to_string(study.stability.size()) + " stability cases (" +
                     std::to_string(count_of(study, StabilityOutcome::ok)) + " ok, " +
                     std::to_string(count_of(study, StabilityOutcome::refused)) + " refused, " +
                     std::to_string(count_of(study, StabilityOutcome::failed)) + " failed), " +
                     std::to_string(study.figures.size()) + " figures, in " + minutes_text(time_s) + "\n";
  for (const StudyPlot& plot : plots_of(study).plots) {
    text += "  " + plot.luminaire + "\n";
    for (const StudySeries& series : plot.series) text += best_text(series);
  }
  for (const StabilityRow& row : study.stability)
    if (row.outcome == StabilityOutcome::failed)
      text += "  failed: " + std::string(to_string(row.method)) + ", " + row.case_name + ": " + row.reason + "\n";
  for (const StudyOmission& each : study.omissions) text += "  without " + each.part + ": " + each.reason + "\n";
  return text;
}

std::string study_summary_json(const Study& study, const std::filesystem::path& out, double time_s) {
  nlohmann::ordered_json luminaires = nlohmann::ordered_json::array();
  for (const StudyPlot& plot : plots_of(study).plots) luminaires.push_back(plot.luminaire);
  nlohmann::ordered_json omissions = nlohmann::ordered_json::array();
  for (const StudyOmission& each : study.omissions) omissions.push_back({{"part", each.part}, {"reason", each.reason}});
  return dump_json({{"out", out.string()},
                    {"scene", study.scene},
                    {"quick", study.quick},
                    {"luminaires", luminaires},
                    {"points", study.points.size()},
                    {"stability",
                     {{"ok", count_of(study, StabilityOutcome::ok)},
                      {"refused", count_of(study, StabilityOutcome::refused)},
                      {"failed", count_of(study, StabilityOutcome::failed)}}},
                    {"figures", study.figures.size()},
                    {"omissions", omissions},
                    {"time_s", time_s}}) +
         "\n";
}

}  // namespace lumifield
