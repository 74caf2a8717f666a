#include "app/views/orbit_camera.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <vector>

namespace lumifield {
namespace {

constexpr double height_px = 600;

/// Where a point is seen: pixels from the picture's centre, by the definition of a pinhole camera.
Vec2 project(const SceneCamera& camera, const Vec3& point) {
  const Vec3 forward = (camera.target_mm - camera.position_mm).normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), up = right.cross(forward);
  const Vec3 q = point - camera.position_mm;
  const double focal_px = height_px / 2 / std::tan(camera.fov_y_deg * std::numbers::pi / 360);
  return focal_px / q.dot(forward) * Vec2(q.dot(right), -q.dot(up));
}

/// The point of the target's depth that is seen there.
Vec3 point_at(const SceneCamera& camera, const Vec2& pixel) {
  const Vec3 view = camera.target_mm - camera.position_mm, forward = view.normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), up = right.cross(forward);
  const double mm = view.norm() * std::tan(camera.fov_y_deg * std::numbers::pi / 360) / (height_px / 2);
  return camera.target_mm + mm * (pixel.x() * right - pixel.y() * up);
}

std::vector<SceneCamera> cameras() {
  std::vector<SceneCamera> all = {{{2350, 2350, 1350}, {300, 300, 470}, {0, 0, 1}, 25},
                                  {{0, 0, 500}, {0, 0, 0}, {0, 1, 0}, 40},
                                  {{0, 900, 1}, {0, 0, 0}, {0, -2, 0}, 40}};  // nearly along up
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1, 1);
  const auto vector = [&](double size) { return Vec3(size * Vec3(share(random), share(random), share(random))); };
  for (int k = 0; k < 50; ++k) all.push_back({vector(1000), vector(1000), vector(3), 40});
  return all;
}

TEST(OrbitCamera, KeepsTheScenesOwnCamera) {
  for (const SceneCamera& home : cameras()) {
    const SceneCamera kept = OrbitCamera(home).camera();
    EXPECT_LT((kept.position_mm - home.position_mm).norm(), 1e-9);
    EXPECT_EQ(kept.target_mm, home.target_mm);
    EXPECT_EQ(kept.up, home.up);
    EXPECT_EQ(kept.fov_y_deg, home.fov_y_deg);
  }
}

TEST(OrbitCamera, AnyViewBecomesTheSameOrbitAgain) {
  for (const SceneCamera& home : cameras()) {
    OrbitCamera orbit(home);
    orbit.orbit(100, -20);
    orbit.pan(30, 50, height_px);
    orbit.zoom(-3, {10, 20}, height_px);
    const OrbitCamera again(orbit.camera());
    EXPECT_NEAR(again.distance_mm(), orbit.distance_mm(), 1e-9 * orbit.distance_mm());
    EXPECT_NEAR(again.azimuth_deg(), orbit.azimuth_deg(), 1e-6);
    EXPECT_NEAR(again.elevation_deg(), orbit.elevation_deg(), 1e-6);
    EXPECT_LT((again.camera().position_mm - orbit.camera().position_mm).norm(), 1e-8);
  }
}

TEST(OrbitCamera, OrbitsAboutItsTargetAndStopsBeforeUp) {
  OrbitCamera orbit(SceneCamera{{1000, 0, 0}, {0, 0, 0}, {0, 0, 1}, 45});
  EXPECT_NEAR(orbit.azimuth_deg(), 0, 1e-12);
  orbit.orbit(90, 0);
  EXPECT_LT((orbit.camera().position_mm - Vec3(0, 1000, 0)).norm(), 1e-9);
  orbit.orbit(100, 30);
  EXPECT_NEAR(orbit.azimuth_deg(), -170, 1e-9);
  EXPECT_NEAR(orbit.camera().position_mm.z(), 500, 1e-9);
  orbit.orbit(0, 1000);
  EXPECT_NEAR(orbit.elevation_deg(), OrbitCamera::highest_elevation_deg, 1e-9);
  orbit.orbit(0, -1000);
  EXPECT_NEAR(orbit.elevation_deg(), -OrbitCamera::highest_elevation_deg, 1e-9);
  EXPECT_NEAR(orbit.distance_mm(), 1000, 1e-9);
}

TEST(OrbitCamera, PanCarriesThePointUnderTheCursor) {
  for (const SceneCamera& home : cameras()) {
    OrbitCamera orbit(home);
    const Vec3 grabbed = point_at(home, {-120, 45});
    orbit.pan(70, -33, height_px);
    EXPECT_LT((project(orbit.camera(), grabbed) - Vec2(-50, 12)).norm(), 1e-6);
  }
}

TEST(OrbitCamera, ZoomKeepsThePointUnderTheCursorAndItsLimits) {
  for (const SceneCamera& home : cameras()) {
    OrbitCamera orbit(home);
    const double start = orbit.distance_mm();
    const Vec3 pointed = point_at(home, {-120, 45});
    orbit.zoom(2.5, {-120, 45}, height_px);
    EXPECT_NEAR(orbit.distance_mm(), start * std::pow(OrbitCamera::zoom_per_step, -2.5), 1e-9 * start);
    EXPECT_LT((project(orbit.camera(), pointed) - Vec2(-120, 45)).norm(), 1e-6);

    orbit.zoom(1000, {-120, 45}, height_px);
    EXPECT_NEAR(orbit.distance_mm(), OrbitCamera::nearest_share * start, 1e-9 * start);
    orbit.zoom(-1000, {0, 0}, height_px);
    EXPECT_NEAR(orbit.distance_mm(), OrbitCamera::farthest_share * start, 1e-9 * start);
    orbit.reset();
    EXPECT_LT((orbit.camera().position_mm - home.position_mm).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace lumifield
