#pragma once

#include <string>
#include <vector>

#include "renderer/study/study.h"

namespace lumifield {

/// A study as it is drawn: relative RMSE in percent against time in milliseconds, both logarithmic, a plot for each
/// luminaire, all with the same axes. Times of pictures of different sizes do not compare: the size that most points
/// have is drawn, the others are counted. Value types.

/// One method on one device, in the order of its cost.
struct StudySeries {
  Method method = Method::closed_form;
  std::string device;
  std::vector<StudyPoint> line;   ///< within the axes
  std::vector<StudyPoint> exact;  ///< with an error below least_error_percent
};

struct StudyPlot {
  std::string luminaire;
  std::vector<StudySeries> series;  ///< in the order of the methods
};

struct StudyPlots {
  std::vector<StudyPlot> plots;  ///< in the study's order
  double time_from_ms = 1, time_to_ms = 10;
  double error_from_percent = 1, error_to_percent = 10;
  int width_px = 0, height_px = 0;  ///< of the pictures whose times are drawn
  int other_size = 0;               ///< points left out: of a picture of another size
  int not_finite = 0;               ///< points left out: without a time or an error
  int out_of_range = 0;             ///< points left out: no picture takes such a time or has such an error
};

/// Smaller errors are drawn as exact: they are of float arithmetic's own size.
inline constexpr double least_error_percent = 1e-3;

/// What a chart may hold, so that its axes stay legible whatever a file holds: times from a nanosecond to a fortnight,
/// errors from none to a thousand times the picture.
inline constexpr double least_time_ms = 1e-6, largest_time_ms = 1e9, largest_error_percent = 1e5;

/// The cost at which a method is slowest comes last: more samples, more lights, more pixels and, last, all of them.
double cost_order(const StudyPoint& point);

/// "T = 4", "exact", "K = 200", "64 lights"; empty for a method without a cost.
std::string cost_text(const StudyPoint& point);

StudyPlots plots_of(const Study& study);

}  // namespace lumifield
