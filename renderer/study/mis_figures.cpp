#include "renderer/study/mis_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

#include "renderer/sampling/sequence.h"
#include "renderer/study/ladder.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/relative_rmse.h"

namespace lumifield {

namespace {

constexpr int width = 256, height = 192, most_receivers = 1024, seeds = 6;
constexpr std::uint32_t strata_seed = 7, mirror_seed = 11;
constexpr std::array compared{Method::position_dependent, Method::filtered_brdf, Method::mis};

/// Some receivers of a frame with their reference.
struct Scored {
  StudyFrame frame;  ///< of them alone, pixel by pixel as they are numbered
  std::vector<double> reference;
  std::size_t channels;

  /// Adds what is seen.
  void judge(const StudyLight& light, RelativeRmse& error) const {
    auto wanted = reference.begin();
    for (std::size_t k = 0; k < frame.receivers.size(); ++k)
      for (const double value : frame.seen(light, k, k, channels)) error.add(value, *wanted++);
  }
  double mean() const {
    double sum = 0;
    for (const double value : reference) sum += value;
    return sum / static_cast<double>(reference.size());
  }
};

/// Every eye where it sees a point of the lamp, or beside it by a tenth, mirrored.
void mirror(const Sampling& sampling, StudyFrame& frame) {
  const Vec2 size = 1.2 * sampling.spacing_mm.cwiseProduct(Vec2(sampling.columns, sampling.rows));
  for (std::size_t k = 0; k < frame.receivers.size(); ++k) {
    const Receiver& r = frame.receivers[k];
    const auto number = static_cast<std::uint32_t>(k);
    const Vec2 share(unit(hash(2 * number, mirror_seed, 0)) - 0.5, unit(hash(2 * number + 1, mirror_seed, 0)) - 0.5);
    const Vec2 at = sampling.center_mm + size.cwiseProduct(share);
    const Vec3 to = (Vec3(at.x(), at.y(), 0) - r.p_mm).normalized(), eye = 2 * r.n.dot(to) * r.n - to;
    GlossLobe& lobe = frame.appearance.gloss[k];
    lobe.eye_x = static_cast<float>(eye.x());
    lobe.eye_y = static_cast<float>(eye.y());
    lobe.eye_z = static_cast<float>(eye.z());
  }
}

Result<Scored> scored(StudyCamera& camera, const LightField& light_field, double roughness, bool mirrored,
                      const std::filesystem::path& cache) {
  auto all = camera.frame(width, height, light_field, {.roughness = roughness});
  if (!all) return tl::unexpected(all.error());
  std::vector<std::size_t> chosen = stratified_receivers(*all, strata_seed);
  const std::size_t step = chosen.size() / most_receivers + 1;
  for (std::size_t k = 0; k * step < chosen.size(); ++k) chosen[k] = chosen[k * step];
  chosen.resize((chosen.size() + step - 1) / step);
  if (chosen.empty()) return fail("no surface beyond S is seen", "the scene", "turn the camera or the luminaire");
  Scored some{{}, {}, light_field.geometry().channels.size()};
  some.frame.materials = all->materials;
  some.frame.receivers = all->receivers_at(chosen);
  some.frame.appearance = all->appearance_at(chosen);
  for (const std::size_t pixel : chosen)
    for (std::size_t c = 0; c < 4; ++c) {
      some.frame.gbuffer.normal.push_back(all->gbuffer.normal[4 * pixel + c]);
      if (!all->gbuffer.reflectance.empty())
        some.frame.gbuffer.reflectance.push_back(all->gbuffer.reflectance[4 * pixel + c]);
    }
  if (mirrored) mirror(light_field.geometry().sampling, some.frame);
  const auto light = cached_reference(light_field, some.frame.receivers, some.frame.appearance, cache);
  if (!light) return tl::unexpected(light.error());
  const auto gloss = light->begin() + static_cast<std::ptrdiff_t>(chosen.size() * some.channels);
  const StudyLight truth{{light->begin(), gloss}, {gloss, light->end()}};
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (const double value : some.frame.seen(truth, k, k, some.channels)) some.reference.push_back(value);
  if (!(some.mean() > 0)) return fail("the luminaire lights nothing that is seen", "the scene", "turn it");
  return some;
}

/// A method with the luminaire's cells, at one K: the least kernel time of its runs, since other work only adds to it.
struct Point {
  DeviceMethod* method;
  double samples;
  double s = HUGE_VAL;
  RelativeRmse error{};  ///< over all seeds
};
/// Run by run of all, so that what slows a while slows them alike.
Status run(std::vector<Point>& points, const Scored& scored, const std::function<bool()>& told) {
  for (int seed = 1; seed <= seeds; ++seed)
    for (Point& point : points) {
      if (!told()) return study_stopped();
      if (const Status set = point.method->set_samples(point.samples, static_cast<std::uint32_t>(seed)); !set)
        return set;
      StudyLight light;
      const auto took = timed_evaluation(*point.method, scored.frame, 1, light);
      if (!took) return tl::unexpected(took.error());
      point.s = std::min(point.s, *took);
      scored.judge(light, point.error);
    }
  return {};
}

/// The error at a time, by the line in the logarithms through the two points about it, or nearest.
double error_at(std::span<const Point> ladder, double s) {
  std::size_t k = 1;
  while (k + 1 < ladder.size() && ladder[k].s < s) ++k;
  const Point &a = ladder[k - 1], &b = ladder[k];
  if (!(b.s > a.s)) return b.error.value();
  const double share = std::log(s / a.s) / std::log(b.s / a.s);
  return a.error.value() * std::pow(b.error.value() / a.error.value(), share);
}

}  // namespace

Result<std::vector<FigureRow>> mis_figures(StudyCamera& camera, const StudyLuminaire& luminaire,
                                           const std::filesystem::path& cache, bool quick,
                                           const StudyProgress& progress) {
  const LightField& light_field = luminaire.light_field;
  const double usual = info(Method::mis).samples, none = std::nan("");
  std::array<std::unique_ptr<DeviceMethod>, compared.size()> made;
  for (std::size_t m = 0; m < compared.size(); ++m) {
    auto method = make_device_method(light_field.geometry(), {.method = compared[m]});
    if (!method) return tl::unexpected(method.error());
    if (const Status set = (*method)->set_cells(light_field); !set) return tl::unexpected(set.error());
    made[m] = std::move(*method);
  }
  const std::vector<double> some{0, 0.1, 0.3, 1}, all{0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1};
  const std::vector<double>& roughnesses = quick ? some : all;
  std::vector<FigureRow> rows;
  for (std::size_t k = 0; k < 2 * roughnesses.size(); ++k) {
    const double roughness = roughnesses[k / 2];
    const bool mirrored = k % 2 == 1;
    if (mirrored && roughness == 0) continue;
    std::string look = StudyLook{.roughness = roughness}.name();
    look = (look.empty() ? "diffuse" : look) + (mirrored ? ", the lamp mirrored" : "");
    const auto at = scored(camera, light_field, roughness, mirrored, cache);
    if (!at) return tl::unexpected(at.error());
    std::vector<Point> points;
    for (const auto& method : {made[0].get(), made[1].get()})
      for (const double samples : {usual / 4, usual, 4 * usual}) points.push_back({method, samples});
    points.push_back({made[2].get(), usual});
    const auto told = [&] {
      return progress(static_cast<double>(k) / static_cast<double>(2 * roughnesses.size()),
                      luminaire.name + ", mis, " + look);
    };
    if (const Status ran = run(points, *at, told); !ran) return tl::unexpected(ran.error());
    const Point& mis = points.back();
    double better = HUGE_VAL;
    for (std::size_t m = 0; m < 2; ++m) {
      const double error = error_at(std::span(points).subspan(3 * m, 3), mis.s);
      better = std::min(better, error);
      rows.push_back({"mis", luminaire.name, look + ": " + std::string(to_string(compared[m])),
                      "relative RMSE in equal time, %", 100 * error, none});
    }
    rows.push_back(
        {"mis", luminaire.name, look + ": mis", "relative RMSE in equal time, %", 100 * mis.error.value(), none});
    rows.push_back({"mis", luminaire.name, look + ": mis over the better part", "ratio of relative RMSE",
                    mis.error.value() / better, none});
  }
  return rows;
}

}  // namespace lumifield
