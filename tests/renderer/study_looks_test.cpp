#include <cmath>
#include <gtest/gtest.h>

#include "renderer/study/frame_figures.h"
#include "renderer/study/ladder.h"
#include "renderer/study/ladder_rows.h"
#include "renderer/study/mis_figures.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/shadow_figures.h"
#include "tests/support/study_fixture.h"

namespace lumifield {
namespace {

bool go_on(double, const std::string&) { return true; }
bool stop(double, const std::string&) { return false; }

StudyPoint point(Method method, double time_ms, double error) {
  StudyPoint p{.method = method, .luminaire = "bike"};
  p.time_ms = time_ms;
  p.rel_rmse = error;
  return p;
}

TEST(EqualError, IsReadFromTheLadders) {
  // Error falls as 1/√time: 0.5 % at 400 ms, 0.1 % at 10 s, beyond the ladder.
  const std::vector<StudyPoint> points{
      point(Method::closed_form, 8, 1e-7), point(Method::closed_form, 4, 4e-3), point(Method::closed_form, 2, 0.03),
      point(Method::position_dependent, 100, 0.01), point(Method::position_dependent, 1600, 0.0025)};
  const auto rows = equal_error_rows(points, "bike");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].ours, 100, 1e-6);
  EXPECT_EQ(rows[0].what.find("beyond"), std::string::npos);
  EXPECT_NEAR(rows[1].ours, 1250, 1e-6);
  EXPECT_NE(rows[1].what.find("beyond"), std::string::npos);
  EXPECT_TRUE(equal_error_rows(points, "car1").empty());
}

TEST(EqualError, SaysThatATimeIsBeyondEitherEndOfALadder) {
  // 0.5 % lies before the first point, where the line leads to 64 ms, and 0.1 % on it.
  const std::vector<StudyPoint> points{point(Method::closed_form, 8, 1e-7), point(Method::uniform_box, 400, 0.002),
                                       point(Method::uniform_box, 1600, 0.001)};
  const auto rows = equal_error_rows(points, "bike");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0].ours, 8, 1e-6);
  EXPECT_NE(rows[0].what.find("beyond the ladder's start"), std::string::npos) << rows[0].what;
  EXPECT_NEAR(rows[1].ours, 200, 1e-6);
  EXPECT_EQ(rows[1].what.find("beyond"), std::string::npos) << rows[1].what;
}

TEST(EqualTime, IsReadFromTheLadders) {
  const std::vector<StudyPoint> points{point(Method::closed_form, 50, 0.02), point(Method::closed_form, 200, 1e-6),
                                       point(Method::position_dependent, 20, 0.3),
                                       point(Method::position_dependent, 60, 0.1),
                                       point(Method::position_dependent, 400, 0.05)};
  const auto rows = equal_time_rows(points, "bike");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_NEAR(rows[0].ours, 0.3, 1e-12) << "the closed form has no picture yet";
  EXPECT_NEAR(rows[1].ours, 5, 1e-12);
  EXPECT_NEAR(rows[2].ours, 5e4, 1e-6);
  EXPECT_TRUE(equal_time_rows(points, "car1").empty());
}

TEST(ErrorAtTime, IsReadBetweenPointsInTheirOrderInTime) {
  // Error falls as 1/√time; the point of the least K was held up and took as long as the next but one.
  const std::vector<StudyPoint> ladder{point(Method::position_dependent, 400, 0.9),
                                       point(Method::position_dependent, 100, 0.1),
                                       point(Method::position_dependent, 400, 0.05)};
  const auto between = error_at(ladder, 200);
  EXPECT_NEAR(between.rel_rmse, 0.1 / std::sqrt(2), 1e-12);
  EXPECT_STREQ(between.beyond, "");
  EXPECT_NEAR(error_at(ladder, 100).rel_rmse, 0.1, 1e-12);
  EXPECT_STREQ(error_at(ladder, 100).beyond, "");
  EXPECT_STREQ(error_at(ladder, 400).beyond, "");
  EXPECT_NEAR(error_at(ladder, 25).rel_rmse, 0.2, 1e-12);
  EXPECT_STREQ(error_at(ladder, 25).beyond, " (beyond the ladder's start, by its first slope)");
  EXPECT_NEAR(error_at(ladder, 1600).rel_rmse, 0.025, 1e-12);
  EXPECT_STREQ(error_at(ladder, 1600).beyond, " (beyond the ladder, by its last slope)");
  EXPECT_TRUE(std::isnan(error_at({ladder[0], ladder[2]}, 400).rel_rmse)) << "one time has no slope";
}

TEST(ErrorAtTime, ALadderGoesOnUntilItHoldsTheTimeOrItsCostEnds) {
  std::vector<StudyPoint> ladder;
  for (const double cost : {10.0, 40.0}) {
    ladder.push_back(point(Method::position_dependent, 2 * cost, 0.1));
    ladder.back().cost = cost;
  }
  EXPECT_EQ(next_cost(ladder, 50, 1, 640), std::nullopt);
  EXPECT_EQ(next_cost(ladder, 81, 1, 640), 160);
  EXPECT_EQ(next_cost(ladder, 81, 1, 159), std::nullopt);
  EXPECT_EQ(next_cost(ladder, 19, 1, 640), 2.5);
  EXPECT_EQ(next_cost(ladder, 19, 2.6, 640), std::nullopt);
}

TEST(StudyLook, HasAName) {
  EXPECT_EQ(StudyLook{}.name(), "");
  EXPECT_EQ((StudyLook{.visibility = Visibility::tile}).name(), "in shadow");
  EXPECT_EQ((StudyLook{.roughness = 0.05}).name(), "GGX 0.05");
  EXPECT_EQ((StudyLook{.visibility = Visibility::tile, .roughness = 0.3}).name(), "GGX 0.3, in shadow");
}

TEST_F(CacheFolder, AReferenceFollowsTilesAndLobes) {
  const LightField field = make_luminaire({.name = "small", .columns = 2, .rows = 2, .pixels = 20, .pixel_mm = 4});
  const std::vector<Receiver> at{{{10, -5, 400}, {0, 0, -1}}};
  Appearance shadow;
  shadow.visible.grid = TileGrid(field.geometry().sampling);
  shadow.visible.words.assign(shadow.visible.receiver_words(), ~0U);
  const auto lit = cached_reference(field, at, shadow, folder_).value();
  EXPECT_NEAR(lit[0] / cached_reference(field, at, {}, folder_).value()[0], 1, 1e-12) << "it sees all";
  shadow.visible.words[1] = 0;
  EXPECT_LT(cached_reference(field, at, shadow, folder_).value()[0], 0.99 * lit[0]);
  Appearance gloss;
  gloss.gloss.push_back({0, 0, -1, 0.1F, 0.04F, 0.04F, 0.04F, LOBE_GGX});
  const auto shining = cached_reference(field, at, gloss, folder_).value();
  ASSERT_EQ(shining.size(), 2u) << "irradiance, then radiance by gloss";
  EXPECT_GT(shining[1], 0);
  EXPECT_EQ(cached_reference(field, at, gloss, folder_).value(), shining);
  EXPECT_EQ(files().size(), 4u);
}

using StudyLooks = StudyOfASmallLuminaire;

TEST_F(StudyLooks, MethodsClimbInShadowWithTheSameTiles) {
  const auto pillars = camera_of("pillars");
  const auto shaded = StudyBench::create(*pillars, *luminaire_, folder_, {.visibility = Visibility::tile});
  ASSERT_TRUE(shaded) << shaded.error().message();
  EXPECT_EQ((*shaded)->name(), "small, in shadow");
  const auto climb = climb_ladder(**shaded, true, go_on);
  ASSERT_TRUE(climb) << climb.error().message();
  ASSERT_EQ(climb->points.size(), 7u) << "closed-form and position-dependent alone";
  for (const StudyPoint& p : climb->points) EXPECT_EQ(p.luminaire, "small, in shadow");
  EXPECT_LT(climb->points[0].rel_rmse, 1e-5) << "exact with these tiles";
  EXPECT_EQ(climb->points[0].lab_delta_e, 0);
  EXPECT_LT(climb->points[6].rel_rmse, 0.3 * climb->points[3].rel_rmse) << "samples get nearer";

  // Without the tiles the same picture is another.
  const auto plain = StudyBench::create(*pillars, *luminaire_, folder_);
  ASSERT_TRUE(plain);
  StudyLight lit, shadowed;
  const auto method = (*plain)->make({});
  ASSERT_TRUE(timed_evaluation(**method, (*plain)->frame(), 1, lit));
  ASSERT_TRUE(timed_evaluation(**method, (*shaded)->frame(), 1, shadowed));
  int dark = 0;
  for (std::size_t k = 0; k < lit.irradiance.size(); ++k) {
    ASSERT_LE(shadowed.irradiance[k], 1.0001 * lit.irradiance[k]) << k;
    dark += shadowed.irradiance[k] < 0.5 * lit.irradiance[k];
  }
  EXPECT_GT(dark, 500) << "pillars stand before the lamp";
  EXPECT_LT(dark, 20000);
}

TEST_F(StudyLooks, MethodsClimbWithGloss) {
  const auto bench = StudyBench::create(*camera_, *luminaire_, folder_, {.roughness = 0.3});
  ASSERT_TRUE(bench) << bench.error().message();
  const auto climb = climb_ladder(**bench, true, go_on);
  ASSERT_TRUE(climb) << climb.error().message();
  ASSERT_EQ(climb->points.size(), 7u);
  EXPECT_EQ(climb->points[0].luminaire, "small, GGX 0.3");
  EXPECT_LT(climb->points[0].rel_rmse, 0.01) << "the bound of the lobe's division is 0.5 % of a receiver";
  EXPECT_GT(climb->points[3].rel_rmse, 0.05) << "K = 16";
  EXPECT_LT(climb->points[6].rel_rmse, 0.3 * climb->points[3].rel_rmse);
}

double ours(const std::vector<FigureRow>& rows, const std::string& what, const std::string& quantity) {
  for (const FigureRow& row : rows)
    if (row.what.find(what) != std::string::npos && row.quantity.starts_with(quantity)) return row.ours;
  ADD_FAILURE() << what << ", " << quantity;
  return std::nan("");
}

TEST_F(StudyLooks, ShadowsAreComparedWithTheReferences) {
  const auto pillars = camera_of("pillars");
  const auto rows = shadow_figures(*pillars, *luminaire_, go_on);
  ASSERT_TRUE(rows) << rows.error().message();
  EXPECT_EQ(rows->size(), 2 * visibilities().size());
  for (const char* quantity : {"mean Lab", "relative RMSE"}) {
    EXPECT_LT(ours(*rows, "tile: ", quantity), 0.5 * ours(*rows, "none: ", quantity));
    EXPECT_LT(ours(*rows, "rays", quantity), ours(*rows, "tile: ", quantity));
  }
  const auto stopped = shadow_figures(*pillars, *luminaire_, stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

TEST(FrameRows, AreSharesOfTheWholeFrameAndItsRate) {
  // 100 ms in all.
  const FrameTimes times{.gbuffer_s = 0.001,
                         .receivers_s = 0.002,
                         .shadows_s = 0.010,
                         .hand_over_s = 0.003,
                         .show_s = 0.004,
                         .balance_s = 0.005,
                         .drawn_s = 0.035,
                         .kernel_s = 0.080};
  const auto rows = frame_rows(times, "car2", "size: ");
  ASSERT_EQ(rows.size(), 7u);
  double paper = 0;
  for (std::size_t k = 0; k < 6; ++k) paper += rows[k].paper;
  EXPECT_NEAR(paper, 100, 1e-9) << "the figure's parts are a whole";
  for (const auto& [what, percent] : {std::pair("balance", 5.0),
                                      {"drawing", 30.0},
                                      {"weighing and summing", 45.0},
                                      {"reading", 4.0},
                                      {"shadows", 10.0},
                                      {"handing over", 6.0}})
    EXPECT_NEAR(ours(rows, what, "share"), percent, 1e-9) << what;
  EXPECT_NEAR(ours(rows, "position-dependent, K = 200", "frames/s"), 10, 1e-9);
  for (const FigureRow& row : rows) {
    EXPECT_EQ(row.luminaire, "car2");
    EXPECT_TRUE(row.what.starts_with("size: ")) << row.what;
  }
}

TEST_F(StudyLooks, MixedSamplesStandBesideTheirParts) {
  const auto corner = camera_of("corner");
  const auto rows = mis_figures(*corner, *luminaire_, {}, true, go_on);
  ASSERT_TRUE(rows) << rows.error().message();
  ASSERT_EQ(rows->size(), 4U * (1 + 2 * 3)) << "diffuse once, three lobes as seen and mirroring the lamp";
  for (std::size_t k = 0; k < rows->size(); k += 4) {
    const double parts = std::min((*rows)[k].ours, (*rows)[k + 1].ours), mis = (*rows)[k + 2].ours;
    EXPECT_GT(parts, 0) << (*rows)[k].what;
    EXPECT_NEAR((*rows)[k + 3].ours, mis / parts, 1e-12) << (*rows)[k + 3].what;
  }
  // What mis itself says depends on no time.
  for (const char* what : {"diffuse: mis", "GGX 0.1, the lamp mirrored: mis", "GGX 1: mis"})
    EXPECT_LT(ours(*rows, what, "relative RMSE in equal time"), 15) << what;
  const auto stopped = mis_figures(*corner, *luminaire_, {}, true, stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

TEST_F(StudyLooks, AWholeFrameIsTakenApart) {
  const auto road = camera_of("road");
  const auto rows = frame_figures(*road, *luminaire_, true, go_on);
  ASSERT_TRUE(rows) << rows.error().message();
  EXPECT_EQ(rows->size(), 9u);
  for (const FigureRow& row : *rows) {
    EXPECT_TRUE(row.what.starts_with("256x192, 2 luminaires: ")) << row.what;
    EXPECT_TRUE(std::isfinite(row.ours)) << row.what;
  }
  for (const char* method : {"position-dependent, K = 200", "closed-form, exact", "closed-form, T = 8"})
    EXPECT_GT(ours(*rows, method, "frames/s"), 0);
  EXPECT_EQ(road->shadows().times_made(), 4) << "the lamps have moved, so that maps are among what is timed";
  const auto stopped = frame_figures(*road, *luminaire_, true, stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace lumifield
