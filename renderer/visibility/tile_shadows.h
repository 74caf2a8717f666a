#pragma once

#include <memory>
#include <optional>
#include <span>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "renderer/opengl/egl_context.h"
#include "renderer/scene/mesh.h"
#include "renderer/visibility/shadow_plan.h"
#include "renderer/visibility/tile_visibility.h"

namespace lumifield {

/// Which tiles of a luminaire a scene's receivers see, by depth maps: OpenGL draws them when light or scene have moved,
/// OpenCL tests the receivers.
///
/// A receiver at q = p − e is hidden from e where its texel's depth is less than (1 − ε) times both q_z and the depth
/// that its own face's plane has at the texel's centre, n·q/(n·(x, y, 1)), if that is in front of e. The plane keeps a
/// surface from shadowing itself at any angle without a bias that would lift shadows off their feet; q_z keeps the
/// surface behind a concave corner from doing so. Thread-bound to the context's thread; the context must outlive it.
class TileShadows {
 public:
  /// Errors: no OpenCL device, mesh too large for the graphics device's memory.
  static Result<std::unique_ptr<TileShadows>> create(EglContext& context, const Mesh& mesh);
  /// Of the same scene, without maps yet: shares this one's device, and what draws and tests maps. On the same thread.
  std::unique_ptr<TileShadows> another() const;
  ~TileShadows();

  /// Makes the maps but those that are there of this pose (luminaire → scene, rigid), luminaire and settings: of
  /// published ones all whose positions have not moved. After an error there are none. Errors: those of plan_shadows,
  /// out of memory.
  Status set(const Pose& pose, const LuminaireGeometry& geometry, const ShadowSettings& settings,
             const std::optional<TilePositions>& positions = std::nullopt);

  /// Receivers in fours of floats, luminaire frame: positions in mm, and their faces' unit normals, to either side; the
  /// fourth is ignored. One with n = 0, and one that is not in front of U, sees nothing. Errors: no maps, lists of
  /// another length, more than max_visibility_bytes, the device's.
  Result<TileVisibility> see(std::span<const float> p_xyzw, std::span<const float> face_xyzw);

  /// Whether set would find them there.
  bool has(const Pose& pose, const LuminaireGeometry& geometry, const ShadowSettings& settings,
           const std::optional<TilePositions>& positions = std::nullopt) const;
  /// Of the luminaire whose maps there are; none without maps.
  std::optional<Pose> pose() const;
  int maps() const;              ///< that there are
  int times_made() const;        ///< how often maps have been made, some or all
  int maps_drawn() const;        ///< for that, in all
  double last_kernel_s() const;  ///< of the last see
  std::string device_name() const;

 private:
  struct Tools;
  struct Impl;
  explicit TileShadows(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Of a TileVisibility, bounded before it is taken.
inline constexpr std::size_t max_visibility_bytes = std::size_t(1) << 30;

}  // namespace lumifield
