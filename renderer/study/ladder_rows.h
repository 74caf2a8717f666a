#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/study/study.h"

namespace lumifield {

/// The times at which two methods reach one error, from their points of one luminaire: between points by a line in the
/// logarithms, before the first by the first line's slope and beyond the last by the last line's, which `what` says.
/// For closed-form the cheapest point that is at least as good. A method whose error does not fall there has no row.
std::vector<FigureRow> equal_error_rows(const std::vector<StudyPoint>& points, const std::string& luminaire);

/// A ladder's error at a time: between the points that are next to it in time by a line in the logarithms, before the
/// first and beyond the last by the nearest line's slope, which `beyond` says. NaN where no two points differ in time.
struct ErrorAtTime {
  double rel_rmse;
  const char* beyond;  ///< empty where two points hold the time between them
};
ErrorAtTime error_at(std::vector<StudyPoint> ladder, double time_ms);

/// The cost of one more point, so that a ladder comes to hold a time between two: a quarter of the least, or four times
/// the most. Nothing where it does, or where that cost is out of least … most.
std::optional<double> next_cost(const std::vector<StudyPoint>& ladder, double time_ms, double least, double most);

/// The relative RMSE of a method that has no picture yet: all is dark.
inline constexpr double without_picture = 1;

/// Each point of position-dependent: its error over that of closed-form's best point that takes no more time, or over
/// without_picture where there is none. Above 1 closed-form is the better one.
std::vector<FigureRow> equal_time_rows(const std::vector<StudyPoint>& points, const std::string& luminaire);

}  // namespace lumifield
