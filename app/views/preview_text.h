#pragma once

#include <QString>

#include "app/session/live_preview.h"

namespace lumifield {

/// What the preview says in words and numbers. Pure functions.

/// What lights a picture, as the window has it chosen.
struct PreviewChoice {
  MethodSettings method;
  Visibility visibility = Visibility::tile;
  bool environment = false;
};
/// Cells by now, be they in a picture or not.
struct PreviewCells {
  int measured = 0;
  int damaged = 0;  ///< cannot be read
};

/// "37 of 63 cells · picture 42 ms · coarse, finer in about 12 s".
QString progress_text(const PreviewFrame& frame, const PreviewProgress& progress = {});
/// "26 of 63 cells not measured yet: their light is missing; 37 cells are shown in one pass alone: the light of the
/// other is missing; 3 measured cells are not in the picture yet"; empty when none is.
QString missing_text(const PreviewFrame& frame, PreviewCells now = {});
/// Of a choice that is not what is shown: "Computing mis, 200 · shadows: rays: 35 %, about 12 s left. Shown:
/// closed-form · shadows: tile", or why there is no picture by it; else empty. Without a frame nothing is shown.
QString coming_text(const PreviewFrame* frame, const PreviewProgress& progress, const PreviewChoice& chosen);
/// "about 12 s", "about 3 min".
QString about_text(double seconds);
/// The value of pixel (i, j), i to the right and j down: "Y709 0.183 W/(m² sr) · R 0.2 G 0.18 B 0.13", Y709 =
/// 0.2126 R + 0.7152 G + 0.0722 B, BT.709's weights on the camera's primaries; without the bands where they are alike;
/// "background" where no surface is seen.
QString pixel_text(const Picture& picture, int i, int j, Quantity quantity);
/// "Lamp 1 at 1000, 1000, 760 mm · yaw −135° · pitch −21.3° · roll 0° · scale 1"; `number` counts from 0.
QString lamp_text(int number, const ScenePlacement& lamp, const Vec3& up);
/// "Lamp 1 at 1000, 1000, 760 mm".
QString lamp_place(int number, const ScenePlacement& lamp);
/// "luminaires (pose row by row, mm; scale): [1, 0, …] 1, [1, 0, …] 0.5".
QString placements_text(const std::vector<ScenePlacement>& lamps);
}  // namespace lumifield
