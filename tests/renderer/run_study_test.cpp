#include "renderer/study/run_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/study_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class RunStudy : public StudyOfASmallLuminaire {
 protected:
  void SetUp() override {
    StudyOfASmallLuminaire::SetUp();
    if (IsSkipped()) return;
    job_.scene = camera_->scene();
    job_.luminaires = {*luminaire_};
    job_.quick = true;
    job_.cache = folder_;
  }
  /// One that lights nothing.
  StudyLuminaire dark() const {
    StudyLuminaire dark{"dark", LightField(luminaire_->light_field.geometry())};
    for (int k = 0; k < 6; ++k) {
      CellImage image = *luminaire_->light_field.cell({k / 3, k % 3});
      for (float& value : image.value) value = 0;
      EXPECT_TRUE(dark.light_field.add({k / 3, k % 3}, std::move(image)));
    }
    return dark;
  }

  StudyJob job_;
};

TEST_F(RunStudy, ReadsTheEnvironmentBeforeAnythingElse) {
  job_.scene.environment = folder_ / "none.exr";
  job_.scene.mesh = folder_ / "none.obj";
  const auto study = run_study(job_, [](double, const std::string& what) {
    ADD_FAILURE() << what;
    return false;
  });
  ASSERT_FALSE(study);
  EXPECT_THAT(study.error().where, HasSubstr("none.exr"));
}

TEST_F(RunStudy, ALuminaireThatFailsIsLeftOut) {
  job_.ladders_only = true;
  job_.luminaires.insert(job_.luminaires.begin(), dark());
  const auto study = run_study(job_, [](double, const std::string&) { return true; });
  ASSERT_TRUE(study) << study.error().message();
  ASSERT_EQ(study->omissions.size(), 1U);
  EXPECT_EQ(study->omissions[0].part, "dark");
  EXPECT_THAT(study->omissions[0].reason, HasSubstr("lights nothing that is seen"));
  ASSERT_FALSE(study->points.empty());
  for (const StudyPoint& point : study->points) EXPECT_EQ(point.luminaire, "small");
}

TEST_F(RunStudy, GoesOnAfterFiguresThatFail) {
  job_.luminaires.clear();
  const WithoutTemporaryFolder no_hall;
  bool went_on = false;
  const auto stopped = run_study(job_, [&](double, const std::string& what) {
    went_on = what.starts_with("stability");
    return !went_on;
  });
  EXPECT_TRUE(went_on);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped) << stopped.error().message();
}

TEST_F(RunStudy, WithoutAnyLadderIsAnErrorAndAStopIsOne) {
  job_.luminaires = {dark()};
  const auto none = run_study(job_, [](double, const std::string&) { return true; });
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().what, HasSubstr("lights nothing that is seen"));

  job_.luminaires = {*luminaire_};
  const auto stopped = run_study(job_, [](double, const std::string&) { return false; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace lumifield
