#include "renderer/study/synthetic_luminaire.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

namespace lumifield {

namespace {

constexpr std::array table_1{
    SyntheticLuminaire{.name = "bike"},
    SyntheticLuminaire{.name = "car1",
                       .basis = BasisKind::bspline2,
                       .separation_mm = 300,
                       .spacing_mm = 16.5,
                       .columns = 5,
                       .rows = 5,
                       .pixels = 256,
                       .pixel_mm = 3,
                       .lobes = 30,
                       .spread_mm = 200,
                       .least_width_mm = 6,
                       .greatest_width_mm = 60,
                       .cut_off_mm = 0,
                       .seed = 2},
    SyntheticLuminaire{.name = "car2",
                       .basis = BasisKind::bspline2,
                       .separation_mm = 300,
                       .spacing_mm = 16.5,
                       .columns = 11,
                       .rows = 9,
                       .pixels = 256,
                       .pixel_mm = 3,
                       .lobes = 60,
                       .spread_mm = 180,
                       .least_width_mm = 5,
                       .greatest_width_mm = 45,
                       .cut_off_mm = 10,
                       .seed = 3},
};

struct Lobe {
  Vec2 at;
  double width, weight;
  std::array<double, 3> colour;
};

/// Adds one lobe to a channel, within five of its widths.
void add_lobe(const Measurement& m, const Vec2& center, double width, double weight, float* channel) {
  const Vec2 corner = m.corner_mm();
  const auto bounds = [&](int axis, int pixels) {
    const double low = (center[axis] - 5 * width - corner[axis]) / m.pixel_mm[axis];
    const double high = (center[axis] + 5 * width - corner[axis]) / m.pixel_mm[axis];
    return std::pair(static_cast<int>(std::clamp(low, 0.0, double(pixels))),
                     static_cast<int>(std::clamp(high, 0.0, double(pixels))));
  };
  const auto [x0, x1] = bounds(0, m.width_px);
  const auto [y0, y1] = bounds(1, m.height_px);
  std::vector<double> across;
  for (int i = x0; i < x1; ++i) {
    const double x = (m.pixel_center_mm(i, 0).x() - center.x()) / width;
    across.push_back(std::exp(-x * x / 2));
  }
  for (int j = y0; j < y1; ++j) {
    const double y = (m.pixel_center_mm(0, j).y() - center.y()) / width, factor = weight * std::exp(-y * y / 2);
    for (int i = x0; i < x1; ++i)
      channel[j * m.width_px + i] += static_cast<float>(factor * across[static_cast<std::size_t>(i - x0)]);
  }
}

}  // namespace

std::span<const SyntheticLuminaire> table_1_luminaires() { return table_1; }

LightField make_luminaire(const SyntheticLuminaire& synthetic, int channels) {
  LuminaireGeometry g;
  g.planes.separation_mm = synthetic.separation_mm;
  g.sampling = {
      synthetic.basis, {synthetic.spacing_mm, synthetic.spacing_mm}, synthetic.columns, synthetic.rows, {0, 0}};
  g.measurement = {synthetic.pixels, synthetic.pixels, {synthetic.pixel_mm, synthetic.pixel_mm}, {0, 0}};
  g.channels = channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};

  std::mt19937 random(synthetic.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Lobe> lobes;
  for (int b = 0; b < synthetic.lobes; ++b) {
    const double width =
        synthetic.least_width_mm * std::pow(synthetic.greatest_width_mm / synthetic.least_width_mm, unit(random));
    const Vec2 at = 0.5 * synthetic.spread_mm * Vec2(normal(random), normal(random));
    lobes.push_back({at,
                     width,
                     synthetic.greatest_width_mm / width,
                     {0.6 + 0.4 * unit(random), 0.6 + 0.4 * unit(random), 0.6 + 0.4 * unit(random)}});
  }

  LightField field(g);
  constexpr float ground = 0.01F;
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    const CellIndex index = g.sampling.index(flat);
    const Vec2 u_m = g.sampling.cell_center_mm(index);
    CellImage image{g.measurement.width_px, g.measurement.height_px, channels, {}, {}, {}};
    image.value.assign(image.plane() * static_cast<std::size_t>(channels), 0.0F);
    for (const Lobe& lobe : lobes) {
      // A lobe passes through a part of the cells.
      const double share = std::max(0.0, unit(random) - 0.6);
      if (share == 0) continue;
      for (int c = 0; c < channels; ++c)
        add_lobe(g.measurement, u_m + lobe.at, lobe.width,
                 share * lobe.weight * (channels == 1 ? 1 : lobe.colour[static_cast<std::size_t>(c)]),
                 image.channel(c));
    }
    for (int c = 0; c < channels; ++c)
      for (int j = 0; j < g.measurement.height_px; ++j) {
        const bool dark =
            synthetic.cut_off_mm && g.measurement.pixel_center_mm(0, j).y() - u_m.y() > *synthetic.cut_off_mm;
        for (int i = 0; i < g.measurement.width_px; ++i) {
          float& v = image.channel(c)[j * g.measurement.width_px + i];
          v = (dark ? 0 : v) + ground;
        }
      }
    // An image of the geometry's own size and finite values is always taken.
    if (!field.add(index, std::move(image))) std::abort();
  }
  return field;
}

}  // namespace lumifield
