#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "app/session/live_preview.h"

namespace lumifield {

/// What the render thread is to do, in the one form that only the latest of each kind but every cell is kept in. Value
/// type.
struct PreviewCommands {
  struct Cell {
    CellIndex cell;
    std::shared_ptr<const CellImage> image;
    std::chrono::steady_clock::time_point handed_in;
    bool half = false;
  };
  struct Luminaire {
    LuminaireGeometry geometry;
    std::uint64_t number = 0;  ///< LivePreview::luminaire
  };
  std::optional<Scene> scene;
  std::optional<Luminaire> luminaire;  ///< comes before the cells
  std::vector<Cell> cells;
  std::vector<CellIndex> refused;  ///< came before a luminaire
  std::optional<SceneCamera> camera;
  std::optional<std::vector<ScenePlacement>> placements;
  std::optional<bool> moving;
  std::optional<std::pair<int, int>> size_px;
  std::optional<PreviewLook> look;
  std::optional<MethodSettings> method;
  std::optional<Visibility> visibility;
  std::optional<bool> environment;
  bool refresh_shadows = false;
  std::optional<bool> scan_running;

  bool any() const {
    return scene || luminaire || !cells.empty() || !refused.empty() || camera || placements || moving || size_px ||
           look || method || visibility || environment || refresh_shadows || scan_running;
  }
};

}  // namespace lumifield
