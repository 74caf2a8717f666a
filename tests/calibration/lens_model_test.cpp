#include "calibration/lens_model.h"

#include <gtest/gtest.h>

#include "tests/calibration/synthetic_bench.h"

namespace lumifield {
namespace {

TEST(LensModel, AgreesWithFixedPointUndistortion) {
  const Bench bench = test::synthetic_bench();
  const LensModel lens(bench.camera_model);
  const test::ForwardModel forward(bench);
  for (int v = 0; v < 240; v += 13) {
    for (int u = 0; u < 320; u += 11) {
      const auto ray = lens.undistort(Vec2(u, v));
      ASSERT_TRUE(ray);
      EXPECT_LT((*ray - forward.ray(u, v)).norm(), 1e-12);
      const Vec2 s = lens.meet_plane(*ray, 150).value();
      EXPECT_LT((s - forward.screen_mm(u, v)).norm(), 1e-8);
      EXPECT_LT((lens.project(Vec3(s.x(), s.y(), 150)).value() - Vec2(u, v)).norm(), 1e-8);
    }
  }
}

TEST(LensModel, ShowsNothingBeyondTheFoldOrBehind) {
  CameraModel model;
  model.width_px = model.height_px = 1000;
  model.fx = model.fy = 500;
  model.distortion = {-0.3, 0, 0, 0, 0};  // folds where 1 − 0.9 ρ² = 0
  const LensModel lens(model);
  const double fold = std::sqrt(1 / 0.9);
  EXPECT_TRUE(lens.project(Vec3(0.99 * fold, 0, 1)));
  EXPECT_FALSE(lens.project(Vec3(1.01 * fold, 0, 1)));
  EXPECT_FALSE(lens.project(Vec3(0, 0, -1)));
  EXPECT_TRUE(lens.undistort(Vec2(340, 0)));
  EXPECT_FALSE(lens.undistort(Vec2(360, 0)));
  EXPECT_FALSE(lens.meet_plane(Vec2(0, 0), -5));
}

}  // namespace
}  // namespace lumifield
