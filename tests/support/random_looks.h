#pragma once

#include <random>
#include <vector>

#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"

namespace lumifield::test {

/// Bits of many kinds, from nothing seen to everything.
inline TileVisibility random_visibility(const Sampling& sampling, std::size_t receivers, ShadowWeighing weighing) {
  TileVisibility visible{TileGrid(sampling), weighing, {}};
  std::mt19937 random(5);
  visible.words.assign(receivers * visible.receiver_words(), 0);
  for (std::size_t k = 0; k < receivers; ++k) {
    const double share = static_cast<double>(random() % 5) / 4;
    for (int row = 0; row < visible.grid.rows; ++row)
      for (int column = 0; column < visible.grid.columns; ++column)
        if (std::generate_canonical<double, 53>(random) < share) visible.set_seen(k, column, row);
  }
  return visible;
}

/// Lobes whose eye is on the normal's side, of every kind and sharpness; every third receiver is diffuse.
inline std::vector<GlossLobe> random_lobes(const std::vector<Receiver>& receivers, bool coloured) {
  std::vector<GlossLobe> lobes;
  std::mt19937 random(6);
  const auto unit = [&] { return std::generate_canonical<float, 24>(random); };
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    Vec3 eye = Vec3(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalized();
    if (eye.dot(receivers[k].n) < 0) eye = -eye;
    GlossLobe lobe{
        static_cast<float>(eye.x()), static_cast<float>(eye.y()), static_cast<float>(eye.z()), 0, 0.5F, 0.5F, 0.5F,
        static_cast<int>(k % 3)};
    if (coloured) lobe.g = unit();
    lobe.shape = lobe.kind == LOBE_PHONG ? 1 + 80 * unit() : 0.05F + unit() * 0.9F;
    lobes.push_back(lobe);
  }
  return lobes;
}

}  // namespace lumifield::test
