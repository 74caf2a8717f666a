#include "renderer/study/environment_figures.h"

#include <chrono>
#include <cmath>
#include <functional>

#include "renderer/bands.h"
#include "renderer/environment/environment_light.h"
#include "renderer/study/lab.h"
#include "renderer/study/ladder.h"

namespace lumifield {

namespace {

constexpr int side = 48;
constexpr int reference_samples = 100'000;
constexpr std::uint32_t bias_seeds = 64;
const double none = std::nan("");

struct Surface {
  const char* name;
  int kind;
  float shape;
};

/// Of each pixel of the picture the normal, as seen from +x, a little from above; no length beside the sphere.
std::vector<Vec3> normals(const Vec3& eye) {
  std::vector<Vec3> all;
  const Vec3 right = Vec3(-eye.y(), eye.x(), 0).normalized(),
             up(eye.y() * right.z() - eye.z() * right.y(), eye.z() * right.x() - eye.x() * right.z(),
                eye.x() * right.y() - eye.y() * right.x());
  for (int k = 0; k < side * side; ++k) {
    const double x = (k % side + 0.5) / side * 2 - 1, y = 1 - (k / side + 0.5) / side * 2;
    const double r2 = (x * x + y * y) / (0.95 * 0.95);
    all.push_back(r2 < 1 ? Vec3((x * right + y * up) / 0.95 + std::sqrt(1 - r2) * eye) : Vec3(0, 0, 0));
  }
  return all;
}

using Radiance = std::function<std::array<double, 3>(const Vec3& n)>;

void fill(Picture& picture, const std::vector<Vec3>& normals, const Radiance& radiance, std::size_t begin,
          std::size_t end) {
  for (std::size_t k = begin; k < end; ++k) {
    if (normals[k] == Vec3(0, 0, 0)) continue;
    const auto light = radiance(normals[k]);
    picture.coverage[k] = 1;
    for (std::size_t c = 0; c < 3; ++c) picture.rgb[3 * k + c] = static_cast<float>(light[c]);
  }
}

Picture picture_of(const std::vector<Vec3>& normals, const Radiance& radiance) {
  Picture picture{side, side, std::vector<float>(3 * normals.size()), std::vector<float>(normals.size()), {}};
  in_bands(normals.size(), [&](std::size_t begin, std::size_t end) { fill(picture, normals, radiance, begin, end); });
  return picture;
}

double one_thread_ms(const std::vector<Vec3>& normals, const Radiance& radiance) {
  Picture picture{side, side, std::vector<float>(3 * normals.size()), std::vector<float>(normals.size()), {}};
  const auto start = std::chrono::steady_clock::now();
  fill(picture, normals, radiance, 0, normals.size());
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double rel_rmse(const Picture& picture, const Picture& reference) {
  double squares = 0, sum = 0, count = 0;
  for (std::size_t k = 0; k < picture.rgb.size(); ++k) {
    if (picture.coverage[k / 3] == 0) continue;
    squares += std::pow(static_cast<double>(picture.rgb[k]) - static_cast<double>(reference.rgb[k]), 2);
    sum += static_cast<double>(reference.rgb[k]);
    ++count;
  }
  return std::sqrt(squares / count) / (sum / count);
}

/// Of pictures by so many seeds: what noise is in one is gone from it, the filter's bias is not.
Picture mean_picture(const EnvironmentLight& environment, const std::vector<Vec3>& seen, const GlossLobe& lobe,
                     int samples) {
  std::vector<double> sum(3 * seen.size());
  Picture picture;
  for (std::uint32_t seed = 1; seed <= bias_seeds; ++seed) {
    const EnvironmentLight light = environment.with(samples, seed);
    picture = picture_of(seen, [&](const Vec3& n) { return light.gloss(lobe, n); });
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += static_cast<double>(picture.rgb[k]);
  }
  for (std::size_t k = 0; k < sum.size(); ++k) picture.rgb[k] = static_cast<float>(sum[k] / bias_seeds);
  return picture;
}

}  // namespace

Result<std::vector<FigureRow>> environment_figures(const LatLong& environment, const StudyProgress& progress) {
  std::vector<FigureRow> rows;
  const EnvironmentLight filtered(environment, 1, {.filter = true}), plain(environment, 1, {.filter = false});
  double done = 0;
  const Vec3 eye = Vec3(1, -0.4, 0.35).normalized();
  const std::vector<Vec3> seen = normals(eye);
  const Eigen::Vector3f o = eye.cast<float>();
  for (const Surface& s : {Surface{"Phong, exponent 50", LOBE_PHONG, 50}, {"GGX, roughness 0.3", LOBE_GGX, 0.09F}}) {
    const GlossLobe lobe{o.x(), o.y(), o.z(), s.shape, 1, 1, 1, s.kind};
    if (!progress(done, std::string("Fig. 20-8, ") + s.name)) return study_stopped();
    const Picture reference =
        picture_of(seen, [&](const Vec3& n) { return environment_reference(environment, lobe, n, reference_samples); });
    const double white = average_luminance(reference);
    const Picture8 wanted = tone_map(reference, {1, white});
    for (const bool filter : {true, false})
      for (const int samples : {10, 20, 40, 100, 200}) {
        if (!progress(done, std::string("Fig. 20-8, ") + s.name)) return study_stopped();
        done += 1.0 / 20;
        const EnvironmentLight light = (filter ? filtered : plain).with(samples, 1);
        const Radiance gloss = [&](const Vec3& n) { return light.gloss(lobe, n); };
        const Picture picture = picture_of(seen, gloss);
        const std::string what =
            std::string(s.name) + ", " + std::to_string(samples) + " samples, " + (filter ? "filtered" : "plain");
        const auto add = [&](const char* figure, const char* quantity, double ours) {
          rows.push_back({figure, "environment", what, quantity, ours, none});
        };
        add("Fig. 20-8", "mean Lab ΔE", mean_lab_delta_e(tone_map(picture, {1, white}), wanted));
        add("Fig. 20-8", "relative RMSE", rel_rmse(picture, reference));
        add("Fig. 20-9", "time of a picture, one thread, ms", one_thread_ms(seen, gloss));
        if (filter)
          add("Fig. 20-8", "bias of the filter, relative RMSE",
              rel_rmse(mean_picture(filtered, seen, lobe, samples), reference));
      }
  }
  return rows;
}

}  // namespace lumifield
