#include "acquisition/virtual/world.h"

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <thread>

#include "acquisition/virtual/photosites.h"
#include "acquisition/virtual/screen.h"

namespace lumifield::virtual_bench {
namespace {

const std::vector<Eigen::Array3d> rgb_bands{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

Vec2 stage_for(const Bench& bench, const Vec2& u, const FilterPass& pass) {
  const StageToLuminaire& map = bench.stage_to_luminaire;
  const double sign = bench.stage_carries == StageCarries::slide ? 1 : -1;
  return map.linear.inverse() * (sign * u - map.origin_mm) + pass.offset_mm;
}

/// ∬ weight(u) L cos²θ/R² du at s on S by the midpoint rule over the lamp's exit: knows nothing of separability.
Eigen::Array3d brute_force(const Lamp& lamp, const Vec2& s, const std::function<double(Vec2)>& weight) {
  const int nx = 360, ny = 220;
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec2 u((i + 0.5) / nx * 36 - 18, (j + 0.5) / ny * 22 - 11);
      const double w = weight(u);
      if (w == 0) continue;
      const Vec3 ray(s.x() - u.x(), s.y() - u.y(), plane_separation_mm);
      const double cosine = plane_separation_mm / ray.norm();
      sum += w * lamp.radiance(u, (s - u) / plane_separation_mm) * (cosine * cosine / ray.squaredNorm());
    }
  return sum * (36.0 / nx) * (22.0 / ny);
}

WorldOptions options_of(const std::string& lamp, StageCarries carries = StageCarries::slide) {
  WorldOptions options;
  options.lamp = lamp;
  options.carries = carries;
  return options;
}

class EveryLamp : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Lamps, EveryLamp, testing::Values("bike", "headlight", "led-array"), [](const auto& tested) {
  std::string name = tested.param;
  std::erase(name, '-');
  return name;
});

TEST_P(EveryLamp, ShinesThroughItsExitOnly) {
  const Lamp lamp = *make_lamp(GetParam());
  for (const LampTerm& term : lamp.terms) {
    EXPECT_GE(term.x.low_mm(), -lamp.size_mm.x() / 2);
    EXPECT_LE(term.x.high_mm(), lamp.size_mm.x() / 2);
    EXPECT_GE(term.y.low_mm(), -lamp.size_mm.y() / 2);
    EXPECT_LE(term.y.high_mm(), lamp.size_mm.y() / 2);
  }
  EXPECT_GE(lamp.terms.size(), 25u);
}

TEST_P(EveryLamp, HasAnAsymmetricMark) {
  const Lamp lamp = *make_lamp(GetParam());
  const LampTerm& mark = lamp.terms.back();
  const Vec2 u(mark.x.center_mm, mark.y.center_mm), m(mark.x.slope, mark.y.slope);
  const double there = lamp.radiance(u, m).sum();
  for (const Vec2& flip : {Vec2(-1, 1), Vec2(1, -1), Vec2(-1, -1)}) {
    const Vec2 u_flipped = u.cwiseProduct(flip), m_flipped = m.cwiseProduct(flip);
    EXPECT_GT(there, 3 * lamp.radiance(u_flipped, m_flipped).sum());
    EXPECT_GT(there, 3 * lamp.radiance(u, m_flipped).sum());
  }
  EXPECT_GT(there, 3 * lamp.radiance(Vec2(u.y(), u.x()), Vec2(m.y(), m.x())).sum());
}

TEST_P(EveryLamp, ScreenIsTheIntegralOverTheExit) {
  for (StageCarries carries : {StageCarries::slide, StageCarries::lamp}) {
    const auto world = World::create(options_of(GetParam(), carries));
    ASSERT_TRUE(world);
    const Bench& bench = (*world)->bench();
    const Lamp lamp = *make_lamp(GetParam());
    const Slide slide(bench.filter);
    const ScreenGrid grid = ScreenGrid::covering(Vec2(240, 180), 12);
    for (const FilterPass& pass : bench.filter.passes) {
      const Vec2 u(4.3, -3.1), q = stage_for(bench, u, pass);
      const auto planes = screen_irradiance(lamp, slide, bench, grid, q, rgb_bands);
      const Vec2 shift = displacement_mm(bench, q);
      EXPECT_LT((filter_center_mm(bench, pass, q) - u).norm(), 1e-9);
      for (int row = 8; row <= 24; row += 4)
        for (int column = 10; column <= 34; column += 6) {
          const Vec2 s = grid.corner_mm + grid.step_mm * Vec2(column, row) - shift;
          const Eigen::Array3d expected =
              brute_force(lamp, s, [&](const Vec2& at) { return slide.transmission(pass, at - u); });
          for (int band = 0; band < 3; ++band)
            EXPECT_NEAR(planes[band](row, column), expected[band], 2e-4 * expected[band] + 1e-4)
                << pass.name << " at " << s.transpose();
        }
    }
  }
}

TEST_P(EveryLamp, PassesCombineToTheDualsImage) {
  const WorldOptions options = options_of(GetParam());
  const auto world = World::create(options);
  ASSERT_TRUE(world);
  const Bench& bench = (*world)->bench();
  const Lamp lamp = *make_lamp(GetParam());
  const Slide slide(bench.filter);
  const Dual dual(options.basis, options.window);
  const ScreenGrid grid = ScreenGrid::covering(Vec2(60, 60), 15);
  const Vec2 u(-7.5, 7.5);
  Plane combined = Plane::Zero(grid.rows, grid.columns);
  for (const FilterPass& pass : bench.filter.passes)
    combined += static_cast<float>(pass.scale) *
                screen_irradiance(lamp, slide, bench, grid, stage_for(bench, u, pass), {rgb_bands[1]})[0];
  for (int row = 0; row < grid.rows; row += 2)
    for (int column = 0; column < grid.columns; ++column) {
      const Vec2 s = grid.corner_mm + grid.step_mm * Vec2(column, row);
      const double expected = brute_force(
          lamp, s, [&](const Vec2& at) { return dual((at.x() - u.x()) / 7.5) * dual((at.y() - u.y()) / 7.5); })[1];
      EXPECT_NEAR(combined(row, column), expected, 1e-4 * combined.cwiseAbs().maxCoeff());
    }
}

TEST(Slide, TransmitsTheDual) {
  for (BasisKind basis : {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2}) {
    WorldOptions options;
    options.basis = basis;
    options.window = basis == BasisKind::box ? 1 : basis == BasisKind::bspline2 ? 5 : 4;
    const auto world = World::create(options);
    ASSERT_TRUE(world);
    const Bench& bench = (*world)->bench();
    const Slide slide(bench.filter);
    const Dual dual(basis, options.window);
    EXPECT_EQ(bench.filter.passes.size(), basis == BasisKind::box ? 1u : 2u);
    for (const Slide::Piece& piece : slide.pieces())
      for (double t : {0.01, 0.5, 0.99})
        EXPECT_GE((piece.positive ? 1 : -1) * dual(piece.begin + t * (piece.end - piece.begin)), -1e-9);
    for (double x = -20; x < 20; x += 0.37)
      for (double y = -20; y < 20; y += 0.41) {
        double sum = 0;
        for (const FilterPass& pass : bench.filter.passes) {
          const double transmission = slide.transmission(pass, Vec2(x, y));
          EXPECT_GE(transmission, 0);
          EXPECT_LE(transmission, 1 + 1e-6);
          sum += pass.scale * transmission;
        }
        EXPECT_NEAR(sum, dual(x / 7.5) * dual(y / 7.5), 1e-12);
      }
  }
}

TEST(Bench, LeavesOneFilterBeforeTheLampAndTheStageWithinItsLimits) {
  for (StageCarries carries : {StageCarries::slide, StageCarries::lamp})
    for (double spacing : {5.0, 7.5, 12.0}) {
      WorldOptions options = options_of("bike", carries);
      options.spacing_mm = {spacing, spacing};
      const auto world = World::create(options);
      ASSERT_TRUE(world);
      const Bench& bench = (*world)->bench();
      const int columns = cells_needed(36, spacing, 4), rows = cells_needed(22, spacing, 4);
      EXPECT_GE(columns * spacing, 36 + 4 * spacing);
      const Vec2 half_grid((columns - 1) * spacing / 2, (rows - 1) * spacing / 2);
      const Vec2 needed = half_grid + Vec2(18, 11) + Vec2::Constant(2 * spacing);
      EXPECT_GE(bench.filter.passes[1].offset_mm.x() - bench.filter.passes[0].offset_mm.x(), needed.x());
      EXPECT_GE(bench.filter.dark_offset_mm.y(), needed.y());
      FilterPass dark{"dark", bench.filter.dark_offset_mm, 0};
      for (const FilterPass& pass : {bench.filter.passes[0], bench.filter.passes[1], dark})
        for (double x : {-half_grid.x(), half_grid.x()})
          for (double y : {-half_grid.y(), half_grid.y()}) {
            const Vec2 q = stage_for(bench, Vec2(x, y), pass);
            EXPECT_TRUE((q.array() >= bench.limits.low_mm.array()).all() &&
                        (q.array() <= bench.limits.high_mm.array()).all())
                << q.transpose();
            // All of S stays before the camera.
            const Vec2 shift = pass.name == "dark" ? Vec2(0, 0) : displacement_mm(bench, q);
            for (double sx : {-150.0, 150.0})
              for (double sy : {-150.0, 150.0}) {
                const Vec2 pixel = project(bench.camera_model, Vec3(sx + shift.x(), sy + shift.y(), 150));
                EXPECT_TRUE(pixel.x() > 4 && pixel.x() < 1019 && pixel.y() > 4 && pixel.y() < 763) << pixel.transpose();
              }
          }
    }
}

TEST(Lens, MapInvertsTheProjection) {
  for (bool optics : {true, false}) {
    const CameraModel camera = place_camera(1024, 768, 150, Vec2(150, 150), optics);
    const LensMap map = make_lens_map(camera, 150);
    double worst = 0, displaced = 0;
    for (int j = 0; j < 768; j += 9)
      for (int i = 0; i < 1024; i += 9) {
        const Eigen::Vector2d s = map.screen_mm[static_cast<std::size_t>(j) * 1024 + i].cast<double>();
        worst = std::max(worst, (project(camera, Vec3(s.x(), s.y(), 150)) - Vec2(i, j)).norm());
        CameraModel pinhole = camera;
        pinhole.distortion = {};
        displaced = std::max(displaced, (project(pinhole, Vec3(s.x(), s.y(), 150)) - Vec2(i, j)).norm());
      }
    EXPECT_LT(worst, 1e-3);
    EXPECT_GT(displaced, optics ? 5 : -1);
    const Eigen::Matrix3d rotation = camera.pose.topLeftCorner<3, 3>();
    EXPECT_LT((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_NEAR(rotation.determinant(), 1, 1e-12);
  }
}

std::vector<std::uint16_t> frame_of(World& world, const Vec2& q, double exposure_s, double gain_db = 0) {
  std::vector<std::uint16_t> dn(static_cast<std::size_t>(1024) * 768);
  world.expose(q, exposure_s, gain_db, 1024, 768, 0, 0, dn);
  return dn;
}

/// Noise-free pixels against the integral at the point of the screen that they see.
TEST(World, PixelsSeeTheScreen) {
  for (const std::string format : {"Mono16", "BayerRG12"}) {
    WorldOptions options = options_of("bike", StageCarries::lamp);
    options.pixel_format = format;
    options.noise = false;
    const auto world = World::create(options);
    ASSERT_TRUE(world);
    const Bench& bench = (*world)->bench();
    const Lamp lamp = *make_lamp("bike");
    const Slide slide(bench.filter);
    const FilterPass& pass = bench.filter.passes[1];
    const Vec2 u(1, 2), q = stage_for(bench, u, pass), shift = displacement_mm(bench, q);
    const double exposure_s = 0.003;
    const auto dn = frame_of(**world, q, exposure_s);
    const LensMap map = make_lens_map(bench.camera_model, 150);
    for (const Vec2& m : {Vec2(0, 0), Vec2(0.1, -0.12), Vec2(-0.15, 0.05)}) {
      const Vec2 pixel =
          project(bench.camera_model, Vec3(u.x() + 150 * m.x() + shift.x(), u.y() + 150 * m.y() + shift.y(), 150));
      for (int odd : {0, 1}) {
        const int i = static_cast<int>(pixel.x()) / 2 * 2 + odd, j = static_cast<int>(pixel.y()) / 2 * 2 + odd;
        const std::size_t p = static_cast<std::size_t>(j) * 1024 + i;
        const Vec2 s = map.screen_mm[p].cast<double>() - shift;
        const Eigen::Array3d e = brute_force(lamp, s, [&](const Vec2& at) { return slide.transmission(pass, at - u); });
        const std::size_t band = odd ? 2 : 0;
        const bool bayer = format == "BayerRG12";
        const double seen =
            bayer ? e[band] * bench.sensor.responsivity[band] : (e * mono_weights).sum() * bench.sensor.responsivity[0];
        const double expected =
            bench.sensor.black_level_dn + bench.sensor.gain_dn_per_e * exposure_s * seen * map.illumination[p];
        EXPECT_NEAR(dn[p], expected, 0.002 * expected + 1) << format << " pixel " << i << ", " << j;
      }
    }
  }
}

/// The lens taken off and the slide out: a pinhole before the bare lamp.
TEST(World, SwitchesLensAndSlideOff) {
  const auto world = World::create({});
  ASSERT_TRUE(world);
  for (const char* knob : {"noise", "optics", "filter"}) ASSERT_TRUE((*world)->set(knob, 0));
  const Bench& bench = (*world)->bench();
  const auto dn = frame_of(**world, stage_for(bench, Vec2(40, 0), bench.filter.passes[0]), 4e-4);
  const LensMap map = make_lens_map(with_optics(bench.camera_model, false), 150);
  for (const std::size_t p : {std::size_t(384) * 1024 + 512, std::size_t(300) * 1024 + 430}) {
    EXPECT_EQ(map.illumination[p], 1);
    const Eigen::Array3d e = brute_force(*make_lamp("bike"), map.screen_mm[p].cast<double>(), [](Vec2) { return 1.0; });
    const double electrons = 4e-4 * (e * mono_weights).sum() * bench.sensor.responsivity[0];
    EXPECT_GT(electrons, 50);
    const double expected = bench.sensor.black_level_dn + bench.sensor.gain_dn_per_e * electrons;
    EXPECT_NEAR(dn[p], expected, 0.002 * expected + 1);
  }
}

TEST(World, RepeatsAFrameAndNoOther) {
  const auto world = World::create({});
  WorldOptions other_seed;
  other_seed.seed = 2;
  const auto other = World::create(other_seed);
  ASSERT_TRUE(world && other);
  const Vec2 q = stage_for((*world)->bench(), Vec2(0, 0), (*world)->bench().filter.passes[0]);
  const auto first = frame_of(**world, q, 0.008);
  for (int away = 1; away <= 10; ++away) (*world)->wait_ready(q + Vec2(away, 0));
  EXPECT_EQ(first, frame_of(**world, q, 0.008));
  EXPECT_EQ(first, frame_of(**world, q + Vec2(4e-4, 0), 0.008));
  EXPECT_NE(first, frame_of(**world, q + Vec2(0.001, 0), 0.008));
  EXPECT_NE(first, frame_of(**world, q, 0.008001));
  EXPECT_NE(first, frame_of(**world, q, 0.008, 0.01));
  EXPECT_NE(first, frame_of(**other, q, 0.008));

  std::vector<std::uint16_t> region(64 * 48);
  (*world)->expose(q, 0.008, 0, 64, 48, 500, 300, region);
  for (int j = 0; j < 48; ++j)
    for (int i = 0; i < 64; ++i)
      ASSERT_EQ(region[j * 64 + i], first[static_cast<std::size_t>(j + 300) * 1024 + i + 500]);
}

TEST(World, SaturatesAndGoesDark) {
  const auto world = World::create({});
  ASSERT_TRUE(world);
  const Bench& bench = (*world)->bench();
  const auto bright = frame_of(**world, stage_for(bench, Vec2(0, 0), bench.filter.passes[0]), 0.128);
  EXPECT_EQ(*std::max_element(bright.begin(), bright.end()), 4095);

  const FilterPass opaque{"dark", bench.filter.dark_offset_mm, 0};
  const auto dark = frame_of(**world, stage_for(bench, Vec2(0, 0), opaque), 0.128);
  double sum = 0;
  int hot = 0;
  for (std::uint16_t dn : dark) {
    sum += dn;
    hot += dn > 64 + 15;
  }
  EXPECT_NEAR(sum / static_cast<double>(dark.size()), 64 + 0.4 * 3 * 0.128, 0.05);
  EXPECT_GE(hot, 20);
  EXPECT_LE(hot, 40);
}

TEST(World, ServesManyThreads) {
  const auto world = World::create({});
  ASSERT_TRUE(world);
  const Vec2 q = stage_for((*world)->bench(), Vec2(0, 0), (*world)->bench().filter.passes[0]);
  const auto expected = frame_of(**world, q + Vec2(3, 0), 0.004);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&, t] {
      for (int k = 0; k < 6; ++k) {
        (*world)->prepare(q + Vec2(k + t, 1));
        EXPECT_EQ(frame_of(**world, q + Vec2(3, 0), 0.004), expected);
      }
    });
}

TEST(World, TurnsItsKnobs) {
  const auto world = World::create({});
  ASSERT_TRUE(world);
  const Vec2 q = stage_for((*world)->bench(), Vec2(0, 0), (*world)->bench().filter.passes[0]);
  const auto sum = [&] {
    double total = 0;
    for (std::uint16_t dn : frame_of(**world, q, 0.001)) total += dn;
    return total;
  };
  ASSERT_TRUE((*world)->set("noise", 0));
  const double steady = sum();
  EXPECT_EQ(frame_of(**world, Vec2(0, 0), 0.001)[0], 64);
  ASSERT_TRUE((*world)->set("lamp_drift", 3.6e4));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_GT(sum(), 1.05 * steady);
  ASSERT_TRUE((*world)->set("lamp_drift", 0));
  EXPECT_EQ(sum(), steady);
  ASSERT_TRUE((*world)->set("lamp_warm_up", 0.5));
  ASSERT_TRUE((*world)->set("lamp_warm_up_s", 1000));
  EXPECT_NEAR(sum() - 1024 * 768 * 64, 1.5 * (steady - 1024 * 768 * 64), 0.02 * steady);
  EXPECT_NEAR((*world)->light(), 1.5, 0.05);
  ASSERT_TRUE((*world)->set("lamp_warm_up_s", 1e-6));
  EXPECT_EQ(sum(), steady);
  EXPECT_FALSE((*world)->set("lamp_warm_up", -1.1));
  EXPECT_FALSE((*world)->set("lamp_warm_up_s", 0));
  for (const char* knob : {"optics", "filter"}) {
    ASSERT_TRUE((*world)->set(knob, 0));
    EXPECT_NE(sum(), steady) << knob;
    ASSERT_TRUE((*world)->set(knob, 1));
    EXPECT_EQ(sum(), steady) << knob;
  }
  EXPECT_FALSE((*world)->set("noise", 2));
  EXPECT_FALSE((*world)->set("lamp_drift", std::nan("")));
  EXPECT_FALSE((*world)->set("weather", 1));
}

TEST(World, RefusesWhatItCannotBe) {
  const auto refused = [](auto change) {
    WorldOptions options;
    change(options);
    const auto world = World::create(options);
    return !world && !world.error().what.empty() && !world.error().remedy.empty();
  };
  EXPECT_TRUE(refused([](WorldOptions& o) { o.lamp = "candle"; }));
  EXPECT_TRUE(refused([](WorldOptions& o) { o.pixel_format = "RGB8"; }));
  EXPECT_TRUE(refused([](WorldOptions& o) { o.spacing_mm = {0, 7.5}; }));
  EXPECT_TRUE(refused([](WorldOptions& o) { o.spacing_mm = {std::nan(""), 7.5}; }));
  EXPECT_TRUE(refused([](WorldOptions& o) { o.window = 1; }));
  EXPECT_TRUE(refused([](WorldOptions& o) { o.width_px = 1000000; }));
}

TEST(Photosites, NoiseHasTheModelsMeanAndVariance) {
  Sensor sensor;
  sensor.black_level_dn = 64;
  sensor.gain_dn_per_e = 6.4;
  sensor.read_noise_e = 4;
  const std::size_t n = static_cast<std::size_t>(640) * 480;
  sensor.saturation_dn = 65535;
  const Photosites photosites(sensor, 640, 480, 7);
  std::vector<std::uint16_t> dn(n);
  for (double electrons : {30.0, 400.0, 4000.0})
    for (double gain_db : {0.0, 6.0}) {
      const std::vector<float> rate(n, static_cast<float>(electrons / 0.01));
      photosites.expose({{1, 2}, 0.01, gain_db, true, 1}, 0, rate, dn);
      const double gain = 6.4 * std::pow(10, gain_db / 20);
      double sum = 0, sum2 = 0, next_to = 0;
      std::size_t used = 0, beyond = 0;
      const double expected = electrons + 0.03, variance = expected + 16;
      double before = 0;
      for (std::size_t p = 0; p < n; ++p) {
        if (photosites.dark_current()[p] != 3) continue;
        const double z = ((dn[p] - 64) / gain - expected) / std::sqrt(variance);
        sum += z, sum2 += z * z, next_to += z * before, ++used, beyond += std::abs(z) > 3;
        before = z;
      }
      const double count = static_cast<double>(used), deviation = 1 / std::sqrt(count);
      EXPECT_NEAR(sum / count, 0, 4 * deviation);
      EXPECT_NEAR(sum2 / count, 1, 6 * deviation);
      EXPECT_NEAR(next_to / count, 0, 4 * deviation);
      EXPECT_NEAR(static_cast<double>(beyond) / count, 0.0027, 0.0006);
    }
}

}  // namespace
}  // namespace lumifield::virtual_bench
