#include "renderer/study/ladder_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace lumifield {

namespace {

/// The time at which a ladder reaches an error, by lines in the logarithms.
struct Reached {
  double time_ms;
  const char* beyond;  ///< said of a time that no two points hold between them, else empty
};
std::optional<Reached> time_at(std::vector<StudyPoint> ladder, double error) {
  std::ranges::sort(ladder, {}, &StudyPoint::time_ms);
  if (ladder.size() < 2) return std::nullopt;
  const auto reached = std::ranges::find_if(ladder.begin() + 1, ladder.end() - 1,
                                            [&](const StudyPoint& p) { return p.rel_rmse <= error; });
  const StudyPoint &a = *(reached - 1), &b = *reached;
  const double x0 = std::log(a.time_ms), x1 = std::log(b.time_ms);
  const double y0 = std::log(a.rel_rmse), y1 = std::log(b.rel_rmse);
  if (!(y1 < y0)) return std::nullopt;
  const char* beyond = "";
  if (b.rel_rmse > error) beyond = " (beyond the ladder, by its last slope)";
  if (a.rel_rmse < error) beyond = " (beyond the ladder's start, by its first slope)";
  return Reached{std::exp(x0 + (std::log(error) - y0) / (y1 - y0) * (x1 - x0)), beyond};
}

std::vector<StudyPoint> ladder_of(const std::vector<StudyPoint>& points, Method method, const std::string& luminaire) {
  std::vector<StudyPoint> ladder;
  for (const StudyPoint& p : points)
    if (p.method == method && p.luminaire == luminaire) ladder.push_back(p);
  return ladder;
}

}  // namespace

std::vector<FigureRow> equal_error_rows(const std::vector<StudyPoint>& points, const std::string& luminaire) {
  std::vector<FigureRow> rows;
  for (const double error : {0.005, 0.001}) {
    double ours = HUGE_VAL;
    for (const StudyPoint& p : ladder_of(points, Method::closed_form, luminaire))
      if (p.rel_rmse <= error) ours = std::min(ours, p.time_ms);
    for (const Method method : {Method::position_dependent, Method::uniform_box}) {
      const auto theirs = time_at(ladder_of(points, method, luminaire), error);
      if (!theirs || !std::isfinite(ours)) continue;
      char what[160];
      std::snprintf(what, sizeof what, "%s over closed-form at %.1f %% relative RMSE%s",
                    std::string(to_string(method)).c_str(), 100 * error, theirs->beyond);
      rows.push_back({"equal error", luminaire, what, "ratio of kernel times", theirs->time_ms / ours, std::nan("")});
    }
  }
  return rows;
}

ErrorAtTime error_at(std::vector<StudyPoint> ladder, double time_ms) {
  // Of points that take as long the better one.
  std::ranges::sort(ladder, {}, [](const StudyPoint& p) { return std::pair(p.time_ms, p.rel_rmse); });
  const auto takes_as_long = [](const StudyPoint& a, const StudyPoint& b) { return a.time_ms == b.time_ms; };
  ladder.erase(std::unique(ladder.begin(), ladder.end(), takes_as_long), ladder.end());
  if (ladder.size() < 2) return {std::nan(""), ""};
  const auto after = std::ranges::find_if(ladder.begin() + 1, ladder.end() - 1,
                                          [&](const StudyPoint& p) { return p.time_ms >= time_ms; });
  const StudyPoint &a = *(after - 1), &b = *after;
  const double share = std::log(time_ms / a.time_ms) / std::log(b.time_ms / a.time_ms);
  const char* beyond = "";
  if (time_ms > b.time_ms) beyond = " (beyond the ladder, by its last slope)";
  if (time_ms < a.time_ms) beyond = " (beyond the ladder's start, by its first slope)";
  return {a.rel_rmse * std::pow(b.rel_rmse / a.rel_rmse, share), beyond};
}

std::optional<double> next_cost(const std::vector<StudyPoint>& ladder, double time_ms, double least, double most) {
  const auto by_time = std::ranges::minmax(ladder, {}, &StudyPoint::time_ms);
  const auto by_cost = std::ranges::minmax(ladder, {}, &StudyPoint::cost);
  if (by_time.min.time_ms > time_ms && by_cost.min.cost / 4 >= least) return by_cost.min.cost / 4;
  if (by_time.max.time_ms < time_ms && by_cost.max.cost * 4 <= most) return by_cost.max.cost * 4;
  return std::nullopt;
}

std::vector<FigureRow> equal_time_rows(const std::vector<StudyPoint>& points, const std::string& luminaire) {
  const std::vector<StudyPoint> closed_form = ladder_of(points, Method::closed_form, luminaire);
  std::vector<FigureRow> rows;
  for (const StudyPoint& sampled : ladder_of(points, Method::position_dependent, luminaire)) {
    double error = without_picture;
    for (const StudyPoint& p : closed_form)
      if (p.time_ms <= sampled.time_ms) error = std::min(error, p.rel_rmse);
    char what[160];
    std::snprintf(what, sizeof what, "position-dependent, K = %g, over closed-form in no more time", sampled.cost);
    rows.push_back({"equal time", luminaire, what, "ratio of relative RMSE", sampled.rel_rmse / error, std::nan("")});
  }
  return rows;
}

}  // namespace lumifield
