#include "renderer/study/mis_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

#include "renderer/sampling/sequence.h"
#include "renderer/study/ladder.h"
#include "renderer/study/ladder_rows.h"
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
using Told = std::function<bool()>;
/// Run by run of all, so that what slows a while slows them alike.
Status run(std::span<Point> points, const Scored& scored, const Told& told) {
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

StudyPoint as_study_point(const Point& point) {
  StudyPoint as;
  as.cost = point.samples;
  as.time_ms = 1e3 * point.s;
  as.rel_rmse = point.error.value();
  return as;
}

/// mis, and ladders of the others, that hold its time between two points where they can.
struct Compared {
  StudyPoint mis;
  std::array<std::vector<StudyPoint>, 2> parts;
};
Result<Compared> compare(const std::array<DeviceMethod*, 3>& methods, const Scored& scored, const Told& told) {
  const double usual = info(Method::mis).samples, most = 256 * usual;
  constexpr std::array rungs{0.25, 1.0, 4.0};
  std::vector<Point> points;
  for (std::size_t m = 0; m < 2; ++m)
    for (const double rung : rungs) points.push_back({methods[m], rung * usual});
  points.push_back({methods[2], usual});
  if (const Status ran = run(points, scored, told); !ran) return tl::unexpected(ran.error());
  Compared all{as_study_point(points.back()), {}};
  for (std::size_t m = 0; m < 2; ++m) {
    std::vector<StudyPoint>& ladder = all.parts[m];
    for (std::size_t k = 0; k < rungs.size(); ++k) ladder.push_back(as_study_point(points[rungs.size() * m + k]));
    while (const auto samples = next_cost(ladder, all.mis.time_ms, 1, most)) {
      Point more{methods[m], *samples};
      if (const Status ran = run({&more, 1}, scored, told); !ran) return tl::unexpected(ran.error());
      ladder.push_back(as_study_point(more));
    }
  }
  return all;
}

void add_rows(const Compared& all, const std::string& luminaire, const std::string& look,
              std::vector<FigureRow>& rows) {
  const double none = std::nan("");
  constexpr const char* quantity = "relative RMSE in equal time, %";
  ErrorAtTime better{HUGE_VAL, ""};
  for (std::size_t m = 0; m < 2; ++m) {
    const ErrorAtTime error = error_at(all.parts[m], all.mis.time_ms);
    if (error.rel_rmse < better.rel_rmse) better = error;
    rows.push_back({"mis", luminaire, look + ": " + std::string(to_string(compared[m])) + error.beyond, quantity,
                    100 * error.rel_rmse, none});
  }
  rows.push_back({"mis", luminaire, look + ": mis", quantity, 100 * all.mis.rel_rmse, none});
  rows.push_back({"mis", luminaire, look + ": mis over the better part" + better.beyond, "ratio of relative RMSE",
                  all.mis.rel_rmse / better.rel_rmse, none});
}

}  // namespace

Result<std::vector<FigureRow>> mis_figures(StudyCamera& camera, const StudyLuminaire& luminaire,
                                           const std::filesystem::path& cache, bool quick,
                                           const StudyProgress& progress) {
  const LightField& light_field = luminaire.light_field;
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
    const auto told = [&] {
      return progress(static_cast<double>(k) / static_cast<double>(2 * roughnesses.size()),
                      luminaire.name + ", mis, " + look);
    };
    const auto compared_at = compare({made[0].get(), made[1].get(), made[2].get()}, *at, told);
    if (!compared_at) return tl::unexpected(compared_at.error());
    add_rows(*compared_at, luminaire.name, look, rows);
  }
  return rows;
}

}  // namespace lumifield
