#pragma once

#include <optional>
#include <set>
#include <vector>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/device_method.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/renderer.h"
#include "renderer/scene/mesh.h"
#include "renderer/shading.h"
#include "renderer/shift_invariant/shift_invariant_device.h"
#include "renderer/visibility/scene_shadows.h"

namespace lumifield {

/// What a Renderer holds, and how its irradiance comes about: of additive methods cell by cell, of others by an
/// evaluation of all cells, in pieces of receivers, after which none waits.
struct Renderer::Impl {
  // The context outlives what draws with it.
  std::unique_ptr<EglContext> context;
  std::unique_ptr<GBufferPass> pass;
  std::unique_ptr<SceneShadows> shadows;
  Visibility visibility = Visibility::tile;
  std::vector<Material> materials;
  std::vector<ScenePlacement> placements;
  RendererInfo info;  ///< without left_out and has_environment
  GBuffer gbuffer;
  Vec3 eye_mm{0, 0, 0};                           ///< that sees it
  std::unique_ptr<EnvironmentLight> environment;  ///< the scene's, or null
  bool environment_on = false;
  std::vector<float> environment_radiance;  ///< in this view, R G B by pixel
  std::size_t environment_pixels = 0;       ///< the first so many have it
  double lod = 0;

  std::optional<LuminaireGeometry> geometry;
  MethodSettings settings;
  std::unique_ptr<RunningSums> device;    ///< of additive methods, else null
  ShiftInvariantDevice* spots = nullptr;  ///< the device where it is that
  int spot_maps_before = 0;               ///< how often those before it made maps
  std::unique_ptr<DeviceMethod> method;   ///< of the others, else null
  std::optional<Error> no_opencl;         ///< why
  bool method_has_cells = false;
  std::vector<std::shared_ptr<const CellImage>> cells;   ///< by Sampling::flat, null while unmeasured
  std::vector<std::shared_ptr<const CellImage>> summed;  ///< as they are in the device's sums
  std::set<int> waiting;                                 ///< where cells and summed differ
  bool handed_over = false;                              ///< the device has the view's receivers
  bool positions_wait = false;                           ///< a cell that is kept gives tiles published positions
  double receiver_s = 0;                                 ///< of the last cells: time for a cell and receiver
  std::size_t gloss_channels = 0;                        ///< of the receivers handed over
  std::vector<double> gloss;                             ///< as irradiance
  std::vector<double> irradiance;  ///< of additive methods as read last, of the others of the last evaluation
  std::vector<double> irradiance_before, gloss_before;  ///< of cells summed before the device had its receivers

  Status need_luminaire() const {
    if (device || method) return {};
    return fail("no luminaire is set", "renderer", "set one first");
  }
  double receivers() const {
    return static_cast<double>(gbuffer.position.size()) / 4 * static_cast<double>(placements.size());
  }
  bool surround(double seconds);
  void clear();
  Status check_memory() const;
  Status hand_over();
  Status read_sums();
  Status see(const Receivers& seen, Appearance& appearance);
  Status set_spot_scene(const Receivers& seen);
  Result<LightField> kept_cells() const;
  Status keep(CellIndex cell, std::shared_ptr<const CellImage> image);
  Status sum(const std::vector<int>& flats);
  Status sum(std::size_t count);
  std::size_t first_row() const;
  Status add(const std::vector<int>& flats);
  Status make_method();
  Result<std::unique_ptr<RunningSums>> make_sums();
  Status need_opencl() const;
  Status give_cells();
  Status evaluate(double seconds);
};

}  // namespace lumifield
