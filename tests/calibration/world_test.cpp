#include "acquisition/virtual/world.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "acquisition/virtual/lamps.h"
#include "calibration/develop.h"

namespace lumifield {
namespace {

using virtual_bench::World;
using virtual_bench::WorldOptions;

Plan small_plan() {
  Plan plan;
  plan.columns = 9, plan.rows = 7;
  plan.measurement = {150, 150, {2, 2}, {0, 0}};
  plan.exposures_s = {0.002, 0.008, 0.032, 0.128};
  return plan;
}

Bracket photograph(World& world, const Vec2& stage_mm, const Plan& plan) {
  const CameraModel& camera = world.bench().camera_model;
  Bracket bracket;
  for (const double t : plan.exposures_s) {
    RawImage image;
    image.width_px = camera.width_px, image.height_px = camera.height_px;
    image.bits = world.bench().camera.pixel_format == "Mono16" ? 16 : 12;
    image.pattern = world.bench().camera.pixel_format == "BayerRG12" ? SensorPattern::rggb : SensorPattern::mono;
    image.exposure_s = t;
    image.stage_mm = stage_mm;
    image.dn.resize(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px));
    world.expose(stage_mm, t, 0, image.width_px, image.height_px, 0, 0, image.dn);
    bracket.push_back(std::move(image));
  }
  return bracket;
}

/// The cell as a scan takes it: every pass at its stage reading, then the opaque patch.
RawCell scan_cell(World& world, CellIndex cell, const Plan& plan) {
  const Bench& bench = world.bench();
  const Vec2 u = luminaire_geometry(bench, plan).sampling.cell_center_mm(cell);
  const double sign = bench.stage_carries == StageCarries::slide ? 1 : -1;
  const Vec2 q = bench.stage_to_luminaire.linear.inverse() * (sign * u - bench.stage_to_luminaire.origin_mm);
  RawCell raw;
  raw.cell = cell;
  for (const FilterPass& pass : bench.filter.passes)
    raw.passes.push_back({pass.name, photograph(world, q + pass.offset_mm, plan), q + pass.offset_mm});
  raw.dark = std::make_shared<DarkSet>(DarkSet{photograph(world, q + bench.filter.dark_offset_mm, plan), 0});
  return raw;
}

/// C_m(s) = ∫ Φ′_m L cos⁴θ/δ² du by the midpoint rule.
Eigen::Array3d direct(const WorldOptions& options, const Vec2& u_m, const Vec2& s, double separation_mm) {
  const virtual_bench::Lamp lamp = *virtual_bench::make_lamp(options.lamp);
  const Dual dual(options.basis, options.window);
  constexpr int n = 96;
  const double w = options.window;
  Eigen::Array3d sum(0, 0, 0);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec2 x((i + 0.5) * w / n - w / 2, (j + 0.5) * w / n - w / 2);
      const Vec2 u = u_m + x.cwiseProduct(options.spacing_mm), slope = (s - u) / separation_mm;
      const double cos2 = 1 / (1 + slope.squaredNorm());
      sum += dual(x.x()) * dual(x.y()) * cos2 * cos2 * lamp.radiance(u, slope);
    }
  }
  // du = a_x a_y dx, and Φ′ is per a_x a_y
  return sum * (w * w / (n * n)) / (separation_mm * separation_mm);
}

struct WorldCase {
  std::string name, lamp, pixel_format;
  StageCarries carries;
};

class DevelopedWorld : public testing::TestWithParam<WorldCase> {};
INSTANTIATE_TEST_SUITE_P(Benches, DevelopedWorld,
                         testing::ValuesIn(std::vector<WorldCase>{
                             {"BikeSlide", "bike", "Mono16", StageCarries::slide},
                             {"BikeLamp", "bike", "Mono12", StageCarries::lamp},
                             {"LedArrayBayer", "led-array", "BayerRG12", StageCarries::slide},
                         }),
                         [](const auto& each) { return each.param.name; });

TEST_P(DevelopedWorld, IsTheDualsIntegralOfTheLamp) {
  WorldOptions options;
  options.lamp = GetParam().lamp;
  options.pixel_format = GetParam().pixel_format;
  options.carries = GetParam().carries;
  options.noise = false;
  auto world = World::create(options);
  ASSERT_TRUE(world);
  const Bench& bench = (*world)->bench();
  const Plan plan = small_plan();
  auto developer = Developer::create(bench, plan);
  ASSERT_TRUE(developer) << developer.error().message();

  const CellIndex cell{2, 5};
  const auto image = developer->develop(scan_cell(**world, cell, plan));
  ASSERT_TRUE(image) << image.error().message();
  EXPECT_EQ(image->quality.saturated_share, 0);
  const Vec2 u_m = developer->geometry().sampling.cell_center_mm(cell);
  double worst = 0, largest = 0;
  for (int j = 4; j < 150; j += 24) {
    for (int i = 4; i < 150; i += 24) {
      const Eigen::Array3d rgb = direct(options, u_m, plan.measurement.pixel_center_mm(i, j), bench.separation_mm);
      for (int c = 0; c < image->channels; ++c) {
        const double truth = image->channels == 1 ? (rgb * virtual_bench::mono_weights).sum() : rgb[c];
        worst = std::max(worst, std::abs(static_cast<double>(image->at(c, i, j)) - truth));
        largest = std::max(largest, std::abs(truth));
      }
    }
  }
  RecordProperty("worst_over_largest", std::to_string(worst / largest));
  RecordProperty("median_snr", std::to_string(image->quality.median_snr));
  EXPECT_LT(worst / largest, 0.005);
}

}  // namespace
}  // namespace lumifield
