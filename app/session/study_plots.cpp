#include "app/session/study_plots.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <tuple>

namespace lumifield {

namespace {

double percent(const StudyPoint& point) { return 100 * point.rel_rmse; }

bool is_exact(const StudyPoint& point) { return percent(point) < least_error_percent; }

bool is_known(const StudyPoint& point) { return std::isfinite(point.time_ms) && std::isfinite(point.rel_rmse); }

bool is_within_range(const StudyPoint& point) {
  return point.time_ms >= least_time_ms && point.time_ms <= largest_time_ms && point.rel_rmse >= 0 &&
         percent(point) <= largest_error_percent;
}

/// The largest of 1, 2 and 5 times a power of ten that is not above a value, or the least that is not below.
double round_down(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  double result = decade;
  for (const double step : {2, 5, 10})
    if (step * decade <= value * (1 + 1e-12)) result = step * decade;
  return result;
}
double round_up(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  for (const double step : {1, 2, 5})
    if (step * decade >= value * (1 - 1e-12)) return step * decade;
  return 10 * decade;
}

/// Of the smaller one where two are as frequent.
std::pair<int, int> usual_size(const std::vector<StudyPoint>& points) {
  std::map<std::pair<int, int>, int> times;
  for (const StudyPoint& point : points) ++times[{point.width_px, point.height_px}];
  const auto most = std::ranges::max_element(times, {}, [](const auto& each) { return each.second; });
  return most == times.end() ? std::pair(0, 0) : most->first;
}

template <class List, class Is>
auto& found_or_added(List& list, Is is) {
  const auto found = std::ranges::find_if(list, is);
  return found == list.end() ? list.emplace_back() : *found;
}

void add(StudyPlots& plots, const StudyPoint& point) {
  StudyPlot& plot =
      found_or_added(plots.plots, [&](const StudyPlot& each) { return each.luminaire == point.luminaire; });
  plot.luminaire = point.luminaire;
  StudySeries& series = found_or_added(plot.series, [&](const StudySeries& each) {
    return std::tie(each.method, each.device) == std::tie(point.method, point.device);
  });
  series.method = point.method;
  series.device = point.device;
  (is_exact(point) ? series.exact : series.line).push_back(point);
}

/// A decade at least. Where there are exact points, which stand at the lower end of the errors, the others keep off it.
void set_axes(StudyPlots& plots, const std::vector<StudyPoint>& points) {
  if (points.empty()) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double time_from = infinity, time_to = 0, error_from = infinity, error_to = 0;
  for (const StudyPoint& point : points) {
    time_from = std::min(time_from, point.time_ms);
    time_to = std::max(time_to, point.time_ms);
    if (is_exact(point)) continue;
    error_from = std::min(error_from, percent(point));
    error_to = std::max(error_to, percent(point));
  }
  plots.time_from_ms = round_down(time_from);
  plots.time_to_ms = std::max(round_up(time_to), 10 * plots.time_from_ms);
  if (error_to == 0) return;
  const bool exact = std::ranges::any_of(points, is_exact);
  plots.error_from_percent = std::pow(10, std::floor(std::log10(exact ? error_from / 2 : error_from) + 1e-12));
  plots.error_to_percent = std::max(round_up(error_to), 10 * plots.error_from_percent);
}

}  // namespace

double cost_order(const StudyPoint& point) {
  const bool whole = info(point.method).cost == MethodCost::pixels_per_support && point.cost == 0;
  return whole ? std::numeric_limits<double>::infinity() : point.cost;
}

std::string cost_text(const StudyPoint& point) {
  char text[64] = "";
  switch (info(point.method).cost) {
    case MethodCost::none:
      break;
    case MethodCost::pixels_per_support:
      std::snprintf(text, sizeof text, point.cost == 0 ? "exact" : "T = %g", point.cost);
      break;
    case MethodCost::samples:
      std::snprintf(text, sizeof text, "K = %g", point.cost);
      break;
    case MethodCost::lights:
      std::snprintf(text, sizeof text, "%g lights", point.cost);
      break;
  }
  return text;
}

StudyPlots plots_of(const Study& study) {
  StudyPlots plots;
  std::tie(plots.width_px, plots.height_px) = usual_size(study.points);
  std::vector<StudyPoint> drawn;
  for (const StudyPoint& point : study.points) {
    if (point.width_px != plots.width_px || point.height_px != plots.height_px)
      ++plots.other_size;
    else if (!is_known(point))
      ++plots.not_finite;
    else if (!is_within_range(point))
      ++plots.out_of_range;
    else
      drawn.push_back(point);
  }
  set_axes(plots, drawn);
  std::ranges::stable_sort(drawn, {}, cost_order);
  // The luminaires in the study's order, whatever their cheapest point.
  for (const StudyPoint& point : study.points)
    found_or_added(plots.plots, [&](const StudyPlot& each) { return each.luminaire == point.luminaire; }).luminaire =
        point.luminaire;
  for (const StudyPoint& point : drawn) add(plots, point);
  for (StudyPlot& plot : plots.plots) std::ranges::stable_sort(plot.series, {}, &StudySeries::method);
  return plots;
}

}  // namespace lumifield
