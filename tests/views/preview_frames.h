#pragma once

#include <memory>

#include "app/session/live_preview.h"

namespace lumifield {

/// A frame of the preview made by hand: left half lit by `left`, right half by `right`, the last row background.
inline PreviewFrame preview_frame(int width_px, int height_px, std::array<float, 3> left = {0.2F, 0.2F, 0.2F},
                                  std::array<float, 3> right = {0.8F, 0.4F, 0.1F}) {
  Picture radiance{width_px, height_px, {}, {}, "no shadows"};
  for (int j = 0; j < height_px; ++j)
    for (int i = 0; i < width_px; ++i) {
      const bool background = j == height_px - 1;
      const auto& rgb = i < width_px / 2 ? left : right;
      for (const float v : rgb) radiance.rgb.push_back(background ? 0 : v);
      radiance.coverage.push_back(background ? 0 : 1);
    }
  PreviewFrame frame;
  frame.shown = tone_map(radiance, frame.look.tone);
  frame.average = average_luminance(radiance);
  frame.radiance = std::make_shared<const Picture>(std::move(radiance));
  frame.cells = 37;
  frame.total = 63;
  frame.draw_s = 0.002;
  frame.sum_s = 0.030;
  frame.show_s = 0.010;
  return frame;
}

inline LuminaireGeometry preview_luminaire() {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 7.5}, 9, 7, {0, 0}};
  g.measurement = {4, 4, {1, 1}, {0, 0}};
  g.channels = {"Y"};
  g.quantity = Quantity::radiance;
  return g;
}

inline SceneCamera preview_camera() { return {{0, -1000, 300}, {0, 0, 0}, {0, 0, 1}, 40}; }

}  // namespace lumifield
