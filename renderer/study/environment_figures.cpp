#include "renderer/study/environment_figures.h"

#include <chrono>
#include <cmath>
#include <functional>

#include "renderer/environment/environment_light.h"
#include "renderer/study/lab.h"
#include "renderer/study/ladder.h"
#include "renderer/study/relative_rmse.h"

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

using Told = std::function<bool()>;

/// Row by row; `told` is asked between two.
Result<Picture> picture_of(const std::vector<Vec3>& normals, const Radiance& radiance, const Told& told) {
  Picture picture{side, side, std::vector<float>(3 * normals.size()), std::vector<float>(normals.size()), {}};
  for (std::size_t begin = 0; begin < normals.size(); begin += side) {
    if (!told()) return study_stopped();
    fill(picture, normals, radiance, begin, begin + side);
  }
  return picture;
}

double one_thread_ms(const std::vector<Vec3>& normals, const Radiance& radiance) {
  Picture picture{side, side, std::vector<float>(3 * normals.size()), std::vector<float>(normals.size()), {}};
  const auto start = std::chrono::steady_clock::now();
  fill(picture, normals, radiance, 0, normals.size());
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// Of pictures by so many seeds: what noise is in one is gone from it, the filter's bias is not.
Result<Picture> mean_picture(const EnvironmentLight& environment, const std::vector<Vec3>& seen, const GlossLobe& lobe,
                             int samples, const Told& told) {
  std::vector<double> sum(3 * seen.size());
  Result<Picture> picture;
  for (std::uint32_t seed = 1; seed <= bias_seeds; ++seed) {
    const EnvironmentLight light = environment.with(samples, seed);
    picture = picture_of(
        seen, [&](const Vec3& n) { return light.gloss(lobe, n); }, told);
    if (!picture) return picture;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += static_cast<double>(picture->rgb[k]);
  }
  for (std::size_t k = 0; k < sum.size(); ++k) picture->rgb[k] = static_cast<float>(sum[k] / bias_seeds);
  return picture;
}

/// The rows of one environment.
class Sphere {
 public:
  Sphere(const LatLong& environment, const StudyProgress& progress) : environment_(environment), progress_(progress) {}

  Status judge(const Surface& surface) {
    surface_ = &surface;
    const Eigen::Vector3f o = eye_.cast<float>();
    lobe_ = {o.x(), o.y(), o.z(), surface.shape, 1, 1, 1, surface.kind};
    auto reference = picture_of(
        seen_, [&](const Vec3& n) { return environment_reference(environment_, lobe_, n, points_); }, told_);
    if (!reference) return tl::unexpected(reference.error());
    reference_ = std::move(*reference);
    for (const bool filter : {true, false})
      for (const int samples : {10, 20, 40, 100, 200}) {
        if (const Status judged = judge(samples, filter); !judged) return judged;
        done_ += 1.0 / 20;
      }
    return {};
  }

  std::vector<FigureRow> rows;

 private:
  Status judge(int samples, bool filter) {
    const EnvironmentLight light = (filter ? filtered_ : plain_).with(samples, 1);
    const Radiance gloss = [&](const Vec3& n) { return light.gloss(lobe_, n); };
    const auto picture = picture_of(seen_, gloss, told_);
    if (!picture) return tl::unexpected(picture.error());
    const std::string what =
        std::string(surface_->name) + ", " + std::to_string(samples) + " samples, " + (filter ? "filtered" : "plain");
    const auto add = [&](const char* figure, const char* quantity, double ours) {
      rows.push_back({figure, "environment", what, quantity, ours, none});
    };
    const double white = average_luminance(reference_);
    add("Fig. 20-8", "mean Lab ΔE", mean_lab_delta_e(tone_map(*picture, {1, white}), tone_map(reference_, {1, white})));
    add("Fig. 20-8", "relative RMSE", relative_rmse(*picture, reference_));
    add("Fig. 20-9", "time of a picture, one thread, ms", one_thread_ms(seen_, gloss));
    if (!filter) return {};
    const auto mean = mean_picture(filtered_, seen_, lobe_, samples, told_);
    if (!mean) return tl::unexpected(mean.error());
    add("Fig. 20-8", "bias of the filter, relative RMSE", relative_rmse(*mean, reference_));
    return {};
  }

  const LatLong& environment_;
  const StudyProgress& progress_;
  const EnvironmentLight filtered_{environment_, 1, {.filter = true}}, plain_{environment_, 1, {.filter = false}};
  const std::vector<LobePoint> points_ = environment_reference_points(reference_samples);
  const Vec3 eye_ = Vec3(1, -0.4, 0.35).normalized();
  const std::vector<Vec3> seen_ = normals(eye_);
  double done_ = 0;
  const Surface* surface_ = nullptr;
  GlossLobe lobe_{};
  Picture reference_;
  const Told told_ = [this] { return progress_(done_, std::string("Fig. 20-8, ") + surface_->name); };
};

}  // namespace

Result<std::vector<FigureRow>> environment_figures(const LatLong& environment, const StudyProgress& progress) {
  Sphere sphere(environment, progress);
  for (const Surface& surface :
       {Surface{"Phong, exponent 50", LOBE_PHONG, 50}, {"GGX, roughness 0.3", LOBE_GGX, 0.09F}})
    if (const Status judged = sphere.judge(surface); !judged) return tl::unexpected(judged.error());
  return std::move(sphere.rows);
}

}  // namespace lumifield
