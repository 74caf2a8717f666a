#include "renderer/study/mis_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>

#include "luminaire/median.h"
#include "renderer/study/ladder.h"
#include "renderer/study/ladder_rows.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/relative_rmse.h"

namespace lumifield {

namespace {

constexpr int width = 256, height = 192, scored_receivers = 1024, timed_receivers = 8192, seeds = 6;
constexpr std::uint32_t strata_seed = 7;
constexpr std::array compared{Method::position_dependent, Method::filtered_brdf, Method::mis};

/// Some receivers of a frame with their reference, and more of them to tell the time by: PoCL's second thread may wake
/// milliseconds late, which is half the time of 1,024.
struct Scored {
  StudyFrame frame;  ///< of them alone, pixel by pixel as they are numbered
  StudyFrame timed;
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

/// Every eye where it sees a point of the lamp, or beside it by a tenth, mirrored: from pixel to pixel a little
/// further, as by a curved mirror, with `images` of the lamp each way in the frame.
void mirror(const Sampling& sampling, StudyFrame& frame) {
  constexpr double images = 3;
  const Vec2 size = 1.2 * sampling.spacing_mm.cwiseProduct(Vec2(sampling.columns, sampling.rows));
  for (std::size_t k = 0; k < frame.receivers.size(); ++k) {
    const Receiver& r = frame.receivers[k];
    const Vec2 place(static_cast<double>(k % width) / width, static_cast<double>(k / width) / height);
    const Vec2 share = (images * place).array() - (images * place).array().floor() - 0.5;
    const Vec2 at = sampling.center_mm + size.cwiseProduct(share);
    const Vec3 to = (Vec3(at.x(), at.y(), 0) - r.p_mm).normalized(), eye = 2 * r.n.dot(to) * r.n - to;
    GlossLobe& lobe = frame.appearance.gloss[k];
    lobe.eye_x = static_cast<float>(eye.x());
    lobe.eye_y = static_cast<float>(eye.y());
    lobe.eye_z = static_cast<float>(eye.z());
  }
}

/// Of a frame so many receivers at most, evenly, each a pixel.
StudyFrame part_of(const StudyFrame& all, std::vector<std::size_t> chosen, std::size_t most) {
  const std::size_t step = (chosen.size() + most - 1) / most;
  for (std::size_t k = 0; k * step < chosen.size(); ++k) chosen[k] = chosen[k * step];
  chosen.resize((chosen.size() + step - 1) / step);
  StudyFrame part;
  part.materials = all.materials;
  part.receivers = all.receivers_at(chosen);
  part.appearance = all.appearance_at(chosen);
  for (const std::size_t pixel : chosen)
    for (std::size_t c = 0; c < 4; ++c) {
      part.gbuffer.normal.push_back(all.gbuffer.normal[4 * pixel + c]);
      if (!all.gbuffer.reflectance.empty()) part.gbuffer.reflectance.push_back(all.gbuffer.reflectance[4 * pixel + c]);
    }
  return part;
}

std::vector<std::size_t> lit_receivers(const StudyFrame& frame) {
  std::vector<std::size_t> lit;
  for (std::size_t k = 0; k < frame.receivers.size(); ++k)
    if (frame.receivers[k].n != Vec3(0, 0, 0)) lit.push_back(k);
  return lit;
}

Result<Scored> scored(StudyCamera& camera, const LightField& light_field, double roughness, bool mirrored,
                      const std::filesystem::path& cache) {
  auto all = camera.frame(width, height, light_field, {.roughness = roughness});
  if (!all) return tl::unexpected(all.error());
  if (mirrored) mirror(light_field.geometry().sampling, *all);
  const std::vector<std::size_t> chosen = stratified_receivers(*all, strata_seed);
  if (chosen.empty()) return fail("no surface beyond S is seen", "the scene", "turn the camera or the luminaire");
  Scored some{part_of(*all, chosen, scored_receivers),
              part_of(*all, lit_receivers(*all), timed_receivers),
              {},
              light_field.geometry().channels.size()};
  const auto light = cached_reference(light_field, some.frame.receivers, some.frame.appearance, cache);
  if (!light) return tl::unexpected(light.error());
  const auto gloss = light->begin() + static_cast<std::ptrdiff_t>(some.frame.receivers.size() * some.channels);
  const StudyLight truth{{light->begin(), gloss}, {gloss, light->end()}};
  for (std::size_t k = 0; k < some.frame.receivers.size(); ++k)
    for (const double value : some.frame.seen(truth, k, k, some.channels)) some.reference.push_back(value);
  if (!(some.mean() > 0)) return fail("the luminaire lights nothing that is seen", "the scene", "turn it");
  return some;
}

/// A method with the luminaire's cells, at one K.
struct Point {
  DeviceMethod* method;
  double samples;
};
using Told = std::function<bool()>;

Status light_of(const Point& point, int seed, const StudyFrame& frame, StudyLight& light, double& s) {
  if (const Status set = point.method->set_samples(point.samples, static_cast<std::uint32_t>(seed)); !set) return set;
  const auto took = timed_evaluation(*point.method, frame, 1, light);
  if (!took) return tl::unexpected(took.error());
  s = *took;
  return {};
}

/// Its error over all seeds; its time is `times_ms`'s.
Result<StudyPoint> scored_point(const Point& point, const Scored& scored, const Told& told) {
  RelativeRmse error;
  StudyLight light;
  double s = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    if (!told()) return study_stopped();
    if (const Status done = light_of(point, seed, scored.frame, light, s); !done) return tl::unexpected(done.error());
    scored.judge(light, error);
  }
  StudyPoint as;
  as.cost = point.samples;
  as.rel_rmse = error.value();
  return as;
}

/// The times of points, ms, by that of the last of them: a machine's speed drifts by a third within seconds, so all
/// take turns, for `least_s` or five rounds, and count by the median of their ratios to the last one's.
Result<std::vector<double>> times_ms(std::span<const Point> points, const Scored& scored, const Told& told) {
  constexpr double least_s = 8;
  constexpr std::size_t least_rounds = 5;
  std::vector<std::vector<double>> ratios(points.size());
  std::vector<double> last;
  StudyLight light;
  for (double total = 0; last.size() < least_rounds || total < least_s;) {
    std::vector<double> took;
    for (const Point& point : points) {
      double& s = took.emplace_back();
      if (!told()) return study_stopped();
      if (const Status done = light_of(point, 1, scored.timed, light, s); !done) return tl::unexpected(done.error());
      total += s;
    }
    for (std::size_t k = 0; k < took.size(); ++k) ratios[k].push_back(took[k] / took.back());
    last.push_back(took.back());
  }
  std::vector<double> times;
  for (const std::vector<double>& each : ratios) times.push_back(1e3 * median_of(last) * median_of(each));
  return times;
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
  const Point mis{methods[2], usual};
  points.push_back(mis);
  std::vector<StudyPoint> ran;
  for (const Point& point : points) {
    const auto as = scored_point(point, scored, told);
    if (!as) return tl::unexpected(as.error());
    ran.push_back(*as);
  }
  const auto times = times_ms(points, scored, told);
  if (!times) return tl::unexpected(times.error());
  for (std::size_t k = 0; k < ran.size(); ++k) ran[k].time_ms = (*times)[k];
  Compared all{ran.back(), {}};
  for (std::size_t m = 0; m < 2; ++m) {
    const auto first = ran.begin() + static_cast<std::ptrdiff_t>(rungs.size() * m);
    std::vector<StudyPoint>& ladder = all.parts[m];
    ladder.assign(first, first + rungs.size());
    while (const auto samples = next_cost(ladder, all.mis.time_ms, 1, most)) {
      const Point more{methods[m], *samples};
      auto as = scored_point(more, scored, told);
      if (!as) return tl::unexpected(as.error());
      const auto beside = times_ms(std::array{more, mis}, scored, told);
      if (!beside) return tl::unexpected(beside.error());
      as->time_ms = beside->front() * all.mis.time_ms / beside->back();
      ladder.push_back(std::move(*as));
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
