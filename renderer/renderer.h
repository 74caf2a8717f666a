#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "luminaire/scene.h"
#include "renderer/methods/method.h"
#include "renderer/picture.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

struct RendererInfo {
  std::string opengl;              ///< renderer and version
  std::string opencl;              ///< device; empty where there is none
  std::vector<std::string> notes;  ///< what the picture does not show of the scene's files, and why
  std::string left_out;            ///< of the light, as pictures of now say (Picture::note)
  bool has_environment = false;    ///< the scene names one
};

/// The live picture: a scene lit by the part of a luminaire that is measured. Thread-bound to the render thread, which
/// owns its EGL context and OpenCL queue for life. OpenGL makes the G-buffer once per view or scene; OpenCL adds cells
/// to the running sum of irradiance, or computes it by another method; by shift-invariant OpenGL does that too, also
/// where there is no OpenCL.
///
/// A cell is kept, then summed; kept ones wait after a change of view, and picture() sums what waits. Who must not be
/// held up hands a view over, sums in slices (sum_some) and asks for a picture when none waits.
class Renderer {
 public:
  /// Errors: no EGL context, the mesh's, the environment's (LatLong::read), a scene without a luminaire or with a pose
  /// that is not rigid; ErrorKind::stopped, where `stop` asks for it while the environment's map is made.
  static Result<std::unique_ptr<Renderer>> create(const Scene& scene, int width_px, int height_px,
                                                  const std::stop_token& stop = {});
  ~Renderer();

  RendererInfo info() const;

  /// Forgets all cells and takes another luminaire. It stands at every placement of the scene; their light adds up.
  Status set_luminaire(const LuminaireGeometry& geometry);
  /// Another view: draws it and clears the sums, so that all cells wait. A view that is refused leaves all as it was.
  /// `lod` is the closed form's level of detail T, pixels per support and axis; 0 is exact.
  Status set_view(const SceneCamera& camera, int width_px, int height_px, double lod = 0);
  /// Moves the luminaires of the scene, or takes others; all cells wait. Errors: those of create; then all stays.
  Status set_placements(const std::vector<ScenePlacement>& placements);
  /// Another way to tell what casts shadows, each tile's own until then; all cells wait. Shadow maps are kept until a
  /// luminaire moves; a view with a level of detail has coarse ones where they are to be made.
  Status set_visibility(Visibility visibility);
  Visibility visibility() const;
  /// Whether the scene's environment lights it, under any method: it does where the scene names one. The sums stay.
  /// Errors: a scene without one, switched on.
  Status set_environment(bool on);
  bool environment() const;
  /// Computes its light in this view, some pixels at least and no longer than `seconds`, where it is on: true when all
  /// have it. A picture does what is left.
  bool surround(double seconds);
  /// How much of the view has it, 0 … 1.
  double share_surrounded() const;
  /// Published shadows stand where the first cells of each tile had their light: from now on where all have it. All
  /// cells wait. A cell that comes and gives tiles their first has none wait, but in a view with a level of detail.
  void refresh_shadows();
  /// How often shadow maps have been made. Shift-invariant has its own, one a cell, whatever tells shadows but `none`;
  /// without a luminaire that moves a cell's is made when it comes.
  int shadow_maps_made() const;
  /// Another way to compute the irradiance, the closed form until then; all cells wait. Of methods that are not
  /// additive (method.h) the cells share samples or tables: a cell that comes has all of them wait, and they are
  /// computed together, in pieces of receivers. Errors: settings outside their range, a method that this device or
  /// luminaire cannot take, one of OpenCL where there is none; then all stays.
  Status set_method(const MethodSettings& settings);
  /// Hands the view's receivers to the device, unless it has them: what sums or reads would do first. Errors: more of
  /// them, one for each pixel and placement, than fit into half of the machine's memory with what a method has of each
  /// placement; the device's.
  Status hand_over();

  /// Adds or replaces one cell; the image is kept for changes of view. Where others wait, it waits with them. After an
  /// error of the device all cells wait.
  Status add_cell(CellIndex cell, std::shared_ptr<const CellImage> image);
  /// Adds or replaces one, which waits.
  Status keep_cell(CellIndex cell, std::shared_ptr<const CellImage> image);
  /// Takes all of its cells; with those of before they wait.
  Status keep_all(const LightField& light_field);
  /// The same, and sums them.
  Status add_all(const LightField& light_field);

  /// Cells that are kept, but not in the sums as they are kept.
  int waiting() const;
  bool waits(CellIndex cell) const;
  /// Cells in the sums.
  int summed() const;
  /// Sums some that wait: as many as take about `seconds` by the time that the last ones took, at least those of a row
  /// of the grid, which share so much that the first costs as much as all the others.
  Status sum_some(double seconds);
  /// How much of the kept cells' light is summed, 0 … 1: by cells, or of a method that computes all together by
  /// receivers.
  double share_summed() const;
  /// What one more cell costs in this view by the time that the last ones took, seconds; 0 before the first.
  double cell_s() const;

  /// radiance = reflectance/π · Σ scale·E over all cells: those that wait are summed first.
  Result<Picture> picture();
  /// Of the cells in the sums alone: one that waits is dark, or stands as it was before it was replaced.
  Result<Picture> picture_so_far();
  /// Kernel time of the last add over all placements, seconds.
  double last_kernel_s() const;

 private:
  struct Impl;
  explicit Renderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// What this machine offers, for `lumifield devices`: an Error's message says why not and the remedy.
Result<std::string> probe_opengl();
Result<std::string> probe_opencl();

}  // namespace lumifield
