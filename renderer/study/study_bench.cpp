#include "renderer/study/study_bench.h"

#include <cmath>

#include "luminaire/median.h"
#include "renderer/methods/host_evaluation.h"
#include "renderer/study/lab.h"
#include "renderer/study/reference_cache.h"
#include "renderer/study/relative_rmse.h"

namespace lumifield {

namespace {

constexpr int timed_width = 256, timed_height = 192, small_width = 160, small_height = 120;
constexpr std::uint32_t strata_seed = 7;

}  // namespace

Result<double> timed_evaluation(DeviceMethod& method, const StudyFrame& frame, int repeats, StudyLight& light) {
  std::vector<double> times;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (const Status set = method.set_receivers(frame.receivers, frame.appearance); !set)
      return tl::unexpected(set.error());
    if (const auto done = method.evaluate(HUGE_VAL); !done) return tl::unexpected(done.error());
    times.push_back(method.kernel_s());
  }
  if (const Status read = method.read(light.irradiance); !read) return tl::unexpected(read.error());
  if (const Status read = method.read_gloss(light.gloss); !read) return tl::unexpected(read.error());
  return median_of(std::move(times));
}

Result<std::unique_ptr<StudyBench>> StudyBench::create(StudyCamera& camera, const StudyLuminaire& luminaire,
                                                       const std::filesystem::path& cache, const StudyLook& look) {
  std::unique_ptr<StudyBench> bench(new StudyBench);
  bench->luminaire_ = &luminaire;
  bench->look_ = look;
  bench->name_ = luminaire.name + (look.plain() ? "" : ", ") + look.name();
  for (const auto& [frame, width, height] :
       {std::tuple(&bench->timed_, timed_width, timed_height), std::tuple(&bench->small_, small_width, small_height)}) {
    auto drawn = camera.frame(width, height, luminaire.light_field, look);
    if (!drawn) return tl::unexpected(drawn.error());
    *frame = std::move(*drawn);
  }
  if (const Status made = bench->make_references(cache); !made) return tl::unexpected(made.error());
  return bench;
}

Status StudyBench::make_references(const std::filesystem::path& cache) {
  chosen_ = stratified_receivers(timed_, strata_seed);
  if (chosen_.empty()) return fail("no surface beyond S is seen", "the scene", "turn the camera or the luminaire");
  const auto light =
      cached_reference(luminaire_->light_field, timed_.receivers_at(chosen_), timed_.appearance_at(chosen_), cache);
  if (!light) return tl::unexpected(light.error());
  const auto gloss = light->begin() + static_cast<std::ptrdiff_t>(chosen_.size() * channels());
  const StudyLight truth{{light->begin(), gloss}, {gloss, light->end()}};
  for (std::size_t k = 0; k < chosen_.size(); ++k)
    for (const double value : timed_.seen(truth, k, chosen_[k], channels())) reference_.push_back(value);

  auto exact = make({});
  if (!exact) return tl::unexpected(exact.error());
  StudyLight small;
  if (const auto ran = timed_evaluation(**exact, small_, 1, small); !ran) return tl::unexpected(ran.error());
  const Picture picture = small_.picture(small, channels());
  white_ = average_luminance(picture);
  if (!(white_ > 0)) return fail("the luminaire lights nothing that is seen", luminaire_->name, "turn it");
  small_reference_ = tone_map(picture, {1, white_});
  return {};
}

Result<std::unique_ptr<DeviceMethod>> StudyBench::make(const MethodSettings& settings) const {
  auto method = make_device_method(luminaire_->light_field.geometry(), settings);
  if (!method) return method;
  if (const Status set = (*method)->set_cells(luminaire_->light_field); !set) return tl::unexpected(set.error());
  return method;
}

double StudyBench::rel_rmse(const StudyLight& light) const {
  RelativeRmse error;
  auto reference = reference_.begin();
  for (const std::size_t k : chosen_)
    for (const double value : timed_.seen(light, k, k, channels())) error.add(value, *reference++);
  return error.value();
}

Picture8 StudyBench::tone_mapped(const StudyLight& small) const {
  return tone_map(small_.picture(small, channels()), {1, white_});
}

Result<StudyPoint> StudyBench::judge(DeviceMethod& method, int repeats) const {
  StudyPoint point{
      .luminaire = name_, .device = method.device_name(), .width_px = timed_width, .height_px = timed_height};
  StudyLight light;
  const auto took = timed_evaluation(method, timed_, repeats, light);
  if (!took) return tl::unexpected(took.error());
  point.time_ms = 1e3 * *took;
  point.rel_rmse = rel_rmse(light);
  if (const auto ran = timed_evaluation(method, small_, 1, light); !ran) return tl::unexpected(ran.error());
  point.lab_delta_e = mean_lab_delta_e(tone_mapped(light), small_reference_);
  return point;
}

Result<Picture8> StudyBench::small_picture(const MethodSettings& settings) const {
  HostEvaluation form(luminaire_->light_field.geometry(), settings);
  if (const Status set = form.set_cells(luminaire_->light_field); !set) return tl::unexpected(set.error());
  StudyLight light;
  if (const auto ran = timed_evaluation(form, small_, 1, light); !ran) return tl::unexpected(ran.error());
  return tone_mapped(light);
}

}  // namespace lumifield
