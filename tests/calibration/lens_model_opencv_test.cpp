// The bench file's camera model is OpenCV's: the same coefficients in the same order give the same pixels.
#include <cmath>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <random>

#include "calibration/lens_model.h"

namespace lumifield {
namespace {

TEST(LensModelOpenCv, ProjectsAsOpenCvDoes) {
  CameraModel model;
  model.width_px = 1024;
  model.height_px = 768;
  model.fx = 900;
  model.fy = 880;
  model.cx = 500;
  model.cy = 390;
  model.distortion = {-0.12, 0.03, 0.004, -0.002, -0.005};
  const double turn = 0.5;
  model.pose << 1, 0, 0, 12, 0, std::cos(turn), -std::sin(turn), -30, 0, std::sin(turn), std::cos(turn), 400, 0, 0, 0,
      1;

  const cv::Matx33d matrix(model.fx, 0, model.cx, 0, model.fy, model.cy, 0, 0, 1);
  const cv::Matx<double, 5, 1> distortion(model.distortion.data());
  const cv::Vec3d rotation(turn, 0, 0), translation(12, -30, 400);
  const LensModel lens(model);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> across(-150, 150);
  for (int k = 0; k < 200; ++k) {
    const Vec3 p(across(random), across(random), 150);
    std::vector<cv::Point2d> pixel;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, rotation, translation, matrix, distortion,
                      pixel);
    const auto ours = lens.project(p);
    ASSERT_TRUE(ours);
    EXPECT_NEAR(ours->x(), pixel[0].x, 1e-9);
    EXPECT_NEAR(ours->y(), pixel[0].y, 1e-9);
  }
}

}  // namespace
}  // namespace lumifield
