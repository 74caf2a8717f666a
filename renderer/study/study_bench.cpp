#include "renderer/study/study_bench.h"

#include <algorithm>
#include <cmath>

#include "renderer/study/lab.h"
#include "renderer/study/reference_cache.h"

namespace lumifield {

namespace {

constexpr int timed_width = 256, timed_height = 192, small_width = 160, small_height = 120;
constexpr std::uint32_t strata_seed = 7;

}  // namespace

Result<double> timed_evaluation(DeviceMethod& method, const std::vector<Receiver>& receivers, int repeats,
                                std::vector<double>& irradiance) {
  std::vector<double> times;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    if (const Status set = method.set_receivers(receivers); !set) return tl::unexpected(set.error());
    if (const auto done = method.evaluate(HUGE_VAL); !done) return tl::unexpected(done.error());
    times.push_back(method.kernel_s());
  }
  if (const Status read = method.read(irradiance); !read) return tl::unexpected(read.error());
  std::ranges::nth_element(times, times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2));
  return times[times.size() / 2];
}

Result<std::unique_ptr<StudyBench>> StudyBench::create(StudyCamera& camera, const StudyLuminaire& luminaire,
                                                       const std::filesystem::path& cache) {
  const LuminaireGeometry& g = luminaire.light_field.geometry();
  std::unique_ptr<StudyBench> bench(new StudyBench);
  bench->luminaire_ = &luminaire;
  for (const auto& [frame, width, height] :
       {std::tuple(&bench->timed_, timed_width, timed_height), std::tuple(&bench->small_, small_width, small_height)}) {
    auto drawn = camera.frame(width, height, g.planes.separation_mm);
    if (!drawn) return tl::unexpected(drawn.error());
    *frame = std::move(*drawn);
  }
  bench->chosen_ = stratified_receivers(bench->timed_, strata_seed);
  std::vector<Receiver> receivers;
  for (const std::size_t k : bench->chosen_) receivers.push_back(bench->timed_.receivers[k]);
  if (receivers.empty()) return fail("no surface beyond S is seen", "the scene", "turn the camera or the luminaire");
  bench->reference_ = cached_reference(luminaire.light_field, receivers, cache);

  auto exact = bench->make({});
  if (!exact) return tl::unexpected(exact.error());
  std::vector<double> e;
  if (const auto ran = timed_evaluation(**exact, bench->small_.receivers, 1, e); !ran)
    return tl::unexpected(ran.error());
  const Picture picture = bench->small_.picture(e, g.channels.size());
  bench->white_ = average_luminance(picture);
  if (!(bench->white_ > 0)) return fail("the luminaire lights nothing that is seen", luminaire.name, "turn it");
  bench->small_reference_ = tone_map(picture, {1, bench->white_});
  return bench;
}

Result<std::unique_ptr<DeviceMethod>> StudyBench::make(const MethodSettings& settings) const {
  auto method = make_device_method(luminaire_->light_field.geometry(), settings);
  if (!method) return method;
  if (const Status set = (*method)->set_cells(luminaire_->light_field); !set) return tl::unexpected(set.error());
  return method;
}

double StudyBench::rel_rmse(const std::vector<double>& at_receivers) const {
  double squares = 0, sum = 0;
  for (std::size_t k = 0; k < reference_.size(); ++k) {
    const double off = at_receivers[k] - reference_[k];
    squares += off * off;
    sum += reference_[k];
  }
  const auto n = static_cast<double>(reference_.size());
  return std::sqrt(squares / n) / (sum / n);
}

Picture8 StudyBench::tone_mapped(const std::vector<double>& small_irradiance) const {
  const std::size_t channels = luminaire_->light_field.geometry().channels.size();
  return tone_map(small_.picture(small_irradiance, channels), {1, white_});
}

Result<StudyPoint> StudyBench::judge(DeviceMethod& method, int repeats) const {
  StudyPoint point{.luminaire = luminaire_->name,
                   .device = method.device_name(),
                   .width_px = timed_width,
                   .height_px = timed_height};
  std::vector<double> e, chosen;
  const auto took = timed_evaluation(method, timed_.receivers, repeats, e);
  if (!took) return tl::unexpected(took.error());
  point.time_ms = 1e3 * *took;
  const std::size_t channels = luminaire_->light_field.geometry().channels.size();
  for (const std::size_t k : chosen_)
    for (std::size_t c = 0; c < channels; ++c) chosen.push_back(e[k * channels + c]);
  point.rel_rmse = rel_rmse(chosen);
  if (const auto ran = timed_evaluation(method, small_.receivers, 1, e); !ran) return tl::unexpected(ran.error());
  point.lab_delta_e = mean_lab_delta_e(tone_mapped(e), small_reference_);
  return point;
}

Result<Picture8> StudyBench::small_picture(const HostMethod& method) const {
  const std::size_t channels = luminaire_->light_field.geometry().channels.size();
  std::vector<double> irradiance(small_.receivers.size() * channels, 0.0);
  for (std::size_t k = 0; k < small_.receivers.size(); ++k) {
    if (small_.receivers[k].n == Vec3(0, 0, 0)) continue;
    const auto one = method.irradiance(small_.receivers[k], static_cast<std::uint32_t>(k));
    if (!one) return tl::unexpected(one.error());
    std::copy(one->begin(), one->end(), irradiance.begin() + static_cast<std::ptrdiff_t>(k * channels));
  }
  return tone_mapped(irradiance);
}

}  // namespace lumifield
