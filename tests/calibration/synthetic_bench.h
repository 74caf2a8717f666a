#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "luminaire/bench.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield::test {

/// E on the plane S at a point of the bench frame, W/m², for a channel.
using Irradiance = std::function<double(const Vec2& s_mm, int channel)>;

/// An oblique camera with a strongly distorting lens, small enough to be quick: S is 96×72 mm at 1 mm, seen by 320×240
/// px.
inline Bench synthetic_bench() {
  Bench b;
  b.name = "synthetic";
  b.separation_mm = 150;
  b.camera.pixel_format = "Mono16";
  CameraModel& m = b.camera_model;
  m.width_px = 320, m.height_px = 240;
  m.fx = 1110, m.fy = 1085, m.cx = 163.3, m.cy = 117.1;
  m.distortion = {-0.35, 0.22, 1.5e-3, -1e-3, 0.05};
  m.vignetting = {-0.9, 0.4, -0.1};
  const Vec3 eye(120, -90, 500), target(0, 0, 150);
  const Vec3 forward = (target - eye).normalized();
  const Vec3 right = forward.cross(Vec3(0.03, 1, 0)).normalized(), down = forward.cross(right);
  m.pose.block<1, 3>(0, 0) = right.transpose();
  m.pose.block<1, 3>(1, 0) = down.transpose();
  m.pose.block<1, 3>(2, 0) = forward.transpose();
  m.pose.topRightCorner<3, 1>() = -(m.pose.topLeftCorner<3, 3>() * eye);
  b.sensor = {240, 2.0, 5, 65000, {20000}, "2024-05-01", "synthetic"};
  b.filter = {BasisKind::bell, {7.5, 7.5}, 4, {{"open", {0, 0}, 1}}, {0, 90}};
  return b;
}

inline Plan synthetic_plan() {
  Plan p;
  p.name = "synthetic";
  p.columns = 3, p.rows = 3;
  p.measurement = {96, 72, {1, 1}, {2, -3}};
  p.exposures_s = {0.002, 0.008, 0.032, 0.128};
  return p;
}

/// The forward model, on its own: undistortion by fixed-point iteration, ray by the pose's transpose.
struct ForwardModel {
  explicit ForwardModel(const Bench& bench) : b(bench) {}
  const Bench& b;

  Vec2 ray(double u, double v) const {
    const auto& m = b.camera_model;
    const auto [k1, k2, p1, p2, k3] = m.distortion;
    const double xd = (u - m.cx) / m.fx, yd = (v - m.cy) / m.fy;
    double x = xd, y = yd;
    for (int n = 0; n < 60; ++n) {
      const double r2 = x * x + y * y, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
      const double tx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x), ty = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
      const double nx = (xd - tx) / radial, ny = (yd - ty) / radial;
      const bool done = std::abs(nx - x) + std::abs(ny - y) < 1e-14;
      x = nx, y = ny;
      if (done) break;
    }
    return {x, y};
  }
  Vec2 screen_mm(double u, double v) const {
    const auto& pose = b.camera_model.pose;
    const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>();
    const Vec3 eye = -rotation.transpose() * pose.topRightCorner<3, 1>();
    const Vec2 r = ray(u, v);
    const Vec3 direction = rotation.transpose() * Vec3(r.x(), r.y(), 1);
    return (eye + (b.separation_mm - eye.z()) / direction.z() * direction).head<2>();
  }
  int channel(int i, int j) const {
    if (b.camera.pixel_format.rfind("BayerRG", 0) != 0) return 0;
    return i % 2 == 0 && j % 2 == 0 ? 0 : i % 2 == 1 && j % 2 == 1 ? 2 : 1;
  }

  /// e⁻/s of every photosite, E averaged over n×n points of its own pixel.
  std::vector<double> rates(const Irradiance& irradiance, int n = 4) const {
    const auto& m = b.camera_model;
    std::vector<double> rate;
    for (int j = 0; j < m.height_px; ++j) {
      for (int i = 0; i < m.width_px; ++i) {
        double sum = 0;
        for (int k = 0; k < n * n; ++k)
          sum += irradiance(screen_mm(i - 0.5 + (k % n + 0.5) / n, j - 0.5 + (k / n + 0.5) / n), channel(i, j));
        const double s = ray(i, j).squaredNorm();
        const double v = 1 + m.vignetting[0] * s + m.vignetting[1] * s * s + m.vignetting[2] * s * s * s;
        rate.push_back(b.sensor.responsivity[static_cast<std::size_t>(channel(i, j))] * v * sum / (n * n));
      }
    }
    return rate;
  }
};

/// A camera that turns rates into frames; without a generator it is noise-free but for rounding.
struct SyntheticCamera {
  const Bench& bench;
  std::vector<double> dark_per_s;  ///< e⁻/s per photosite; empty = none
  std::mt19937_64* random = nullptr;

  RawImage frame(const std::vector<double>& rate, double exposure_s) const {
    const Sensor& s = bench.sensor;
    RawImage image;
    image.width_px = bench.camera_model.width_px, image.height_px = bench.camera_model.height_px;
    image.bits = 16;
    image.pattern = bench.camera.pixel_format == "Mono16" ? SensorPattern::mono : SensorPattern::rggb;
    image.exposure_s = exposure_s;
    image.gain = bench.camera.gain;
    const double g = s.gain_dn_per_e * std::pow(10, image.gain / 20);
    image.dn.resize(rate.size());
    std::normal_distribution<double> read(0, s.read_noise_e > 0 ? s.read_noise_e : 1);
    for (std::size_t i = 0; i < rate.size(); ++i) {
      double e = exposure_s * (rate[i] + (dark_per_s.empty() ? 0 : dark_per_s[i]));
      if (random) {
        e = e > 0 ? static_cast<double>(std::poisson_distribution<long>(e)(*random)) : 0;
        if (s.read_noise_e > 0) e += read(*random);
      }
      image.dn[i] = static_cast<std::uint16_t>(std::clamp(std::round(s.black_level_dn + g * e), 0.0, 65535.0));
    }
    return image;
  }
  Bracket bracket(const std::vector<double>& rate, const std::vector<double>& exposures_s) const {
    Bracket all;
    for (const double t : exposures_s) all.push_back(frame(rate, t));
    return all;
  }
  std::shared_ptr<const DarkSet> dark_set(const std::vector<double>& exposures_s) const {
    const std::size_t size =
        static_cast<std::size_t>(bench.camera_model.width_px) * static_cast<std::size_t>(bench.camera_model.height_px);
    return std::make_shared<const DarkSet>(DarkSet{bracket(std::vector<double>(size, 0.0), exposures_s), 0});
  }
};

/// One cell: a bracket of each pass' rates.
inline RawCell synthetic_cell(const SyntheticCamera& camera, const Plan& plan,
                              const std::vector<std::vector<double>>& rates) {
  RawCell raw;
  raw.cell = {1, 1};
  for (std::size_t p = 0; p < rates.size(); ++p)
    raw.passes.push_back({camera.bench.filter.passes[p].name, camera.bracket(rates[p], plan.exposures_s), {0, 0}});
  raw.dark = camera.dark_set(plan.exposures_s);
  return raw;
}

/// Mean of f over pixel (i, j) of S.
template <class F>
double pixel_mean(const Measurement& m, int i, int j, F f, int n = 8) {
  double sum = 0;
  for (int k = 0; k < n * n; ++k)
    sum += f(
        Vec2(m.corner_mm() + Vec2((i + (k % n + 0.5) / n) * m.pixel_mm.x(), (j + (k / n + 0.5) / n) * m.pixel_mm.y())));
  return sum / (n * n);
}

}  // namespace lumifield::test
