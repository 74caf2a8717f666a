#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "renderer/methods/running_sums.h"
#include "renderer/opengl/egl_context.h"
#include "renderer/scene/mesh.h"
#include "renderer/shift_invariant/spot_settings.h"

namespace lumifield {

/// Where receivers of a picture stand in a scene that casts shadows: in as many equal parts, one after the other, as
/// there are placements of the luminaire. Spans: valid as long as what they look at. Value type.
struct SpotScene {
  std::vector<Pose> poses;                ///< luminaire → scene, rigid
  std::span<const float> face_xyzw = {};  ///< the receivers' faces' unit normals, 4 floats each; empty: no shadows
  int columns = 0;                        ///< of a part's picture, 0: they are a list
};

/// Textured spotlights (shift_invariant.h) by OpenGL alone: one pass over all receivers adds the light of X cells to
/// running sums in float or sRGBE. Thread-bound to its creator.
///
/// Shadows: a depth map for each cell, M passes, made when its cell comes and kept until light or scene move; with the
/// lighting M + ⌈M/X⌉ passes. Without a scene the share that is seen of a cell is the mean of its tiles' bits in the
/// appearance, where it has them.
///
/// A replaced cell is taken away as it had been added, which leaves what floats round, 2^-23 of the sum; of sRGBE
/// 0.8 % of the sum's largest channel for each pass.
class ShiftInvariantDevice final : public RunningSums {
 public:
  /// In a context of its own. Errors: those of EglContext::create; images, or a grid, that it has no texture for.
  static Result<std::unique_ptr<ShiftInvariantDevice>> create(const LuminaireGeometry& geometry,
                                                              const SpotSettings& settings);
  /// In that of others, which must outlive it.
  static Result<std::unique_ptr<ShiftInvariantDevice>> create(EglContext& context, const LuminaireGeometry& geometry,
                                                              const SpotSettings& settings);
  ~ShiftInvariantDevice() override;

  /// What casts shadows on receivers that are set with a scene. Errors: those of ShadowMapPass::create.
  Status set_occluders(const Mesh& mesh);
  /// Of the receivers that are set next, floats alone. Errors: shadows without occluders.
  Status set_scene(SpotScene scene);
  /// The next receivers have their maps drawn anew.
  void forget_maps();

  Status set_receivers(std::span<const Receiver> receivers, const Appearance& appearance = {}) override;
  Status set_receivers(std::span<const float> p_xyzw, std::span<const float> n_xyzw,
                       const Appearance& appearance = {}) override;
  Status add_cells(std::span<const CellIndex> cells, std::span<const std::shared_ptr<const CellImage>> images) override;
  Status replace_cell(CellIndex cell, const std::shared_ptr<const CellImage>& image,
                      const std::shared_ptr<const CellImage>& before) override;
  Status read(std::vector<double>& irradiance) override;
  Status read_gloss(std::vector<double>& radiance) override;

  std::string device_name() const override;
  /// By the clock, until OpenGL had done.
  double last_kernel_s() const override;
  /// Since the receivers were set, of one placement.
  int lighting_passes() const;
  int depth_passes() const;
  /// How often maps have been drawn, of all placements.
  int times_drawn() const;

 private:
  struct Impl;
  explicit ShiftInvariantDevice(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
