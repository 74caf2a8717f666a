#include "renderer/study/ladder.h"

namespace lumifield {

namespace {

struct Rungs {
  Method method;
  std::vector<double> quick, full;
  double confirm;  ///< cost at full size
};

std::vector<Rungs> ladder() {
  const std::vector<double> few{16, 50, 200, 1000};
  return {
      {Method::closed_form, {0, 8, 4, 2}, {0, 12, 8, 6, 4, 3, 2, 1}, 0},
      {Method::position_dependent, few, {16, 50, 100, 200, 400, 1000, 4000, 16000, 64000}, 200},
      {Method::position_dependent_printed, {16, 50, 200}, {16, 50, 100, 200, 400, 1000, 4000}, 200},
      {Method::uniform_box, few, {16, 50, 100, 200, 400, 1000, 4000, 16000, 64000}, 1000},
      {Method::precomputed_lights, {1000, 10000}, {1000, 10000, 63000, 250000}, 1000},
      {Method::far_field, {0}, {0}, 0},
  };
}

MethodSettings settings_of(Method method, double cost) {
  MethodSettings settings{.method = method};
  if (info(method).cost == MethodCost::pixels_per_support) settings.lod = cost;
  if (info(method).cost == MethodCost::samples || info(method).cost == MethodCost::lights) settings.samples = cost;
  return settings;
}

/// What takes long is repeated less.
int repeats_for(double first_s) { return first_s < 0.5 ? 7 : 3; }

std::string words(Method method, const StudyBench& bench, double cost) {
  std::string text = bench.luminaire().name + ", " + std::string(to_string(method));
  if (cost > 0) text += " " + std::to_string(static_cast<int>(cost));
  return text;
}

}  // namespace

tl::unexpected<Error> study_stopped() {
  return tl::unexpected<Error>(Error{"stopped", "study", "run it again", ErrorKind::stopped});
}

Result<std::vector<StudyPoint>> climb_ladder(const StudyBench& bench, bool quick, const StudyProgress& progress) {
  std::vector<StudyPoint> points;
  const std::vector<Rungs> all = ladder();
  double done = 0, rungs = 0;
  for (const Rungs& each : all) rungs += static_cast<double>((quick ? each.quick : each.full).size());
  for (const Rungs& each : all) {
    std::unique_ptr<DeviceMethod> method;
    for (const double cost : quick ? each.quick : each.full) {
      if (!progress(done++ / rungs, words(each.method, bench, cost))) return study_stopped();
      const MethodSettings settings = settings_of(each.method, cost);
      if (!method || each.method == Method::closed_form) {
        auto made = bench.make(settings);
        if (!made) return tl::unexpected(made.error());
        method = std::move(*made);
      }
      if (Status set = method->set_samples(settings.samples, settings.seed); !set) return tl::unexpected(set.error());
      // The first evaluation compiles the kernel and tells how often it can be repeated.
      std::vector<double> e;
      const auto first = timed_evaluation(*method, bench.frame().receivers, 1, e);
      if (!first) return tl::unexpected(first.error());
      auto point = bench.judge(*method, repeats_for(*first));
      if (!point) return tl::unexpected(point.error());
      point->method = each.method;
      point->cost = cost;
      points.push_back(std::move(*point));
    }
  }
  return points;
}

Result<std::vector<StudyPoint>> confirm_at_full_size(const StudyBench& bench, StudyCamera& camera, bool quick,
                                                     const StudyProgress& progress) {
  constexpr int width = 1024, height = 768;
  const auto frame = camera.frame(width, height, bench.luminaire().light_field.geometry().planes.separation_mm);
  if (!frame) return tl::unexpected(frame.error());
  std::vector<StudyPoint> points;
  const std::vector<Rungs> all = ladder();
  for (const Rungs& each : all) {
    if (!progress(static_cast<double>(points.size()) / static_cast<double>(all.size()),
                  words(each.method, bench, each.confirm) + " at 1024x768"))
      return study_stopped();
    auto method = bench.make(settings_of(each.method, each.confirm));
    if (!method) return tl::unexpected(method.error());
    auto point = bench.judge(**method, 1);
    if (!point) return tl::unexpected(point.error());
    std::vector<double> e;
    const auto took = timed_evaluation(**method, frame->receivers, quick ? 1 : 3, e);
    if (!took) return tl::unexpected(took.error());
    point->method = each.method;
    point->cost = each.confirm;
    point->time_ms = 1e3 * *took;
    point->width_px = width;
    point->height_px = height;
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace lumifield
