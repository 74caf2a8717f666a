// Kernel time and error of the sampling methods beside the closed form, and what the steps of position-dependent
// sampling take. Not a test: run it alone on the machine.
//
//   methods_benchmark [width height]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "renderer/methods/image_sampler_device.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {
namespace {

/// A wavy floor of receivers in front of the lamp, as a picture sees it.
std::vector<Receiver> wavy_floor(int width, int height, double distance_mm) {
  std::vector<Receiver> receivers;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double x = (i + 0.5) / width - 0.5, y = (j + 0.5) / height - 0.5;
      receivers.push_back(
          {{1.2 * distance_mm * x, distance_mm * y, distance_mm * (1 + 0.08 * std::sin(20 * x) * std::cos(15 * y))},
           Vec3(0.2 * std::cos(20 * x), 0.2 * std::sin(15 * y), -1).normalized()});
    }
  return receivers;
}

double processor_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Run {
  double kernel_s = HUGE_VAL, processor_s = HUGE_VAL;
  std::vector<double> e;
};
Run run(DeviceMethod& method, const LightField& field, const std::vector<Receiver>& receivers, double samples) {
  Run best;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const bool set = method.set_cells(field) && method.set_samples(samples, 1) && method.set_receivers(receivers);
    const double before = lumifield::processor_s();
    if (!set || !method.evaluate(HUGE_VAL) || !method.read(best.e)) std::exit(1);
    best.processor_s = std::min(best.processor_s, lumifield::processor_s() - before);
    best.kernel_s = std::min(best.kernel_s, method.kernel_s());
  }
  return best;
}

double relative_rmse(const std::vector<double>& e, const std::vector<double>& reference) {
  double squares = 0, mean = 0;
  for (std::size_t k = 0; k < e.size(); ++k) {
    squares += (e[k] - reference[k]) * (e[k] - reference[k]);
    mean += reference[k];
  }
  const auto n = static_cast<double>(e.size());
  return std::sqrt(squares / n) / (mean / n);
}

void measure(const SyntheticLuminaire& synthetic, int width, int height) {
  const LightField field = make_luminaire(synthetic);
  const std::vector<Receiver> receivers = wavy_floor(width, height, 3.5 * synthetic.separation_mm);
  auto exact = make_device_method(field.geometry(), {}).value();
  const Run reference = run(*exact, field, receivers, 1);
  std::printf("%s, %dx%d receivers, %s\n", std::string(synthetic.name).c_str(), width, height,
              exact->device_name().c_str());
  std::printf("  closed-form: kernel %.0f ms, processor %.0f ms\n", 1e3 * reference.kernel_s,
              1e3 * reference.processor_s);
  for (const double samples : {50.0, 200.0, 1000.0}) {
    const auto line = [&](const char* what, Result<std::unique_ptr<ImageSamplerDevice>> device) {
      const Run r = run(**device, field, receivers, samples);
      std::printf("  %-28s K = %4.0f: kernel %6.0f ms, processor %6.0f ms, %5.1f ns a sample, relative RMSE %.2f %%\n",
                  what, samples, 1e3 * r.kernel_s, 1e3 * r.processor_s,
                  1e9 * r.kernel_s / (samples * static_cast<double>(receivers.size())),
                  100 * relative_rmse(r.e, reference.e));
    };
    const LuminaireGeometry& g = field.geometry();
    const MethodSettings corrected{.method = Method::position_dependent};
    line("position-dependent", ImageSamplerDevice::create(g, corrected));
    line("  its balance", ImageSamplerDevice::create(g, corrected, SamplingSteps::balance));
    line("  and its draws", ImageSamplerDevice::create(g, corrected, SamplingSteps::draws));
    line("  with scalar searches", ImageSamplerDevice::create(g, corrected, SamplingSteps::all, true));
    line("position-dependent-printed", ImageSamplerDevice::create(g, {.method = Method::position_dependent_printed}));
    line("uniform-box", ImageSamplerDevice::create(g, {.method = Method::uniform_box}));
  }
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  const int width = argc > 1 ? std::atoi(argv[1]) : 256, height = argc > 2 ? std::atoi(argv[2]) : 192;
  for (const lumifield::SyntheticLuminaire& each : lumifield::table_1_luminaires())
    lumifield::measure(each, width, height);
}
