// Time of the closed form: one cell against all 63, and levels of detail against exact with their error on a smooth
// luminaire, one and three channels; the multiply-adds of the pixels seen, as a share of what a core can do. Not a
// test: run it alone on the machine.
//
//   closed_form_benchmark [width height [repeats]]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <vector>

#include "renderer/methods/axis_weights.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/image_levels.h"

namespace lumifield {
namespace {

/// Nine by seven cells of 300×300 pixels of 1 mm, spacing 7.5 mm, planes 150 mm apart.
LuminaireGeometry bike_light(std::vector<std::string> channels) {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}};
  g.measurement = {300, 300, {1, 1}, {0, 0}};
  g.channels = std::move(channels);
  return g;
}

/// A wavy floor of receivers in front of the lamp, as a picture sees it.
std::vector<Receiver> wavy_floor(int width, int height) {
  std::vector<Receiver> receivers;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const double x = (i + 0.5) / width - 0.5, y = (j + 0.5) / height - 0.5;
      receivers.push_back({{600 * x, 500 * y, 500 + 40 * std::sin(20 * x) * std::cos(15 * y)},
                           Vec3(0.2 * std::cos(20 * x), 0.2 * std::sin(15 * y), -1).normalized()});
    }
  return receivers;
}

/// Every cell's image is the sum of 60 round blobs of 2 to 15 pixels, seeded.
std::vector<CellImage> smooth_images(const LuminaireGeometry& geometry) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 300), width(2, 15), height(0, 1);
  const int channels = static_cast<int>(geometry.channels.size());
  std::vector<CellImage> images;
  for (int flat = 0; flat < geometry.sampling.cells(); ++flat) {
    CellImage image{300, 300, channels, std::vector<float>(90000 * static_cast<std::size_t>(channels)), {}, {}};
    for (int blob = 0; blob < 60; ++blob) {
      const double x = place(random), y = place(random), w = width(random), h = height(random);
      std::vector<double> across, down;  // a Gaussian is a product
      for (int i = 0; i < 300; ++i) {
        across.push_back(std::exp(-0.5 * std::pow((i + 0.5 - x) / w, 2)));
        down.push_back(h * std::exp(-0.5 * std::pow((i + 0.5 - y) / w, 2)));
      }
      for (std::size_t k = 0; k < image.value.size(); ++k)
        image.value[k] += static_cast<float>(across[k % 300] * down[k / 300 % 300]);
    }
    images.push_back(std::move(image));
  }
  return images;
}

/// A luminaire's cells on the device.
struct Bench {
  std::unique_ptr<ClosedFormDevice> device;
  std::vector<CellIndex> indices;
  std::vector<CellImage> images;
  std::vector<const CellImage*> pointers;
};

/// Processor time of the whole process, all threads: on a CPU device the kernel's, which other programs disturb less.
double processor_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

#if defined(__x86_64__)
/// Float multiply-adds per second of this core: twelve vectors of N, each waiting for itself only.
#define MULTIPLY_ADDS(NAME, TARGET, N)                                                                      \
  __attribute__((target(TARGET))) double NAME() {                                                           \
    typedef float Vector __attribute__((vector_size(4 * N)));                                               \
    constexpr int vectors = 12, rounds = 10'000'000;                                                        \
    Vector sum[vectors], factor, term;                                                                      \
    for (int i = 0; i < N; ++i) factor[i] = 0.999f, term[i] = 1e-3f;                                        \
    _Pragma("GCC unroll 12") for (int i = 0; i < vectors; ++i) asm volatile("" : "=v"(sum[i]) : "0"(term)); \
    const double begin = processor_s();                                                                     \
    for (int k = 0; k < rounds; ++k) {                                                                      \
      _Pragma("GCC unroll 12") for (int i = 0; i < vectors; ++i) sum[i] = sum[i] * factor + term;           \
    }                                                                                                       \
    const double seconds = processor_s() - begin;                                                           \
    _Pragma("GCC unroll 12") for (int i = 0; i < vectors; ++i) asm volatile("" : : "v"(sum[i]));            \
    return double(N) * vectors * rounds / seconds;                                                          \
  }
MULTIPLY_ADDS(multiply_adds_of_16, "avx512f", 16)
MULTIPLY_ADDS(multiply_adds_of_8, "avx2,fma", 8)
#undef MULTIPLY_ADDS

double peak_multiply_adds() {
  if (__builtin_cpu_supports("avx512f")) return std::max(multiply_adds_of_16(), multiply_adds_of_16());
  return __builtin_cpu_supports("fma") ? std::max(multiply_adds_of_8(), multiply_adds_of_8()) : NAN;
}
#else
double peak_multiply_adds() { return NAN; }
#endif

/// Pixels that one axis of all cells of a row or column shows, at a level of detail.
double pixels_seen(const LuminaireGeometry& g, const Receiver& receiver, int axis, int level) {
  const ReceiverAxis at{g.planes.separation_mm, receiver.p_mm.z(), receiver.p_mm[axis]};
  const double times = std::ldexp(1.0, level);
  const int width = axis == 0 ? g.measurement.width_px : g.measurement.height_px;
  double pixels = 0;
  for (int k = 0; k < (axis == 0 ? g.sampling.columns : g.sampling.rows); ++k) {
    const double u = g.sampling.cell_center_mm(axis == 0 ? CellIndex{0, k} : CellIndex{k, 0})[axis];
    const AxisWeights weights =
        axis_weights(Basis(g.sampling.basis), at,
                     {u, g.sampling.spacing_mm[axis], g.measurement.corner_mm()[axis],
                      g.measurement.pixel_mm[axis] * times, static_cast<int>(std::ceil(width / times))});
    for (const AxisWeights::Pixel& pixel : weights.pixels) pixels += pixel.w0 > 0;
  }
  return pixels;
}

/// Multiply-adds of the sums over pixels, two for each and channel, estimated from every 101st receiver.
double multiply_adds(const LuminaireGeometry& g, const std::vector<Receiver>& receivers, double lod) {
  const double spacing_px = g.sampling.spacing_mm.cwiseQuotient(g.measurement.pixel_mm).maxCoeff();
  double pixels = 0, counted = 0;
  for (std::size_t k = 0; k < receivers.size(); k += 101, ++counted) {
    const double height = receivers[k].p_mm.z(), r = (height - g.planes.separation_mm) / height;
    const double span = std::abs(r) * spacing_px * 2 * Basis(g.sampling.basis).half_support();
    const int level = level_of_detail(lod, span, coarsest_level(g.measurement.width_px, g.measurement.height_px));
    pixels += pixels_seen(g, receivers[k], 0, level) * pixels_seen(g, receivers[k], 1, level);
  }
  return 2 * static_cast<double>(g.channels.size()) * pixels * static_cast<double>(receivers.size()) / counted;
}

/// The least of the repeats, which other work disturbs least.
struct Least {
  double kernel_s = HUGE_VAL, wall_s = HUGE_VAL, cpu_s = HUGE_VAL;

  template <class Add>
  bool time(const ClosedFormDevice& device, const Add& add) {
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_begin = processor_s();
    if (!add()) return false;
    wall_s = std::min(wall_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    cpu_s = std::min(cpu_s, processor_s() - cpu_begin);
    kernel_s = std::min(kernel_s, device.last_kernel_s());
    return true;
  }
};

struct Detail {
  double lod = 0;
  Least one, all;
  std::vector<double> irradiance;
};

/// Level after level in each repeat, so that other work disturbs all alike; a first round pays for compilation.
bool measure(Bench& bench, const std::vector<Receiver>& receivers, int repeats, std::vector<Detail>& details) {
  ClosedFormDevice& device = *bench.device;
  for (int k = 0; k <= repeats; ++k)
    for (Detail& detail : details) {
      if (k == 1) detail.one = detail.all = {};
      if (!device.set_lod(detail.lod) || !device.set_receivers(receivers)) return false;
      if (!detail.all.time(device, [&] { return device.add_cells(bench.indices, bench.pointers).has_value(); }) ||
          !device.read(detail.irradiance))
        return false;
      for (int again = 0; again < 8; ++again)
        if (!detail.one.time(device, [&] { return device.add_cell(bench.indices[31], bench.images[31]).has_value(); }))
          return false;
    }
  return true;
}

/// RMS of the error over the mean of the reference.
double relative_rmse(const std::vector<double>& values, const std::vector<double>& reference) {
  double squares = 0, mean = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += (values[k] - reference[k]) * (values[k] - reference[k]);
    mean += reference[k];
  }
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count) / (mean / count);
}

bool report(int width, int height, int repeats, std::vector<std::string> channels) {
  const LuminaireGeometry geometry = bike_light(std::move(channels));
  const auto begin = std::chrono::steady_clock::now();
  auto device = ClosedFormDevice::create(geometry);
  const std::chrono::duration<double> start_up = std::chrono::steady_clock::now() - begin;
  if (!device) {
    std::fprintf(stderr, "%s\n", device.error().message().c_str());
    return false;
  }
  Bench bench{std::move(*device), {}, smooth_images(geometry), {}};
  for (int flat = 0; flat < geometry.sampling.cells(); ++flat) bench.indices.push_back(geometry.sampling.index(flat));
  for (const CellImage& image : bench.images) bench.pointers.push_back(&image);
  std::printf("%s, %dx%d receivers, %d channel(s), start %.2f s\n", bench.device->device_name().c_str(), width, height,
              static_cast<int>(geometry.channels.size()), start_up.count());

  std::vector<Detail> details{{0, {}, {}, {}}, {8, {}, {}, {}}, {4, {}, {}, {}}};
  const std::vector<Receiver> receivers = wavy_floor(width, height);
  if (!measure(bench, receivers, repeats, details)) return false;
  const double peak = peak_multiply_adds();
  const Detail& exact = details.front();
  for (const Detail& detail : details) {
    std::printf("  %s: one cell %.1f ms (with upload %.1f), 63 cells %.0f ms, ratio 1/%.1f, in processor time 1/%.1f\n",
                detail.lod == 0   ? "exact"
                : detail.lod == 8 ? "T = 8"
                                  : "T = 4",
                1e3 * detail.one.kernel_s, 1e3 * detail.one.wall_s, 1e3 * detail.all.kernel_s,
                detail.all.kernel_s / detail.one.kernel_s, detail.all.cpu_s / detail.one.cpu_s);
    const double done = multiply_adds(geometry, receivers, detail.lod);
    std::printf("         processor time %.0f ms, one cell %.1f ms; %.1f G multiply-adds of %.0f G/s a core: %.0f %%\n",
                1e3 * detail.all.cpu_s, 1e3 * detail.one.cpu_s, 1e-9 * done, 1e-9 * peak,
                100 * done / (peak * detail.all.cpu_s));
    if (detail.lod > 0)
      std::printf("         63 cells %.2f of exact, in processor time %.2f; relative RMSE %.2f %%\n",
                  detail.all.kernel_s / exact.all.kernel_s, detail.all.cpu_s / exact.all.cpu_s,
                  100 * relative_rmse(detail.irradiance, exact.irradiance));
  }
  return true;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  const int width = argc > 2 ? std::atoi(argv[1]) : 1024, height = argc > 2 ? std::atoi(argv[2]) : 768;
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
  if (width < 1 || height < 1 || repeats < 1) return 2;
  return lumifield::report(width, height, repeats, {"Y"}) && lumifield::report(width, height, repeats, {"R", "G", "B"})
             ? 0
             : 1;
}
