#include <future>
#include <gmock/gmock.h>
#include <thread>

#include "app/session/preview_worker.h"
#include "tests/app/live_preview_fixture.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

TEST_F(LivePreviewTest, AMethodThatIsChosenMakesThePicture) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);

  const MethodSettings settings{.method = Method::position_dependent, .samples = 40, .seed = 3};
  std::size_t from = told_.frames();
  live->set_method(settings);
  const auto by = [&](Method method) {
    return [method, this](const PreviewFrame& f) { return f.method.method == method && !f.coarse && f.cells == all_; };
  };
  const FramePtr sampled = told_.frame(by(Method::position_dependent), from);
  ASSERT_NE(sampled, nullptr);

  // As a renderer makes it at one go.
  auto renderer = Renderer::create(scene_, width, height).value();
  ASSERT_TRUE(renderer->set_method(settings));
  ASSERT_TRUE(renderer->set_luminaire(geometry_));
  for (int k = 0; k < all_; ++k)
    ASSERT_TRUE(renderer->keep_cell(geometry_.sampling.index(k), image_of(geometry_, static_cast<unsigned>(k))));
  expect_same(renderer->picture().value(), *sampled->radiance);

  // It stays with another scene, and goes back.
  from = told_.frames();
  live->set_scene(scene_);
  ASSERT_NE(told_.frame(by(Method::position_dependent), from), nullptr);
  from = told_.frames();
  live->set_method({});
  const FramePtr exact = told_.frame(by(Method::closed_form), from);
  ASSERT_NE(exact, nullptr);
  expect_same(expected(scene_.camera, all_), *exact->radiance);
  EXPECT_TRUE(told_.errors().empty());
}

TEST_F(LivePreviewTest, AMethodThatIsRefusedLeavesTheOneBefore) {
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  ASSERT_NE(told_.full(all_), nullptr);
  live->set_method({.method = Method::uniform_box, .samples = 0});
  ASSERT_TRUE(told_.failed(1));
  EXPECT_THAT(told_.errors()[0], HasSubstr("number of samples"));
  const std::size_t from = told_.frames();
  live->set_camera(camera(-200), false);
  const FramePtr frame = told_.full(all_, from);
  ASSERT_NE(frame, nullptr);
  EXPECT_EQ(frame->method.method, Method::closed_form);
}

TEST_F(LivePreviewTest, AnEnvironmentIsSwitchedWithoutSummingAnew) {
  Picture sky{64, 32, std::vector<float>(3 * 64 * 32, 2.0F), std::vector<float>(64 * 32, 1.0F), {}};
  ASSERT_TRUE(write_exr(sky, folder_ / "sky.exr"));
  const Scene dark = std::exchange(scene_, [&] {
    Scene lit = scene_;
    lit.environment = folder_ / "sky.exr";
    return lit;
  }());
  auto live = preview();
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  const FramePtr lit = told_.full(all_);
  ASSERT_NE(lit, nullptr);
  EXPECT_TRUE(lit->environment);
  EXPECT_TRUE(told_.info().has_environment);
  expect_same(expected(scene_.camera, all_), *lit->radiance);

  std::size_t from = told_.frames();
  live->set_environment(false);
  const FramePtr off = told_.full(all_, from);
  ASSERT_NE(off, nullptr);
  EXPECT_FALSE(off->environment);
  EXPECT_EQ(off->sum_s, 0);
  // It stays off in the next scene, and one that has none has none to switch on.
  from = told_.frames();
  live->set_scene(dark);
  live->set_environment(true);
  const FramePtr without = told_.frame([&](const PreviewFrame& f) { return !f.coarse && f.cells == all_; }, from);
  ASSERT_NE(without, nullptr);
  EXPECT_FALSE(without->environment);
  expect_same(*without->radiance, *off->radiance);
  EXPECT_TRUE(told_.errors().empty());
}

TEST_F(LivePreviewTest, ASceneThatIsTakenAtTheEndIsLetGoOf) {
  Picture sky{64, 32, std::vector<float>(3 * 64 * 32, 2.0F), std::vector<float>(64 * 32, 1.0F), {}};
  ASSERT_TRUE(write_exr(sky, folder_ / "sky.exr"));
  scene_.environment = folder_ / "sky.exr";
  int ready = 0;
  std::stop_source end;
  PreviewWorker worker(
      {nullptr, [&](const RendererInfo&) { ++ready; }, [](const Error& error) { ADD_FAILURE() << error.message(); }},
      {}, end.get_token());
  const auto take_scene = [&] {
    PreviewCommands commands;
    commands.scene = scene_;
    worker.take(std::move(commands));
  };
  take_scene();
  EXPECT_EQ(ready, 1);
  end.request_stop();
  take_scene();
  EXPECT_EQ(ready, 1) << "no map was made of it";
}

/// Minutes of a coarse picture of a camera that moves, in bands of receivers of a second or so.
class ADearPictureOfACameraThatMoves : public LivePreviewTest {
 protected:
  void SetUp() override {
    LivePreviewTest::SetUp();
    if (IsSkipped()) return;
    live = hasty();
    live->set_size(4096, 3072);
    live->set_scene(scene_);
    live->set_luminaire(geometry_);
    add_all(*live);
    live->set_camera(camera(200), true);
    ASSERT_NE(told_.frame([&](const PreviewFrame& f) { return f.camera.position_mm.x() == 200; }), nullptr);
    from = told_.frames();
    live->set_method(dear);
    // Long enough for it to be begun; where it is not, there is less to interrupt.
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  const MethodSettings dear{.method = Method::uniform_box, .samples = 1e6};
  std::unique_ptr<LivePreview> live;
  std::size_t from = 0;
};

TEST_F(ADearPictureOfACameraThatMoves, EndsWithAnotherMethod) {
  live->set_method({});
  const FramePtr next = told_.frame([](const PreviewFrame&) { return true; }, from);
  ASSERT_NE(next, nullptr);
  EXPECT_EQ(next->method.method, Method::closed_form);
}

TEST_F(ADearPictureOfACameraThatMoves, EndsWithAnotherScene) {
  live->set_scene(scene_);
  EXPECT_TRUE(told_.ready(2));
  EXPECT_EQ(told_.frames(), from);
}

TEST_F(ADearPictureOfACameraThatMoves, EndsWithThePreview) {
  std::future<void> ended = std::async(std::launch::async, [this] { live.reset(); });
  EXPECT_EQ(ended.wait_for(patience), std::future_status::ready);
  EXPECT_EQ(told_.frames(), from);
}

TEST_F(LivePreviewTest, ViewsAndCellsThatComeFasterThanAPictureDoNotKeepItFromComing) {
  auto live = preview({.coarse = 0, .slice = 1e-4});
  live->set_size(2048, 1536);
  const MethodSettings settings{.method = Method::uniform_box, .samples = 1000};
  live->set_method(settings);
  live->set_scene(scene_);
  live->set_luminaire(geometry_);
  add_all(*live);
  const auto views = [&] {
    std::set<double> seen;
    for (const FramePtr& frame : told_.all()) seen.insert(frame->camera.position_mm.x());
    return seen.size();
  };
  const auto end = std::chrono::steady_clock::now() + patience;
  unsigned moves = 0;
  while (views() < 5 && std::chrono::steady_clock::now() < end) {
    live->set_camera(camera(++moves % 900), true);
    live->add({0, 0}, image_of(geometry_, moves % 10));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GE(views(), 5U) << moves << " moves";
  // The last cell and the last view are in the picture in the end.
  live->set_size(width, height);
  live->add({0, 0}, image_of(geometry_, 77));
  live->set_camera(camera(-200), false);
  auto renderer = Renderer::create(scene_, width, height).value();
  ASSERT_TRUE(renderer->set_method(settings));
  ASSERT_TRUE(renderer->set_luminaire(geometry_));
  ASSERT_TRUE(renderer->set_view(camera(-200), width, height));
  for (int k = 0; k < all_; ++k)
    ASSERT_TRUE(
        renderer->keep_cell(geometry_.sampling.index(k), image_of(geometry_, k == 0 ? 77 : static_cast<unsigned>(k))));
  const Picture wanted = renderer->picture().value();
  const FramePtr last = told_.frame([&](const PreviewFrame& f) {
    return !f.coarse && f.camera.position_mm.x() == -200 && f.radiance->rgb == wanted.rgb;
  });
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->cells, all_);
}

}  // namespace
}  // namespace lumifield
