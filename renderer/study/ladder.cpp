#include "renderer/study/ladder.h"

#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

struct Rungs {
  Method method;
  std::vector<double> quick, full;
  double confirm;  ///< cost at full size
};

std::vector<Rungs> ladder(const StudyLook& look) {
  const std::vector<double> few{16, 50, 200, 1000};
  if (!look.plain())
    return {{Method::closed_form, {0, 8, 4}, {0, 12, 8, 6, 4, 2}, 0},
            {Method::position_dependent, few, {16, 50, 200, 1000, 4000}, 200}};
  return {
      {Method::closed_form, {0, 8, 4, 2}, {0, 12, 8, 6, 4, 3, 2, 1}, 0},
      {Method::position_dependent, few, {16, 50, 100, 200, 400, 1000, 4000, 16000, 64000}, 200},
      {Method::position_dependent_printed, {16, 50, 200}, {16, 50, 100, 200, 400, 1000, 4000}, 200},
      {Method::uniform_box, few, {16, 50, 100, 200, 400, 1000, 4000, 16000, 64000}, 1000},
      {Method::precomputed_lights, {1000, 10000}, {1000, 10000, 63000, 250000}, 1000},
      {Method::filtered_brdf, {16, 200}, {16, 50, 100, 200, 400, 1000, 4000}, 16},
      {Method::mis, {50, 200}, {16, 50, 100, 200, 400, 1000, 4000}, 50},
      {Method::far_field, {0}, {0}, 0},
      {Method::shift_invariant, {0}, {0}, 0},
  };
}

MethodSettings settings_of(Method method, double cost) {
  MethodSettings settings{.method = method};
  if (info(method).cost == MethodCost::pixels_per_support) settings.lod = cost;
  if (info(method).cost == MethodCost::samples || info(method).cost == MethodCost::lights) settings.samples = cost;
  return settings;
}

/// What takes long is repeated less.
int repeats_for(double first_s) { return first_s < 0.5 ? 7 : first_s < 5 ? 3 : 1; }

std::string words(Method method, const StudyBench& bench, double cost) {
  std::string text = bench.name() + ", " + std::string(to_string(method));
  if (cost > 0) text += " " + std::to_string(static_cast<int>(cost));
  return text;
}

/// What a method says of a luminaire and a frame: a point, or why there is none.
struct Answer {
  Result<StudyPoint> point;
  StabilityOutcome without = StabilityOutcome::refused;
};
Answer refused(const Error& error) { return {tl::unexpected(error), StabilityOutcome::refused}; }
Answer failed(const Error& error) { return {tl::unexpected(error), StabilityOutcome::failed}; }

/// One rung. `method` is that of the rung before, or null; levels of detail are methods of their own.
Answer step(const StudyBench& bench, const MethodSettings& settings, std::unique_ptr<DeviceMethod>& method) {
  if (!method || settings.method == Method::closed_form) {
    auto made = bench.make(settings);
    if (!made) return refused(made.error());
    method = std::move(*made);
    if (Status set = method->set_receivers(bench.frame().receivers, bench.frame().appearance); !set)
      return refused(set.error());
  }
  if (Status set = method->set_samples(settings.samples, settings.seed); !set) return refused(set.error());
  // The first evaluation compiles the kernel and tells how often it can be repeated.
  StudyLight light;
  const auto first = timed_evaluation(*method, bench.frame(), 1, light);
  if (!first) return failed(first.error());
  auto point = bench.judge(*method, repeats_for(*first));
  if (!point) return failed(point.error());
  return {std::move(point)};
}

Answer step_at_full_size(const StudyBench& bench, const MethodSettings& settings, const StudyFrame& frame,
                         int repeats) {
  auto method = bench.make(settings);
  if (!method) return refused(method.error());
  if (Status set = (*method)->set_receivers(frame.receivers, frame.appearance); !set) return refused(set.error());
  auto point = bench.judge(**method, 1);
  if (!point) return failed(point.error());
  StudyLight light;
  const auto took = timed_evaluation(**method, frame, repeats, light);
  if (!took) return failed(took.error());
  point->time_ms = 1e3 * *took;
  return {std::move(point)};
}

/// Why a method has no point.
StabilityRow row_without(const StudyBench& bench, Method method, const char* where, const Answer& answer) {
  return {method, "luminaire " + bench.name() + where, answer.without, std::nan(""), answer.point.error().message()};
}

}  // namespace

tl::unexpected<Error> study_stopped() {
  return tl::unexpected<Error>(Error{"stopped", "study", "run it again", ErrorKind::stopped});
}

bool Climb::is_without(Method method) const { return std::ranges::count(without, method, &StabilityRow::method) > 0; }

Result<Climb> climb_ladder(const StudyBench& bench, bool quick, const StudyProgress& progress) {
  Climb climb;
  const std::vector<Rungs> all = ladder(bench.look());
  double done = 0, rungs = 0;
  for (const Rungs& each : all) rungs += static_cast<double>((quick ? each.quick : each.full).size());
  for (const Rungs& each : all) {
    std::unique_ptr<DeviceMethod> method;
    for (const double cost : quick ? each.quick : each.full) {
      if (!progress(done++ / rungs, words(each.method, bench, cost))) return study_stopped();
      if (climb.is_without(each.method)) continue;
      Answer answer = step(bench, settings_of(each.method, cost), method);
      if (!answer.point && each.method == Method::closed_form) return tl::unexpected(answer.point.error());
      if (!answer.point) {
        climb.without.push_back(row_without(bench, each.method, "", answer));
        std::erase_if(climb.points, [&](const StudyPoint& p) { return p.method == each.method; });
        continue;
      }
      answer.point->method = each.method;
      answer.point->cost = cost;
      climb.points.push_back(std::move(*answer.point));
    }
  }
  return climb;
}

Status confirm_at_full_size(const StudyBench& bench, StudyCamera& camera, bool quick, const StudyProgress& progress,
                            Climb& climb) {
  constexpr int width = 1024, height = 768;
  const auto frame = camera.frame(width, height, bench.luminaire().light_field, bench.look());
  if (!frame) return tl::unexpected(frame.error());
  const std::vector<Rungs> all = ladder(bench.look());
  double done = 0;
  for (const Rungs& each : all) {
    if (!progress(done++ / static_cast<double>(all.size()), words(each.method, bench, each.confirm) + " at 1024x768"))
      return study_stopped();
    if (climb.is_without(each.method)) continue;
    Answer answer = step_at_full_size(bench, settings_of(each.method, each.confirm), *frame, quick ? 1 : 3);
    if (!answer.point) {
      climb.without.push_back(row_without(bench, each.method, " at 1024x768", answer));
      continue;
    }
    answer.point->method = each.method;
    answer.point->cost = each.confirm;
    answer.point->width_px = width;
    answer.point->height_px = height;
    climb.points.push_back(std::move(*answer.point));
  }
  return {};
}

}  // namespace lumifield
