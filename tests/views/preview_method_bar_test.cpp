#include "app/views/preview_method_bar.h"

#include <QCheckBox>
#include <QComboBox>
#include <QSignalSpy>
#include <QSpinBox>
#include <QTest>
#include <QToolButton>
#include <gtest/gtest.h>

#include "app/views/preview_text.h"
#include "tests/views/preview_frames.h"

namespace lumifield {
namespace {

class PreviewMethodBarTest : public testing::Test {
 protected:
  PreviewMethodBarTest() {
    bar.show();
    EXPECT_TRUE(QTest::qWaitForWindowExposed(&bar));
    QObject::connect(&bar, &PreviewMethodBar::methodChanged, &bar,
                     [this](const MethodSettings& method) { told.push_back(method); });
  }
  QComboBox* methods() { return bar.findChild<QComboBox*>(); }
  QSpinBox* samples() { return bar.findChild<QSpinBox*>(); }

  PreviewMethodBar bar;
  std::vector<MethodSettings> told;
};

TEST_F(PreviewMethodBarTest, OffersWhatMakesAPictureSoonEnough) {
  QStringList names;
  for (int k = 0; k < methods()->count(); ++k) {
    names << methods()->itemText(k);
    EXPECT_FALSE(methods()->itemData(k, Qt::ToolTipRole).toString().isEmpty());
  }
  EXPECT_EQ(names.front(), "closed-form");
  EXPECT_TRUE(names.contains("position-dependent"));
  EXPECT_FALSE(names.contains("reference"));
  EXPECT_FALSE(samples()->isVisible()) << "the closed form draws none";
}

TEST_F(PreviewMethodBarTest, KeysChooseAMethodAndItsSamples) {
  methods()->setFocus();
  QTest::keyClick(methods(), Qt::Key_Down);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told.back().method, Method::position_dependent);
  EXPECT_EQ(told.back().samples, 200);
  ASSERT_TRUE(samples()->isVisible());
  EXPECT_FALSE(samples()->toolTip().isEmpty());

  samples()->setFocus();
  samples()->selectAll();
  QTest::keyClicks(samples(), "50");
  EXPECT_EQ(told.size(), 1u) << "not while it is typed";
  QTest::keyClick(samples(), Qt::Key_Return);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told.back().samples, 50);

  QTest::keyClick(methods(), Qt::Key_Home);
  ASSERT_EQ(told.size(), 3u);
  EXPECT_EQ(told.back().method, Method::closed_form);
  EXPECT_FALSE(samples()->isVisible());
}

TEST_F(PreviewMethodBarTest, AsksForAnEnvironmentWhereThereIsOne) {
  auto* environment = bar.findChild<QCheckBox*>();
  ASSERT_NE(environment, nullptr);
  EXPECT_FALSE(environment->isVisible());
  EXPECT_TRUE(bar.environment()) << "a scene that names one has it";
  bar.offer_environment(true);
  EXPECT_TRUE(environment->isVisible());
  QSignalSpy switched(&bar, &PreviewMethodBar::environmentSwitched);
  QTest::keyClick(environment, Qt::Key_Space);
  ASSERT_EQ(switched.size(), 1);
  EXPECT_FALSE(switched[0][0].toBool());
  EXPECT_FALSE(bar.environment());
}

TEST_F(PreviewMethodBarTest, LightsInAllAreOtherNumbersThanSamplesForEachPixel) {
  methods()->setCurrentText("position-dependent");
  samples()->setValue(50);
  methods()->setCurrentText("uniform-box");
  EXPECT_EQ(told.back().samples, 50) << "counted alike";
  methods()->setCurrentText("precomputed-lights");
  EXPECT_EQ(told.back().samples, info(Method::precomputed_lights).samples);
  EXPECT_EQ(samples()->value(), 10000);
  methods()->setCurrentText("far-field");
  methods()->setCurrentText("precomputed-lights");
  EXPECT_EQ(samples()->value(), 10000);
  methods()->setCurrentText("uniform-box");
  EXPECT_EQ(told.back().samples, 200);
}

TEST_F(PreviewMethodBarTest, ShadowsAreChosenAndPublishedOnesRefreshed) {
  auto* shadows = bar.findChildren<QComboBox*>().back();
  auto* refresh = bar.findChild<QToolButton*>();
  ASSERT_EQ(shadows->accessibleName(), "What casts shadows");
  EXPECT_EQ(bar.visibility(), Visibility::tile);
  EXPECT_TRUE(refresh->isHidden());
  std::vector<Visibility> chosen;
  int refreshed = 0;
  QObject::connect(&bar, &PreviewMethodBar::visibilityChanged, [&](Visibility v) { chosen.push_back(v); });
  QObject::connect(&bar, &PreviewMethodBar::shadowsToBeRefreshed, [&] { ++refreshed; });
  shadows->setCurrentText("published");
  EXPECT_FALSE(refresh->isHidden());
  refresh->click();
  EXPECT_EQ(refreshed, 1);
  shadows->setCurrentText("none");
  EXPECT_TRUE(refresh->isHidden());
  EXPECT_EQ(chosen, (std::vector{Visibility::published, Visibility::none}));
}

TEST_F(PreviewMethodBarTest, ThePicturesTextNamesAnotherMethod) {
  PreviewFrame frame = preview_frame(4, 3);
  EXPECT_FALSE(progress_text(frame).contains("closed-form"));
  frame.method = {.method = Method::position_dependent, .samples = 200};
  EXPECT_TRUE(progress_text(frame).contains("position-dependent, 200"));
  frame.method = {.method = Method::far_field};
  EXPECT_TRUE(progress_text(frame).contains("far-field · shadows: tile"));
}

}  // namespace
}  // namespace lumifield
