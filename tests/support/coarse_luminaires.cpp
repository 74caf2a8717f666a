#include "tests/support/coarse_luminaires.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace lumifield {

namespace {

LightField mapped(const LightField& field, const LuminaireGeometry& geometry,
                  const std::function<float(const CellImage&, int channel, int i, int j)>& value) {
  LightField result(geometry);
  const Measurement& m = geometry.measurement;
  for (int flat = 0; flat < geometry.sampling.cells(); ++flat) {
    const auto image = field.cell(geometry.sampling.index(flat));
    if (!image) continue;
    CellImage out{m.width_px, m.height_px, image->channels, {}, {}, {}};
    for (int c = 0; c < image->channels; ++c)
      for (int j = 0; j < m.height_px; ++j)
        for (int i = 0; i < m.width_px; ++i) out.value.push_back(value(*image, c, i, j));
    if (!result.add(geometry.sampling.index(flat), std::move(out))) std::abort();
  }
  return result;
}

LuminaireGeometry coarse_geometry(LuminaireGeometry geometry, int level) {
  Measurement& m = geometry.measurement;
  const Vec2 corner = m.corner_mm();
  const int n = 1 << level;
  m.width_px = (m.width_px + n - 1) / n;
  m.height_px = (m.height_px + n - 1) / n;
  m.pixel_mm *= n;
  m.center_mm += corner - m.corner_mm();
  return geometry;
}

struct Block {
  double mean = 0, least = HUGE_VAL, greatest = -HUGE_VAL;
};

Block block(const CellImage& image, int channel, int i, int j, int level) {
  Block block;
  const int n = 1 << level;
  for (int y = j * n; y < (j + 1) * n; ++y)
    for (int x = i * n; x < (i + 1) * n; ++x) {
      const double v = x < image.width_px && y < image.height_px ? image.at(channel, x, y) : 0;
      block.mean += v / n / n;
      block.least = std::min(block.least, v);
      block.greatest = std::max(block.greatest, v);
    }
  return block;
}

}  // namespace

LightField whole_numbers(const LightField& field) {
  return mapped(field, field.geometry(), [](const CellImage& image, int c, int i, int j) {
    const float v = image.at(c, i, j);
    return std::abs(v) > 1000 ? std::round(v) : std::round(512 * v);
  });
}

LightField mean_luminaire(const LightField& field, int level) {
  return mapped(field, coarse_geometry(field.geometry(), level),
                [&](const CellImage& image, int c, int i, int j) { return float(block(image, c, i, j, level).mean); });
}

LightField deviation_luminaire(const LightField& field, int level) {
  return mapped(field, coarse_geometry(field.geometry(), level), [&](const CellImage& image, int c, int i, int j) {
    const Block b = block(image, c, i, j, level);
    return float(std::max(b.greatest - b.mean, b.mean - b.least));
  });
}

int expected_level(const LuminaireGeometry& geometry, double p_z_mm, double pixels_per_support) {
  if (pixels_per_support == 0) return 0;
  const double delta = geometry.planes.separation_mm;
  const Vec2 support = std::abs((p_z_mm - delta) / p_z_mm) * Basis(geometry.sampling.basis).overlap() *
                       geometry.sampling.spacing_mm.cwiseQuotient(geometry.measurement.pixel_mm);
  const double octaves = std::ceil(std::log2(support.maxCoeff() / pixels_per_support));
  const int largest = std::max(geometry.measurement.width_px, geometry.measurement.height_px);
  return static_cast<int>(std::clamp(octaves, 0.0, std::ceil(std::log2(largest))));
}

}  // namespace lumifield
