// The production devices on the simulated bench's servers: real GRBL and GigE Vision traffic.

#include <cmath>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <span>
#include <thread>
#include <unistd.h>

#include "acquisition/camera.h"
#include "acquisition/stage.h"
#include "acquisition/virtual/gige_camera.h"
#include "acquisition/virtual/grbl_controller.h"
#include "tests/support/own_network.h"

namespace lumifield {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

template <class T>
std::string message(const Result<T>& result) {
  return result ? "no error" : result.error().message();
}

class StageOnVirtualController : public testing::Test {
 protected:
  void SetUp() override {
    virtual_bench::GrblOptions options;
    options.path = std::filesystem::temp_directory_path() / ("lumifield-stage-" + std::to_string(getpid()));
    auto controller = virtual_bench::GrblController::start(options);
    ASSERT_TRUE(controller) << controller.error().message();
    controller_ = std::move(*controller);
    StageSettings settings;
    settings.path = options.path;
    auto stage = open_stage(settings);
    ASSERT_TRUE(stage) << stage.error().message();
    stage_ = std::move(*stage);
    const Status homed = stage_->home();
    ASSERT_TRUE(homed) << homed.error().message();
  }

  double error_mm() const {
    const Result<Vec2> q = stage_->position();
    EXPECT_TRUE(q) << q.error().message();
    return q ? (*q - controller_->true_position_mm()).norm() : INFINITY;
  }

  std::unique_ptr<virtual_bench::GrblController> controller_;
  std::unique_ptr<Stage> stage_;
};

TEST_F(StageOnVirtualController, StandsWhereItWasSent) {
  for (const Vec2& target : {Vec2(7.5, 0), Vec2(15, 7.5), Vec2(105, 7.5), Vec2(15.125, 90)}) {
    const Status moved = stage_->move_to(target);
    ASSERT_TRUE(moved) << moved.error().message();
    EXPECT_LT((controller_->true_position_mm() - target).norm(), 0.004) << "a step of 1/250 mm";
    EXPECT_LT(error_mm(), 0.001);
  }
}

TEST_F(StageOnVirtualController, AStopInMotionKeepsThePosition) {
  std::stop_source stop;
  std::jthread operator_thread([&] {
    while (controller_->true_position_mm().x() < 10) std::this_thread::sleep_for(milliseconds(1));
    stop.request_stop();
  });
  EXPECT_THAT(message(stage_->move_to({190, 0}, stop.get_token())), HasSubstr("stopped by the operator"));
  EXPECT_LT(error_mm(), 0.001);
  EXPECT_LT(controller_->true_position_mm().x(), 189);
  EXPECT_TRUE(stage_->move_to({0, 0}));
}

TEST_F(StageOnVirtualController, ALimitSwitchInMotionAsksForHoming) {
  std::jthread accident([&] {
    while (controller_->true_position_mm().x() < 10) std::this_thread::sleep_for(milliseconds(1));
    controller_->trip_limit();
  });
  EXPECT_THAT(message(stage_->move_to({190, 0})), HasSubstr("a limit switch was hit"));
  const Status homed = stage_->home();
  ASSERT_TRUE(homed) << homed.error().message();
  EXPECT_TRUE(stage_->move_to({20, 20}));
  EXPECT_LT(error_mm(), 0.001);
}

TEST_F(StageOnVirtualController, TargetsBeyondTheTravelAreRefused) {
  EXPECT_THAT(message(stage_->move_to({201, 0})), HasSubstr("soft limits"));
}

/// A stage that looks for its home switches.
class SlipOnVirtualController : public testing::Test {
 protected:
  void start(const virtual_bench::GrblOptions& with) {
    virtual_bench::GrblOptions options = with;
    options.path = std::filesystem::temp_directory_path() / ("lumifield-slip-" + std::to_string(getpid()));
    auto controller = virtual_bench::GrblController::start(options);
    ASSERT_TRUE(controller) << controller.error().message();
    controller_ = std::move(*controller);
    settings_.path = options.path;
    settings_.check_home = true;
  }
  void start_homed() {
    virtual_bench::GrblOptions options;
    options.soft_limits = options.hard_limits = false;
    start(options);
    auto stage = open_stage(settings_);
    ASSERT_TRUE(stage) << stage.error().message();
    stage_ = std::move(*stage);
    const Status homed = stage_->home();
    ASSERT_TRUE(homed) << homed.error().message();
  }
  Vec2 slipped_mm() {
    const Result<Vec2> slip = stage_->slipped_mm();
    EXPECT_TRUE(slip) << slip.error().message();
    return slip ? *slip : Vec2(NAN, NAN);
  }

  StageSettings settings_;
  std::unique_ptr<virtual_bench::GrblController> controller_;
  std::unique_ptr<Stage> stage_;
};

TEST_F(SlipOnVirtualController, NoneIsFoundWhereNoneIs) {
  start_homed();
  EXPECT_LT(slipped_mm().norm(), 1e-9);
  ASSERT_TRUE(stage_->move_to({150, 100}));
  EXPECT_LT(slipped_mm().norm(), 1e-9);
  EXPECT_LT(controller_->true_position_mm().norm(), 0.004) << "it is left where homing ends";
}

TEST_F(SlipOnVirtualController, IsToldByTheHomeSwitchesAndEndsWithHoming) {
  start_homed();
  for (const double lost_mm : {0.03, 0.4, -0.4}) {
    // Steps lost on the way out leave the carriage short of its reading; those lost as it comes back, beyond.
    const bool out = lost_mm > 0;
    controller_->lose_steps(out ? lost_mm : 0);
    ASSERT_TRUE(stage_->move_to({100, 0}));
    controller_->lose_steps(out ? 0 : -lost_mm);
    ASSERT_TRUE(stage_->move_to({90, 0}));
    controller_->lose_steps(0);
    const Vec2 off = controller_->off_mm();
    EXPECT_NEAR(off.x(), -lost_mm, 1e-9);
    EXPECT_LT((slipped_mm() - off).norm(), 0.011) << lost_mm;
    ASSERT_TRUE(stage_->home());
    EXPECT_LT(slipped_mm().norm(), 1e-9);
  }
}

TEST_F(SlipOnVirtualController, FartherThanItLooksIsToldAsThat) {
  start_homed();
  controller_->lose_steps(10);
  ASSERT_TRUE(stage_->move_to({0, 100}));
  controller_->lose_steps(0);
  EXPECT_NEAR(slipped_mm().y(), -1, 0.011) << "the switch is closed where homing ended";
  ASSERT_TRUE(stage_->home());
  ASSERT_TRUE(stage_->move_to({0, 100}));
  controller_->lose_steps(10);
  ASSERT_TRUE(stage_->move_to({0, 50}));
  controller_->lose_steps(0);
  EXPECT_NEAR(slipped_mm().y(), 2, 0.011);
}

TEST_F(SlipOnVirtualController, BacklashIsNoSlip) {
  start_homed();
  controller_->set_backlash(0.15);
  ASSERT_TRUE(stage_->home());
  ASSERT_TRUE(stage_->move_to({50, 50}));
  EXPECT_LT(slipped_mm().norm(), 0.011);
}

TEST_F(SlipOnVirtualController, LimitsThatStandInTheWayAreRefusedOnOpening) {
  virtual_bench::GrblOptions options;
  options.soft_limits = false;
  start(options);
  const auto hard = open_stage(settings_);
  EXPECT_THAT(message(hard),
              testing::AllOf(HasSubstr("hard limits, which make a closed switch an alarm"), HasSubstr("set $21=0")));
  controller_.reset();
  options.soft_limits = true, options.hard_limits = false;
  start(options);
  EXPECT_THAT(message(open_stage(settings_)), HasSubstr("set $20=0"));
  settings_.check_home = false;
  const auto stage = open_stage(settings_);
  ASSERT_TRUE(stage) << stage.error().message();
  ASSERT_TRUE((*stage)->home());
  EXPECT_THAT(message((*stage)->slipped_mm()), HasSubstr("where its home switches close is not known"));
}

class CameraOnVirtualServer : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Formats, CameraOnVirtualServer, testing::Values("Mono12", "Mono16", "BayerRG12"),
                         [](const auto& each) { return std::string(each.param); });

TEST_P(CameraOnVirtualServer, GivesWhatTheSensorSaw) {
  static const bool is_alone = enter_own_network();
  if (!is_alone) GTEST_LOG_(INFO) << "no network namespace: on the machine's own 127.0.0.1";
  virtual_bench::GigeCameraOptions options;
  options.genicam.pixel_format = GetParam();
  const auto dn = [](double exposure_s, double gain_db, std::size_t i) {
    return static_cast<std::uint16_t>((std::lround(exposure_s * 1e6) + std::lround(gain_db * 10) + long(i) * 7) &
                                      0xfff);
  };
  virtual_bench::Sight sight;
  sight.stage_mm = [] { return Vec2(0, 0); };
  sight.wait_ready = [](const Vec2&) {};
  sight.expose = [&](const virtual_bench::Exposure& exposure, std::span<std::uint16_t> out) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = dn(exposure.exposure_s, exposure.gain_db, i);
  };
  const auto server = virtual_bench::GigeCamera::start(options, sight);
  ASSERT_TRUE(server) << server.error().message();

  CameraSettings settings;
  settings.address = options.address;
  settings.pixel_format = GetParam();
  settings.gain = 1.5;
  const auto camera = open_camera(settings);
  ASSERT_TRUE(camera) << camera.error().message();
  for (const double exposure_s : {0.002, 0.008, 0.032, 0.0021, 0.002}) {
    const Result<RawImage> image = (*camera)->expose(exposure_s);
    ASSERT_TRUE(image) << image.error().message();
    ASSERT_EQ(image->dn.size(), std::size_t(options.genicam.width_px) * options.genicam.height_px);
    EXPECT_DOUBLE_EQ(image->exposure_s, exposure_s);
    EXPECT_EQ(image->gain, 1.5);
    EXPECT_EQ(image->bits, std::string(GetParam()) == "Mono16" ? 16 : 12);
    EXPECT_EQ(image->pattern, std::string(GetParam()) == "BayerRG12" ? SensorPattern::rggb : SensorPattern::mono);
    long wrong = 0;
    for (std::size_t i = 0; i < image->dn.size(); ++i) wrong += image->dn[i] != dn(exposure_s, 1.5, i);
    EXPECT_EQ(wrong, 0);
  }
}

}  // namespace
}  // namespace lumifield
