#include "app/views/lamp_pose.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace lumifield {
namespace {

/// Of numbers of some 1e3, computed in a few dozen roundings.
constexpr double rounding = 1e-9;
const Vec3 z_up(0, 0, 1);

double skew(const Pose& pose) {
  const Eigen::Matrix3d r = pose.topLeftCorner<3, 3>();
  return (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() + std::abs(r.determinant() - 1);
}

class Poses {
 public:
  Vec3 direction() { return Vec3(normal_(random_), normal_(random_), normal_(random_)).normalized(); }
  Pose pose() {
    Pose made = Pose::Identity();
    made.topLeftCorner<3, 3>() =
        Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
            .normalized()
            .toRotationMatrix();
    made.topRightCorner<3, 1>() = 1000 * direction();
    return made;
  }
  double angle(double most) { return std::uniform_real_distribution(-most, most)(random_); }

 private:
  std::mt19937 random_{7};
  std::normal_distribution<double> normal_;
};

TEST(LampPose, AnglesAreThoseOfTheBeam) {
  Pose corner;  // of resources/scenes/corner: level, into the corner and down by atan(0.363196 / 0.931713)
  corner << 0.707106781187, -0.256818272933, -0.658820441917, 1000, -0.707106781187, -0.256818272933, -0.658820441917,
      1000, 0, 0.931712804128, -0.363195884647, 760, 0, 0, 0, 1;
  const LampAngles angles = angles_of(corner, z_up);
  constexpr double digits = 1e-8;  // of the file
  EXPECT_NEAR(angles.yaw_deg, -135, digits);
  EXPECT_NEAR(angles.pitch_deg, -std::atan2(0.363195884647, 0.931712804128) * 180 / std::numbers::pi, digits);
  EXPECT_NEAR(angles.roll_deg, 0, digits);

  // From x to y: the lamp's x axis rises.
  const Pose rolled = with_angles(corner, {0, 0, 0}, {30, 0, 20}, z_up);
  EXPECT_NEAR(rolled(2, 0), std::sin(20 * std::numbers::pi / 180), rounding);
  EXPECT_LT((beam_of(rolled) - Vec3(std::cos(std::numbers::pi / 6), 0.5, 0)).norm(), rounding);
}

TEST(LampPose, AnglesMeanTheSamePlacementAgain) {
  Poses some;
  for (int k = 0; k < 200; ++k) {
    const Pose pose = some.pose();
    const Vec3 pivot = 50 * some.direction(), up = 3 * some.direction();
    const Pose again = with_angles(pose, pivot, angles_of(pose, up), up);
    EXPECT_LT((again - pose).cwiseAbs().maxCoeff(), rounding);
    const LampAngles wanted{some.angle(180), some.angle(90), some.angle(180)};
    const LampAngles got = angles_of(with_angles(pose, pivot, wanted, up), up);
    EXPECT_NEAR(std::remainder(got.yaw_deg - wanted.yaw_deg, 360), 0, 1e-6);  // ill-conditioned near up
    EXPECT_NEAR(got.pitch_deg, wanted.pitch_deg, 1e-6);
    EXPECT_NEAR(std::remainder(got.roll_deg - wanted.roll_deg, 360), 0, 1e-6);
  }
  // A beam straight down or up has no roll, but keeps its pose.
  for (const double pitch : {-90.0, 90.0}) {
    const Pose pose = with_angles(Pose::Identity(), {0, 0, 0}, {40, pitch, 0}, z_up);
    const LampAngles angles = angles_of(pose, z_up);
    EXPECT_NEAR(angles.yaw_deg, 40, rounding);
    EXPECT_EQ(angles.roll_deg, 0);
    EXPECT_LT((with_angles(pose, {0, 0, 0}, angles, z_up) - pose).cwiseAbs().maxCoeff(), rounding);
  }
}

TEST(LampPose, TurnsItsBeamAboutItsPivotAndStaysLevel) {
  Poses some;
  for (int k = 0; k < 200; ++k) {
    const Pose pose = with_angles(some.pose(), {0, 0, 0}, {some.angle(180), some.angle(80), 15}, z_up);
    const Vec3 pivot = 50 * some.direction(), direction = some.direction();
    const Pose turned = with_beam(pose, pivot, 7 * direction, z_up);
    EXPECT_LT((transform_point(turned, pivot) - transform_point(pose, pivot)).norm(), rounding);
    EXPECT_LT(skew(turned), rounding);
    const LampAngles angles = angles_of(turned, z_up);
    if (std::abs(direction.z()) > std::cos(nearest_deg * std::numbers::pi / 180)) continue;
    EXPECT_LT((beam_of(turned) - direction).norm(), rounding);
    EXPECT_NEAR(angles.roll_deg, 15, 1e-6);
  }
}

TEST(LampPose, ALampThatPointsDownTurnsTheShortestWay) {
  const Pose down = with_angles(Pose::Identity(), {0, 0, 0}, {40, -90, 0}, z_up);
  const double angle = 0.01;
  const Vec3 beam(std::sin(angle), 0, -std::cos(angle));
  const Pose turned = with_beam(down, {0, 0, 0}, beam, z_up);
  EXPECT_LT((beam_of(turned) - beam).norm(), rounding);
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(turned.topLeftCorner<3, 3>() * down.topLeftCorner<3, 3>().transpose()));
  EXPECT_NEAR(turn.angle(), angle, rounding);
  // Others come near to straight down, no nearer.
  const Pose level = with_angles(Pose::Identity(), {0, 0, 0}, {40, 0, 0}, z_up);
  const LampAngles lowest = angles_of(with_beam(level, {0, 0, 0}, {0, 0, -1}, z_up), z_up);
  EXPECT_NEAR(lowest.pitch_deg, nearest_deg - 90, 1e-6);
  EXPECT_NEAR(lowest.yaw_deg, 40, 1e-6);
}

TEST(LampPose, StaysRigidHoweverOftenItMoves) {
  Poses some;
  Pose pose = some.pose();
  pose.topLeftCorner<3, 3>() *= 1 + 5e-5;  // as a file may have it
  pose = shifted(pose, {1, 2, 3});
  EXPECT_LT(skew(pose), rounding);
  for (int k = 0; k < 10000; ++k) {
    const Pose before = pose;
    pose = shifted(pose, some.direction());
    EXPECT_LE((pose.topRightCorner<3, 1>() - before.topRightCorner<3, 1>()).norm(), 1 + rounding);
    pose = with_beam(pose, {10, 20, 0}, some.direction(), z_up);
  }
  EXPECT_LT(skew(pose), rounding);
  EXPECT_EQ(pose.row(3), Eigen::RowVector4d(0, 0, 0, 1));
}

}  // namespace
}  // namespace lumifield
