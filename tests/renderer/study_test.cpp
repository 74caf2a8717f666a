#include <cmath>
#include <gtest/gtest.h>
#include <iomanip>
#include <set>

#include "luminaire/file_io.h"
#include "renderer/methods/closed_form.h"
#include "renderer/study/lab.h"
#include "renderer/study/ladder.h"
#include "renderer/study/paper_figures.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/synthetic_luminaire.h"
#include "tests/support/study_fixture.h"

namespace lumifield {
namespace {

TEST(Lab, KnownColours) {
  // White, black, and sRGB's red and blue, CIE 1976 with D65.
  const auto near = [](std::array<double, 3> got, double l, double a, double b) {
    EXPECT_NEAR(got[0], l, 0.02);
    EXPECT_NEAR(got[1], a, 0.05);
    EXPECT_NEAR(got[2], b, 0.05);
  };
  near(lab_of_srgb(255, 255, 255), 100, 0, 0);
  near(lab_of_srgb(0, 0, 0), 0, 0, 0);
  near(lab_of_srgb(255, 0, 0), 53.24, 80.09, 67.20);
  near(lab_of_srgb(0, 0, 255), 32.30, 79.19, -107.86);
}

TEST(Lab, TheMeanIsOverPixels) {
  const Picture8 black{2, 1, {0, 0, 0, 0, 0, 0}}, half{2, 1, {0, 0, 0, 255, 255, 255}};
  EXPECT_EQ(mean_lab_delta_e(half, half), 0);
  EXPECT_NEAR(mean_lab_delta_e(black, half), 50, 0.01);
}

TEST(SyntheticLuminaire, HasThePapersSizesAndIsSeeded) {
  const auto all = table_1_luminaires();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].columns * all[0].rows, 63);
  EXPECT_EQ(2 * all[0].spacing_mm, 15);
  EXPECT_EQ(3 * all[1].spacing_mm, 49.5);
  EXPECT_EQ(all[2].columns * all[2].rows, 99);
  const LightField a = make_luminaire(all[1]), b = make_luminaire(all[1]);
  EXPECT_EQ(a.cell({2, 2})->value, b.cell({2, 2})->value);
  EXPECT_NE(a.cell({2, 2})->value, a.cell({2, 3})->value);
  for (const float v : a.cell({2, 2})->value) ASSERT_GT(v, 0);
}

TEST_F(CacheFolder, AReferenceIsComputedOnceAndFollowsItsContent) {
  const SyntheticLuminaire small{.name = "small", .columns = 2, .rows = 2, .pixels = 20, .pixel_mm = 4};
  LightField field = make_luminaire(small);
  const std::vector<Receiver> at{{{10, -5, 400}, {0, 0, -1}}, {{0, 0, 0}, {0, 0, 0}}};
  const auto first = cached_reference(field, at, {}, folder_).value();
  EXPECT_EQ(first[0], ClosedForm(field).irradiance(at[0])[0]);
  EXPECT_EQ(first[1], 0) << "no receiver";
  ASSERT_EQ(files().size(), 1u);

  // What is kept is taken: another value in the file shows.
  const double mark[] = {42, 0};
  ASSERT_TRUE(write_file_durably(files()[0], {reinterpret_cast<const char*>(mark), sizeof mark}));
  EXPECT_EQ(cached_reference(field, at, {}, folder_).value()[0], 42);
  // What is not whole, or not finite, is not.
  ASSERT_TRUE(write_file_durably(files()[0], "short"));
  EXPECT_EQ(cached_reference(field, at, {}, folder_).value(), first);

  // Another value in a cell, another receiver: other files.
  CellImage image = *field.cell({0, 1});
  image.value[150] += 0.25F;
  ASSERT_TRUE(field.add({0, 1}, std::move(image)));
  (void)cached_reference(field, at, {}, folder_).value();
  (void)cached_reference(field, {at[0]}, {}, folder_);
  EXPECT_EQ(files().size(), 3u);
  EXPECT_NE(reference_key(field, at), reference_key(field, at, {}, reference_version + 1));
  // No folder is no failure.
  EXPECT_EQ(cached_reference(make_luminaire(small), at, {}, {}).value(), first);
}

TEST(ReferenceVersion, IsThatOfTheseValues) {
  const Receiver at[] = {{{10, -5, 400}, {0, 0, -1}}, {{40, 20, 180}, {0.6, 0, -0.8}}, {{-60, 10, 300}, {1, 0, 0}}};
  const double irradiance[] = {2.2692908219726853, 1.1560245215020677, 2.152274416387137};
  const ClosedForm reference(make_luminaire({.name = "small", .columns = 2, .rows = 2, .pixels = 20, .pixel_mm = 4}));
  for (std::size_t k = 0; k < std::size(at); ++k) {
    const double now = reference.irradiance(at[k])[0];
    EXPECT_NEAR(now / irradiance[k], 1, 1e-9)
        << "receiver " << k << " gets " << std::setprecision(17) << now
        << ": where that is meant, raise reference_version and write it here, so that none takes what was kept before";
  }
}

TEST_F(StudyOfASmallLuminaire, ReceiversAreStratifiedAndLit) {
  const StudyFrame frame = camera_->frame(256, 192, luminaire_->light_field).value();
  const auto chosen = stratified_receivers(frame, 7);
  EXPECT_GT(chosen.size(), 900u);
  EXPECT_LE(chosen.size(), 1024u);
  for (const std::size_t k : chosen) {
    EXPECT_GT(frame.receivers[k].p_mm.z(), 150);
    EXPECT_NEAR(frame.receivers[k].n.norm(), 1, 1e-6);
  }
  EXPECT_EQ(chosen, stratified_receivers(frame, 7));
  EXPECT_NE(chosen, stratified_receivers(frame, 8));
}

TEST_F(StudyOfASmallLuminaire, TheLadderJudgesEveryMethod) {
  const auto bench = StudyBench::create(*camera_, *luminaire_, folder_);
  ASSERT_TRUE(bench) << bench.error().message();
  EXPECT_EQ(files().size(), 1u) << "the reference is kept where it was told";
  int told = 0;
  const auto climb = climb_ladder(**bench, true, [&](double share, const std::string&) {
    EXPECT_GE(share, 0);
    EXPECT_LT(share, 1);
    return ++told > 0;
  });
  ASSERT_TRUE(climb) << climb.error().message();
  EXPECT_EQ(told, int(climb->points.size()));
  EXPECT_TRUE(climb->without.empty());
  const auto at = [&](Method method, double cost) {
    for (const StudyPoint& p : climb->points)
      if (p.method == method && p.cost == cost) return p;
    ADD_FAILURE() << to_string(method) << ' ' << cost;
    return StudyPoint{};
  };
  for (const StudyPoint& p : climb->points) {
    EXPECT_GT(p.time_ms, 0);
    EXPECT_FALSE(p.device.empty());
    EXPECT_TRUE(std::isfinite(p.rel_rmse) && std::isfinite(p.lab_delta_e));
  }
  // The kernel without a level of detail is the reference but for rounding; samplers are not, and get nearer.
  EXPECT_LT(at(Method::closed_form, 0).rel_rmse, 1e-5);
  EXPECT_EQ(at(Method::closed_form, 0).lab_delta_e, 0);
  EXPECT_LT(at(Method::closed_form, 8).rel_rmse, at(Method::closed_form, 2).rel_rmse);
  EXPECT_GT(at(Method::position_dependent, 16).rel_rmse, 1e-3);
  EXPECT_LT(at(Method::position_dependent, 1000).rel_rmse, 0.3 * at(Method::position_dependent, 16).rel_rmse);
  EXPECT_LT(at(Method::position_dependent, 1000).lab_delta_e, at(Method::position_dependent, 16).lab_delta_e);
  EXPECT_GT(at(Method::far_field, 0).rel_rmse, 1e-3);

  const auto stopped = climb_ladder(**bench, true, [](double, const std::string&) { return false; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

TEST_F(StudyOfASmallLuminaire, AMethodThatRefusesTheLuminaireIsToldAndTheOthersGoOn) {
  // As of any scan, whose noise is below 0 somewhere.
  CellImage image = *luminaire_->light_field.cell({0, 1});
  image.value[150] = -1e-4F;
  ASSERT_TRUE(luminaire_->light_field.add({0, 1}, std::move(image)));
  const auto bench = StudyBench::create(*camera_, *luminaire_, folder_);
  ASSERT_TRUE(bench) << bench.error().message();
  const auto climb = climb_ladder(**bench, true, [](double, const std::string&) { return true; });
  ASSERT_TRUE(climb) << climb.error().message();
  ASSERT_EQ(climb->without.size(), 1u);
  const StabilityRow& row = climb->without[0];
  EXPECT_EQ(row.method, Method::position_dependent_printed);
  EXPECT_EQ(row.case_name, "luminaire small");
  EXPECT_EQ(row.outcome, StabilityOutcome::refused);
  EXPECT_NE(row.reason.find("cell (0, 1)"), std::string::npos) << row.reason;
  std::set<Method> judged;
  for (const StudyPoint& p : climb->points) judged.insert(p.method);
  EXPECT_EQ(judged.size(), methods().size() - 2) << "the printed one has none, nor has the reference";
  const auto go_on = [](double, const std::string&) { return true; };
  Climb confirmed = *climb;
  ASSERT_TRUE(confirm_at_full_size(**bench, *camera_, true, go_on, confirmed));
  EXPECT_EQ(confirmed.points.size(), climb->points.size() + judged.size());
  EXPECT_EQ(confirmed.without.size(), 1u);
  EXPECT_TRUE(paper_figures(**bench, true, go_on)->empty()) << "the paper has none of this luminaire";
}

}  // namespace
}  // namespace lumifield
