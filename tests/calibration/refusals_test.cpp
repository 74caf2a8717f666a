#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "calibration/develop.h"
#include "tests/calibration/synthetic_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

std::string refusal(const Bench& bench, const Plan& plan) {
  const auto developer = Developer::create(bench, plan);
  return developer ? "" : developer.error().message();
}

struct BenchCase {
  std::string name, expected;
  std::function<void(Bench&, Plan&)> spoil;
};

class CreateRefuses : public testing::TestWithParam<BenchCase> {};

TEST_P(CreateRefuses, NamingTheFault) {
  Bench bench = test::synthetic_bench();
  Plan plan = test::synthetic_plan();
  ASSERT_EQ(refusal(bench, plan), "");
  GetParam().spoil(bench, plan);
  EXPECT_THAT(refusal(bench, plan), HasSubstr(GetParam().expected));
}

const double nan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Benches, CreateRefuses,
    testing::ValuesIn(std::vector<BenchCase>{
        {"TooLargeS", "px outside its image", [](Bench&, Plan& p) { p.measurement.width_px = 150; }},
        {"SBehindCamera", "beyond its field of view", [](Bench& b, Plan&) { b.separation_mm = 900; }},
        {"LampMovesSOut", "with the lamp displaced by",
         [](Bench& b, Plan&) {
           b.stage_carries = StageCarries::lamp;
           b.filter.passes.push_back({"negative", {90, 0}, -0.3});
         }},
        {"ResponsivityCount", "1 responsivities for the 3 channel",
         [](Bench& b, Plan&) { b.camera.pixel_format = "BayerRG12"; }},
        {"NegativeResponsivity", "sensor.responsivity", [](Bench& b, Plan&) { b.sensor.responsivity = {-1}; }},
        {"NoGain", "gain must be positive", [](Bench& b, Plan&) { b.sensor.gain_dn_per_e = 0; }},
        {"SaturationBelowBlack", "above the black level", [](Bench& b, Plan&) { b.sensor.saturation_dn = 100; }},
        {"NotARotation", "camera_model.pose", [](Bench& b, Plan&) { b.camera_model.pose(0, 0) *= 1.1; }},
        {"Mirrored", "camera_model.pose", [](Bench& b, Plan&) { b.camera_model.pose.row(0) *= -1; }},
        {"NanDistortion", "coefficients finite", [](Bench& b, Plan&) { b.camera_model.distortion[2] = nan; }},
        {"HugeSensor", "32 Mpx", [](Bench& b, Plan&) { b.camera_model.width_px = 1 << 30; }},
        {"HugeS", "16 Mpx", [](Bench&, Plan& p) { p.measurement.width_px = p.measurement.height_px = 1 << 20; }},
        {"NoS", "positive pixels",
         [](Bench&, Plan& p) {
           p.measurement.pixel_mm = {0, 1};
         }},
        {"BillionCells", "million cells", [](Bench&, Plan& p) { p.columns = p.rows = 40000; }},
        {"NoPass", "filter.passes", [](Bench& b, Plan&) { b.filter.passes.clear(); }},
        {"NoScale", "filter.passes: open", [](Bench& b, Plan&) { b.filter.passes[0].scale = 0; }},
        {"NoSpacing", "filter.spacing_mm",
         [](Bench& b, Plan&) {
           b.filter.spacing_mm = {7.5, 0};
         }},
        {"NoSeparation", "planes.separation_mm", [](Bench& b, Plan&) { b.separation_mm = 0; }},
        {"BlackVignetting", "camera_model.vignetting",
         [](Bench& b, Plan&) {
           b.camera_model.vignetting = {-80, 0, 0};
         }},
    }),
    [](const auto& each) { return each.param.name; });

struct RawCase {
  std::string name, expected;
  std::function<void(RawCell&)> spoil;
};

std::shared_ptr<DarkSet> copy_of_dark(const RawCell& raw) { return std::make_shared<DarkSet>(*raw.dark); }

class DevelopRefuses : public testing::TestWithParam<RawCase> {};

TEST_P(DevelopRefuses, NamingTheFault) {
  const Bench bench = test::synthetic_bench();
  const Plan plan = test::synthetic_plan();
  auto developer = Developer::create(bench, plan);
  ASSERT_TRUE(developer);
  const test::SyntheticCamera camera{bench, {}, nullptr};
  const RawCell good = test::synthetic_cell(camera, plan, {std::vector<double>(320 * 240, 1000.0)});
  RawCell raw = good;
  GetParam().spoil(raw);
  const auto image = developer->develop(raw);
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message(), HasSubstr(GetParam().expected));
  EXPECT_TRUE(developer->develop(good)) << "a refusal must not spoil the next cell";
}

INSTANTIATE_TEST_SUITE_P(
    Cells, DevelopRefuses,
    testing::ValuesIn(std::vector<RawCase>{
        {"OutsideTheGrid", "cell (7, 1): outside the grid", [](RawCell& r) { r.cell.row = 7; }},
        {"MissingPass", "0 passes, the bench has 1", [](RawCell& r) { r.passes.clear(); }},
        {"OtherPass", "pass 0 is \"negative\"", [](RawCell& r) { r.passes[0].name = "negative"; }},
        {"NoExposure", "no exposure", [](RawCell& r) { r.passes[0].bracket.clear(); }},
        {"OtherSize", "a frame of 160×240", [](RawCell& r) { r.passes[0].bracket[2].width_px = 160; }},
        {"TornFrame", "exposure 1", [](RawCell& r) { r.passes[0].bracket[1].dn.pop_back(); }},
        {"OtherPattern", "colour pattern", [](RawCell& r) { r.passes[0].bracket[0].pattern = SensorPattern::rggb; }},
        {"TooFewBits", "can't be seen in 12 bits", [](RawCell& r) { r.passes[0].bracket[0].bits = 12; }},
        {"NoExposureTime", "exposure must be positive", [](RawCell& r) { r.passes[0].bracket[0].exposure_s = 0; }},
        {"NotAscending", "don't ascend", [](RawCell& r) { std::swap(r.passes[0].bracket[0], r.passes[0].bracket[1]); }},
        {"NanGain", "gain finite", [](RawCell& r) { r.passes[0].bracket[0].gain = nan; }},
        {"NanStage", "stage reading", [](RawCell& r) { r.passes[0].stage_mm.x() = nan; }},
        {"DarkExposureMissing", "no dark exposure of 0.032",
         [](RawCell& r) {
           auto dark = copy_of_dark(r);
           dark->bracket.erase(dark->bracket.begin() + 2);
           r.dark = dark;
         }},
        {"DarkOfOtherGain", "no dark exposure",
         [](RawCell& r) {
           auto dark = copy_of_dark(r);
           for (RawImage& frame : dark->bracket) frame.gain = 6;
           r.dark = dark;
         }},
        {"EmptyDark", "cell (1, 1), dark set of block 0: no exposure",
         [](RawCell& r) { r.dark = std::make_shared<DarkSet>(); }},
        {"DarkOfOtherSize", "dark set of block 0",
         [](RawCell& r) {
           auto dark = copy_of_dark(r);
           dark->bracket[0].dn.clear();
           r.dark = dark;
         }},
    }),
    [](const auto& each) { return each.param.name; });

TEST(DevelopRefuses, ALampDisplacedOutOfView) {
  Bench bench = test::synthetic_bench();
  bench.stage_carries = StageCarries::lamp;
  Plan plan = test::synthetic_plan();
  plan.measurement = {70, 50, {1, 1}, {2, -3}};
  auto developer = Developer::create(bench, plan);
  ASSERT_TRUE(developer) << developer.error().message();
  const test::SyntheticCamera camera{bench, {}, nullptr};
  RawCell raw = test::synthetic_cell(camera, plan, {std::vector<double>(320 * 240, 1000.0)});
  EXPECT_TRUE(developer->develop(raw));
  raw.passes[0].stage_mm = {60, 0};
  const auto image = developer->develop(raw);
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message(), HasSubstr("with the lamp displaced by (60.0, 0.0) mm"));
}

}  // namespace
}  // namespace lumifield
