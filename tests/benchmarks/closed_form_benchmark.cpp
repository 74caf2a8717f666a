// Kernel time of the closed form: one cell against all 63, and levels of detail against exact with their error on a
// smooth luminaire, one and three channels. Not a test: run it alone on the machine.
//
//   closed_form_benchmark [width height [repeats]]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "renderer/methods/closed_form.h"

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

/// Every cell's image is the sum of 60 round blobs, seeded: smooth, as a lamp's beam is.
std::vector<CellImage> smooth_images(const LuminaireGeometry& geometry) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 300), width(6, 40), height(0, 1);
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

struct Times {
  double one_s = HUGE_VAL, one_with_upload_s = HUGE_VAL, all_s = HUGE_VAL;
};

/// The least of the repeats, which other work disturbs least, after one run that pays for compilation.
bool measure(Bench& bench, const std::vector<Receiver>& receivers, double lod, int repeats, Times& times,
             std::vector<double>& irradiance) {
  ClosedFormDevice& device = *bench.device;
  if (!device.set_lod(lod)) return false;
  for (int k = 0; k <= repeats; ++k) {
    if (!device.set_receivers(receivers) || !device.add_cells(bench.indices, bench.pointers)) return false;
    if (k > 0) times.all_s = std::min(times.all_s, device.last_kernel_s());
    if (k == 0 && !device.read(irradiance)) return false;
    for (int again = 0; again < 8; ++again) {
      const auto before = std::chrono::steady_clock::now();
      if (!device.add_cell(bench.indices[31], bench.images[31])) return false;
      const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - before;
      times.one_with_upload_s = std::min(times.one_with_upload_s, wall.count());
      times.one_s = std::min(times.one_s, device.last_kernel_s());
    }
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

  const std::vector<Receiver> receivers = wavy_floor(width, height);
  Times exact;
  std::vector<double> reference;
  if (!measure(bench, receivers, 0, repeats, exact, reference)) return false;
  std::printf("  exact: one cell %.1f ms (with upload %.1f), 63 cells %.0f ms, ratio 1/%.1f\n", 1e3 * exact.one_s,
              1e3 * exact.one_with_upload_s, 1e3 * exact.all_s, exact.all_s / exact.one_s);
  for (const double lod : {8.0, 4.0}) {
    Times times;
    std::vector<double> irradiance;
    if (!measure(bench, receivers, lod, repeats, times, irradiance)) return false;
    std::printf(
        "  T = %.0f: one cell %.1f ms (with upload %.1f), 63 cells %.0f ms, %.2f of exact, relative RMSE %.2f %%\n",
        lod, 1e3 * times.one_s, 1e3 * times.one_with_upload_s, 1e3 * times.all_s, times.all_s / exact.all_s,
        100 * relative_rmse(irradiance, reference));
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
