#include "acquisition/scan/exposure_ladder.h"

#include <algorithm>

#include "acquisition/scan/frame_signal.h"

namespace lumifield {

namespace {

constexpr double single_ratio = 4;
constexpr double rounding = 1e-9;  // of products of the ratio

}  // namespace

ExposureLadder exposure_ladder(const Plan& plan) {
  const std::vector<double>& own = plan.exposures_s;
  ExposureLadder ladder{own, 0, own.size()};
  if (!plan.exposure_limits_s || own.empty()) return ladder;

  const double low = plan.exposure_limits_s->shortest_s * (1 - rounding),
               high = plan.exposure_limits_s->longest_s * (1 + rounding);
  const double low_ratio = own.size() > 1 ? own[1] / own[0] : single_ratio,
               high_ratio = own.size() > 1 ? own.back() / own[own.size() - 2] : single_ratio;
  std::vector<double>& all = ladder.exposures_s;
  for (double t = own.front() / low_ratio; t >= low && all.size() <= most_exposures; t /= low_ratio) all.push_back(t);
  const auto shorter = static_cast<std::ptrdiff_t>(all.size() - own.size());
  std::reverse(all.begin(), all.end());
  std::reverse(all.begin() + shorter, all.end());
  ladder.plan_begin = static_cast<std::size_t>(shorter);
  ladder.plan_end = all.size();
  for (double t = own.back() * high_ratio; t <= high && all.size() <= most_exposures; t *= high_ratio) all.push_back(t);
  return ladder;
}

bool is_saturated(const RawImage& frame, const Sensor& sensor, double share) {
  return share_from(frame, sensor.saturation_dn) > share;
}

bool may_be_longer(const RawImage& frame, const RawImage& dark, double ratio, const Sensor& sensor, double share) {
  const double reaches_dn = (sensor.saturation_dn - sensor.black_level_dn) / ratio + sensor.black_level_dn;
  return frame.dn.size() == dark.dn.size() && share_from(frame, reaches_dn) <= share &&
         is_light(mean_difference(frame, dark));
}

}  // namespace lumifield
