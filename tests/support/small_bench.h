#pragma once

#include "luminaire/bench.h"
#include "luminaire/plan.h"

namespace lumifield::test {

/// A bench with a bell slide of 7.5 mm and window 4 before a lamp of 36 × 22 mm, and the 9 × 7 plan that covers it.
inline Bench bell_bench() {
  Bench bench;
  bench.camera.readout_s = 0.02;
  bench.stage.rapid_mm_s = 50;
  bench.stage.acceleration_mm_s2 = 500;
  bench.limits = {{-40, -40}, {130, 120}};
  bench.lamp_size_mm = {36, 22};
  bench.separation_mm = 150;
  const Dual dual(BasisKind::bell, 4);
  bench.filter = {BasisKind::bell,
                  {7.5, 7.5},
                  4,
                  {{"positive", {0, 0}, dual.k_positive()}, {"negative", {90, 0}, -dual.k_negative()}},
                  {0, 90}};
  return bench;
}

inline Plan bell_plan() {
  Plan plan;
  plan.columns = 9;
  plan.rows = 7;
  plan.exposures_s = {0.002, 0.008, 0.032};
  plan.settle_s = 0.1;
  plan.dark_every_cells = 21;
  plan.reference = {{3, 4}, 10, 0.01};
  return plan;
}

/// A lamp and slide for which a grid of 3 × 2 cells is enough.
inline Bench small_bench() {
  Bench bench = bell_bench();
  bench.lamp_size_mm = {4, 4};
  bench.filter.window = 2;
  const Dual dual(BasisKind::bell, 2);
  bench.filter.passes[0].scale = dual.k_positive();
  bench.filter.passes[1].scale = -dual.k_negative();
  return bench;
}

inline Plan small_plan() {
  Plan plan = bell_plan();
  plan.columns = 3;
  plan.rows = 2;
  plan.reference = {{1, 1}, 0, 0.01};
  plan.dark_every_cells = 0;
  return plan;
}

/// What every check before a scan lets pass: small_bench before a sensor of 160 × 120, small_plan without a wait.
inline Bench developed_bench() {
  Bench bench = small_bench();
  CameraModel& m = bench.camera_model;
  m.width_px = 160, m.height_px = 120;
  m.fx = 300, m.fy = 300, m.cx = 79.5, m.cy = 59.5;
  m.pose(2, 3) = 150;
  bench.sensor = {64, 0.25, 3, 4000, {20000}, "2024-05-01", "synthetic"};
  return bench;
}

inline Plan developed_plan() {
  Plan plan = small_plan();
  plan.measurement = {24, 18, {4, 4}, {0, 0}};
  plan.settle_s = 0;
  return plan;
}

}  // namespace lumifield::test
