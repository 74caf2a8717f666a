#include "app/views/lamp_handle.h"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "app/views/lamp_pose.h"
#include "renderer/opengl/gbuffer.h"

namespace lumifield {
namespace {

constexpr double rounding = 1e-9;
const SceneCamera camera{{0, -1000, 300}, {0, 0, 0}, {0, 0, 1}, 40};
const PictureProjection view(camera, {10, 20}, {400, 300});
const LampShape shape{{2, -1}, {30, 20}};

/// Level, its beam at these angles; its pivot at the point.
ScenePlacement lamp_at(const Vec3& point, double yaw_deg, double pitch_deg = 0) {
  ScenePlacement lamp;
  lamp.pose = with_angles(Pose::Identity(), {0, 0, 0}, {yaw_deg, pitch_deg, 0}, camera.up);
  lamp.pose = shifted(lamp.pose, point - transform_point(lamp.pose, shape.pivot()));
  return lamp;
}

TEST(PictureProjection, PointsAndRaysAgree) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(10, 410), y(20, 320), away(1, 5000);
  for (int k = 0; k < 100; ++k) {
    const Vec2 px(x(random), y(random));
    const Vec3 point = view.eye_mm() + away(random) * view.ray(px);
    ASSERT_TRUE(view.to_px(point));
    EXPECT_LT((*view.to_px(point) - px).norm(), rounding * 1000);
    const double mm = view.mm_per_px(point);
    EXPECT_LT((*view.to_px(point + mm * view.right()) - px - Vec2(1, 0)).norm(), 1e-6);
    EXPECT_LT((*view.to_px(point + mm * view.up()) - px - Vec2(0, -1)).norm(), 1e-6);
    EXPECT_FALSE(view.to_px(2 * view.eye_mm() - point)) << "behind the eye";
  }
  EXPECT_LT((*view.to_px(camera.target_mm) - Vec2(210, 170)).norm(), 1e-9);
  EXPECT_FALSE(view.to_px(view.eye_mm()));
}

TEST(PictureProjection, IsTheRenderersCamera) {
  const auto context = EglContext::create();
  if (!context) GTEST_SKIP() << context.error().message();
  const auto scene = read_scene(LUMIFIELD_SOURCE_DIR "/resources/scenes/pillars/scene.json");
  ASSERT_TRUE(scene);
  const auto mesh = read_mesh(scene->mesh, scene->materials);
  ASSERT_TRUE(mesh);
  const auto pass = GBufferPass::create(**context, *mesh);
  ASSERT_TRUE(pass);
  const auto drawn = (*pass)->draw(scene->camera, 90, 50);
  ASSERT_TRUE(drawn);
  const PictureProjection same(scene->camera, {0, 0}, {90, 50});
  int seen = 0;
  for (int j = 0; j < 50; ++j)
    for (int i = 0; i < 90; ++i) {
      const float* at = &drawn->position[4 * static_cast<std::size_t>(90 * j + i)];
      if (at[3] == 0) continue;
      const auto px = same.to_px({at[0], at[1], at[2]});
      ASSERT_TRUE(px);
      // A ray beside its snapped triangle (1/256 px) gets the triangle's nearest point.
      EXPECT_LT((*px - Vec2(i + 0.5, j + 0.5)).norm(), 1.0 / 16);
      ++seen;
    }
  EXPECT_GT(seen, 2000);
}

TEST(LampHandle, StandsWhereTheGridIsSeen) {
  Sampling sampling{BasisKind::bell, {7.5, 6}, 4, 3, {1, -2}};
  EXPECT_EQ(shape_of(sampling).half_mm, Vec2(15, 9));
  EXPECT_EQ(shape_of(sampling).pivot(), Vec3(1, -2, 0));

  const ScenePlacement lamp = lamp_at({50, 0, 20}, 30);
  const auto handle = handle_of(view, 3, lamp, shape);
  ASSERT_TRUE(handle);
  EXPECT_EQ(handle->lamp, 3);
  EXPECT_LT((handle->centre - *view.to_px({50, 0, 20})).norm(), rounding * 1000);
  const Vec3 corner = transform_point(lamp.pose, {2 - 30, -1 + 20, 0});
  EXPECT_LT((handle->outline[3] - *view.to_px(corner)).norm(), rounding * 1000);
  const Vec3 tip = Vec3(50, 0, 20) + arrow_mm(view, lamp, shape) * beam_of(lamp.pose);
  EXPECT_LT((handle->tip - *view.to_px(tip)).norm(), rounding * 1000);

  // Across the view the arrow is as long as is said; near the eye as wide as the lamp.
  const auto across = handle_of(view, 0, lamp_at({0, 0, 0}, 0), shape);
  EXPECT_NEAR((across->tip - across->centre).norm(), arrow_px, 1e-6);
  const Vec3 near = camera.position_mm + 100 * view.forward();
  EXPECT_EQ(arrow_mm(view, lamp_at(near, 0), shape), 60);
}

TEST(LampHandle, IsNotDrawnBehindTheEyeOrOutsideThePicture) {
  EXPECT_FALSE(handle_of(view, 0, lamp_at({0, -1500, 300}, 0), shape));
  EXPECT_FALSE(handle_of(view, 0, lamp_at({3000, 0, 0}, 0), shape));
  EXPECT_FALSE(handle_of(view, 0, lamp_at(camera.position_mm + Vec3(0, 5, 0), 90), {{0, 0}, {30, 1e4}}))
      << "a corner is behind the eye";
  EXPECT_TRUE(handle_of(view, 0, lamp_at({510, 0, 0}, 90), shape)) << "its edge is in the picture";
}

TEST(LampHandle, IsHitByTipThenByBody) {
  const std::vector handles{*handle_of(view, 0, lamp_at({0, 0, 0}, 0), shape),
                            *handle_of(view, 1, lamp_at({250, 0, 0}, 90), shape)};
  const LampHandle &first = handles[0], &second = handles[1];
  EXPECT_EQ(hit(handles, first.centre), (LampHit{0, LampPart::body}));
  EXPECT_EQ(hit(handles, first.tip + Vec2(-2, reach_px - 3)), (LampHit{0, LampPart::tip}));
  EXPECT_EQ(hit(handles, (first.centre + first.tip) / 2 + Vec2(0, 4)), (LampHit{0, LampPart::body})) << "its shaft";
  EXPECT_EQ(hit(handles, second.outline[0] * 0.9 + second.centre * 0.1), (LampHit{1, LampPart::body}));
  EXPECT_FALSE(hit(handles, first.centre + Vec2(0, 40)));
  EXPECT_FALSE(hit({}, {0, 0}));
  // A beam towards the eye leaves no tip to be hit.
  const Vec3 on_axis(0, 0, 0);
  const double pitch = std::atan2(300, 1000) * 180 / std::numbers::pi;
  const std::vector towards{*handle_of(view, 0, lamp_at(on_axis, -90, pitch), shape)};
  EXPECT_EQ(hit(towards, towards[0].tip), (LampHit{0, LampPart::body}));
}

TEST(LampHandle, FollowsTheCursorAcrossTheView) {
  const Vec3 point(50, 200, 20);
  const Vec2 from(180, 160), to(310, 90);
  const Vec3 shift = shift_across(view, point, from, to);
  EXPECT_LT((*view.to_px(point + shift) - *view.to_px(point) - (to - from)).norm(), 1e-9);
  EXPECT_NEAR(view.depth_mm(point + shift), view.depth_mm(point), 1e-9);
}

TEST(LampHandle, SlidesAlongItsBeamAsNearToTheCursorAsItComes) {
  const Vec3 point(50, 200, 20), direction(1, 2, 0.3);
  const Vec2 from(180, 160), to(215, 130);
  const auto shift = shift_along(view, point, direction, from, to);
  ASSERT_TRUE(shift);
  EXPECT_LT(shift->cross(direction.normalized()).norm(), 1e-9);
  // No other place on the line is nearer to the cursor's ray.
  const Vec3 ray = view.ray(*view.to_px(point) + to - from);
  const auto away = [&](const Vec3& p) { return (p - view.eye_mm()).cross(ray).norm(); };
  for (const double other : {-1.0, 1.0})
    EXPECT_GT(away(point + *shift + other * direction.normalized()), away(point + *shift));
  EXPECT_LT(shift_along(view, point, direction, from, from)->norm(), 1e-6);
  // Exactly below a cursor that stays on the beam.
  const Vec3 further = point + 90 * direction.normalized();
  EXPECT_LT((*shift_along(view, point, direction, *view.to_px(point), *view.to_px(further)) - (further - point)).norm(),
            1e-6);
  // Towards the eye there is nothing to follow.
  EXPECT_FALSE(shift_along(view, point, point - view.eye_mm(), from, to));
}

TEST(LampHandle, TheBeamsTipFollowsTheCursor) {
  const Vec3 point(50, 200, 20);
  constexpr double length = 150;
  for (const Vec3& beam : {Vec3(0.6, 0.8, 0), Vec3(0.6, -0.8, 0)}) {
    const Vec2 tip = *view.to_px(point + length * beam);
    EXPECT_LT((*beam_below(view, point, beam, length, {7, 7}, {7, 7}) - beam).norm(), 1e-6) << "no jump";
    for (const Vec2& moved : {Vec2(-20, 10), Vec2(3, -15)}) {
      const auto turned = beam_below(view, point, beam, length, tip, tip + moved);
      ASSERT_TRUE(turned);
      EXPECT_NEAR(turned->norm(), 1, rounding);
      EXPECT_LT((*view.to_px(point + length * *turned) - tip - moved).norm(), 1e-6);
      EXPECT_GT(turned->y() * beam.y(), 0) << "on the same side";
    }
  }
}

TEST(LampHandle, BeyondItsReachTheTipGoesAroundToTheOtherSide) {
  const Vec3 point(50, 200, 20), away = Vec3(0.3, 1, 0).normalized();
  constexpr double length = 150;
  const Vec2 centre = *view.to_px(point), tip = *view.to_px(point + length * away);
  Vec3 before = *beam_below(view, point, away, length, tip, tip);
  double largest = 0;
  for (double px = tip.x() - centre.x(); px < 400; px += 0.1) {
    const Vec3 now = *beam_below(view, point, away, length, tip, centre + Vec2(px, tip.y() - centre.y()));
    largest = std::max(largest, std::acos(std::min(1.0, now.dot(before))));
    before = now;
  }
  // A tenth of a pixel at the rim: √(2 · 0.1 px · mm_per_px / length) of a turn, and no jump.
  EXPECT_LT(largest, 1.5 * std::sqrt(0.2 * view.mm_per_px(point) / length));
  EXPECT_LT(before.dot(view.ray(centre + Vec2(400, tip.y() - centre.y()))), -0.99) << "it has come around";
}

}  // namespace
}  // namespace lumifield
