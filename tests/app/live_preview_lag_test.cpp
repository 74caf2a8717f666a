// Pictures that take longer than the time from cell to cell: they lag, but come.
#include <gmock/gmock.h>
#include <thread>

#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

class APreviewThatLags : public LivePreviewTest, public testing::WithParamInterface<Method> {
 protected:
  void SetUp() override {
    LivePreviewTest::SetUp();
    if (IsSkipped()) return;
    // A cell comes later than a moment after the one before, as in a scan, and earlier than a piece of the picture
    // ends.
    live = preview({.coarse = 0, .slice = 1e-3, .moment = 0.002});
    live->set_size(640, 480);
    live->set_method({.method = GetParam(), .samples = 20});
    live->set_scene(scene_);
    live->set_luminaire(geometry_);
    add_all(*live);
  }
  /// Takes the first cell again and again, until it ends.
  std::jthread scan() {
    return std::jthread([this](const std::stop_token& stop) {
      for (unsigned seed = 100; !stop.stop_requested(); ++seed) {
        live->add({0, 0}, image_of(geometry_, seed));
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
  }
  std::unique_ptr<LivePreview> live;
};

INSTANTIATE_TEST_SUITE_P(ByMethod, APreviewThatLags, testing::Values(Method::closed_form, Method::uniform_box),
                         [](const auto& each) {
                           return each.param == Method::closed_form ? "ClosedForm" : "UniformBox";
                         });

TEST_P(APreviewThatLags, ShowsFullPicturesWhileCellsCome) {
  const std::jthread cells = scan();
  ASSERT_NE(told_.full(all_), nullptr);
  const std::size_t from = told_.frames();
  EXPECT_NE(told_.full(all_, from), nullptr) << "and another";
}

TEST_P(APreviewThatLags, EndsWithAllCellsInAFullPicture) {
  {
    const std::jthread cells = scan();
    ASSERT_NE(told_.frame([&](const PreviewFrame& f) { return f.cells == all_; }), nullptr);
  }
  live->add({0, 0}, image_of(geometry_, 7));
  auto renderer = Renderer::create(scene_, 640, 480).value();
  ASSERT_TRUE(renderer->set_method({.method = GetParam(), .samples = 20}));
  ASSERT_TRUE(renderer->set_luminaire(geometry_));
  for (int k = 0; k < all_; ++k)
    ASSERT_TRUE(
        renderer->keep_cell(geometry_.sampling.index(k), image_of(geometry_, k == 0 ? 7 : static_cast<unsigned>(k))));
  const Picture wanted = renderer->picture().value();
  const auto same = [&](const PreviewFrame& f) {
    if (f.coarse) return false;
    for (std::size_t i = 0; i < wanted.rgb.size(); ++i)
      if (std::abs(f.radiance->rgb[i] - wanted.rgb[i]) > 1e-6F) return false;
    return true;
  };
  EXPECT_NE(told_.frame(same), nullptr);
  EXPECT_TRUE(told_.progress([](const PreviewProgress& p) { return !p.working; }));
}

TEST_P(APreviewThatLags, TellsHowFarAPictureIs) {
  EXPECT_TRUE(told_.progress([](const PreviewProgress& p) {
    return p.working && p.asked.method == GetParam() && !p.coarse && p.share > 0 && p.share < 1 && p.left_s > 0;
  }));
  ASSERT_NE(told_.full(all_), nullptr);
  ASSERT_TRUE(told_.progress([](const PreviewProgress& p) { return !p.working; }));
  EXPECT_FALSE(told_.last_progress().refused);
}

TEST_F(LivePreviewTest, AMethodThatIsRefusedIsToldUntilAnotherIsAsked) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  const auto refused = [](const PreviewProgress& p) { return p.refused.has_value(); };
  live->set_method({.method = Method::uniform_box, .samples = 0});
  ASSERT_TRUE(told_.progress(refused));
  // Frames by the method before do not change that.
  const std::size_t from = told_.frames();
  live->set_camera(camera(-200), false);
  ASSERT_NE(told_.full(all_, from), nullptr);
  ASSERT_TRUE(told_.progress([&](const PreviewProgress& p) { return refused(p) && !p.working; }));
  const PreviewProgress last = told_.last_progress();
  ASSERT_TRUE(last.refused);
  EXPECT_THAT(last.refused->message(), HasSubstr("number of samples"));
  EXPECT_EQ(last.asked.method, Method::uniform_box);
  live->set_method({.method = Method::far_field});
  EXPECT_TRUE(
      told_.progress([&](const PreviewProgress& p) { return p.asked.method == Method::far_field && !refused(p); }));
}

/// By one that finds only with its cells that it cannot: the picture before stays.
TEST_F(LivePreviewTest, AMethodThatStopsAtItsCellsIsToldToo) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  live->set_method({.method = Method::position_dependent_printed});
  auto negative = std::make_shared<CellImage>(*image_of(geometry_, 1));
  negative->value.front() = -1;
  live->add({0, 0}, negative);
  ASSERT_TRUE(told_.progress([](const PreviewProgress& p) { return p.refused && !p.working; }));
  EXPECT_EQ(told_.last_progress().asked.method, Method::position_dependent_printed);
}

}  // namespace
}  // namespace lumifield
