// Kernel time of the closed form: one cell against all 63, one and three channels. Not a test: run it alone on the
// machine.
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

bool measure(int width, int height, int repeats, std::vector<std::string> channels) {
  const LuminaireGeometry geometry = bike_light(std::move(channels));
  const int count = static_cast<int>(geometry.channels.size());
  const auto begin = std::chrono::steady_clock::now();
  auto device = ClosedFormDevice::create(geometry);
  const std::chrono::duration<double> start_up = std::chrono::steady_clock::now() - begin;
  if (!device) {
    std::fprintf(stderr, "%s\n", device.error().message().c_str());
    return false;
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<float> value(0, 1);
  std::vector<CellImage> images;
  std::vector<CellIndex> indices;
  std::vector<const CellImage*> pointers;
  for (int flat = 0; flat < geometry.sampling.cells(); ++flat) {
    CellImage image{300, 300, count, std::vector<float>(90000 * static_cast<std::size_t>(count)), {}, {}};
    for (float& v : image.value) v = value(random);
    images.push_back(std::move(image));
    indices.push_back(geometry.sampling.index(flat));
  }
  for (const CellImage& image : images) pointers.push_back(&image);

  // The least of the repeats, which other work disturbs least, after one run that pays for compilation.
  std::vector<double> one, all, wall;
  const std::vector<Receiver> receivers = wavy_floor(width, height);
  for (int k = 0; k <= repeats; ++k) {
    if (!(*device)->set_receivers(receivers) || !(*device)->add_cells(indices, pointers)) return false;
    if (k > 0) all.push_back((*device)->last_kernel_s());
    for (int again = 0; again < 8; ++again) {
      const auto before = std::chrono::steady_clock::now();
      if (!(*device)->add_cell(indices[31], images[31])) return false;
      wall.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
      one.push_back((*device)->last_kernel_s());
    }
  }
  const auto least = [](const std::vector<double>& v) { return *std::min_element(v.begin(), v.end()); };
  const double t_one = least(one), t_all = least(all);
  std::printf(
      "%s, %dx%d receivers, %d channel(s): one cell %.1f ms (with upload %.1f), 63 cells %.0f ms, ratio 1/%.1f, start "
      "%.2f s\n",
      (*device)->device_name().c_str(), width, height, count, 1e3 * t_one, 1e3 * least(wall), 1e3 * t_all,
      t_all / t_one, start_up.count());
  return true;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  const int width = argc > 2 ? std::atoi(argv[1]) : 1024, height = argc > 2 ? std::atoi(argv[2]) : 768;
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 3;
  if (width < 1 || height < 1 || repeats < 1) return 2;
  return lumifield::measure(width, height, repeats, {"Y"}) &&
                 lumifield::measure(width, height, repeats, {"R", "G", "B"})
             ? 0
             : 1;
}
