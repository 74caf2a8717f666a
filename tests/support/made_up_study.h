#pragma once

#include <cmath>
#include <limits>

#include "renderer/study/study.h"

namespace lumifield::test {

/// A study of three luminaires as one may come out: closed form with levels of detail, samplers whose error falls with
/// the root of their samples, a bias, exact ones, confirming points of larger pictures. All figures are made up.
inline Study made_up_study() {
  Study study;
  study.scene = "resources/scenes/corner/scene.json";
  const auto add = [&](Method method, const char* luminaire, double cost, double time_ms, double rel_rmse) {
    study.points.push_back({method, luminaire, cost, time_ms, rel_rmse, 60 * rel_rmse, "pthread-AMD EPYC", 256, 192});
  };
  double slow = 1;
  for (const char* luminaire : {"bike", "car1", "car2"}) {
    for (const double t : {2, 4, 8, 16}) add(Method::closed_form, luminaire, t, slow * 0.7 * t, 0.04 / t / t);
    add(Method::closed_form, luminaire, 0, slow * 88, 3e-8);
    for (double k = 16; k <= 4096; k *= 4) {
      add(Method::position_dependent, luminaire, k, slow * (3 + 0.05 * k), 0.9 / std::sqrt(k));
      add(Method::position_dependent_printed, luminaire, k, slow * (3 + 0.06 * k), std::hypot(1 / std::sqrt(k), 0.06));
      add(Method::uniform_box, luminaire, k, slow * (2 + 0.03 * k), 2.5 / std::sqrt(k));
      add(Method::precomputed_lights, luminaire, 4 * k, slow * (0.2 + 0.012 * k), 5 / std::sqrt(k));
    }
    add(Method::far_field, luminaire, 0, 0.5, 0.35 * slow);
    add(Method::shift_invariant, luminaire, 0, slow * 200, 0.004);
    add(Method::reference, luminaire, 0, slow * 2900, 0);
    study.points.push_back({Method::closed_form, luminaire, 0, slow * 1400, 3e-8, 0, "pthread-AMD EPYC", 1024, 768});
    slow *= 1.4;
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const MethodInfo& each : methods())
    for (const char* name : {"on S", "between the planes", "100 m away", "grazing", "cut horizon",
                             "one pixel 1e6 times "
                             "brighter",
                             "all dark", "negative pixels"}) {
      const bool far = each.method == Method::far_field && std::string(name) != "100 m away";
      const bool printed = each.method == Method::position_dependent_printed && std::string(name) == "grazing";
      if (far)
        study.stability.push_back({each.method, name, StabilityOutcome::refused, none,
                                   "the receiver is nearer than five times the luminaire's width"});
      else if (printed)
        study.stability.push_back({each.method, name, StabilityOutcome::failed, 0.42, "off by more than it says"});
      else
        study.stability.push_back(
            {each.method, name, StabilityOutcome::ok, each.cost == MethodCost::samples ? 0.02 : 1.2e-7, ""});
    }
  study.figures = {{"Fig. 5", "bike", "secant, depth 3", "mean Lab ΔE", 1.3, 1.1}};
  return study;
}

}  // namespace lumifield::test
