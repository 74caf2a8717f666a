#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "luminaire/scene.h"
#include "renderer/picture.h"
#include "renderer/renderer.h"

namespace lumifield {

/// How a picture is shown.
struct PreviewLook {
  ToneCurve tone{0.3, 0};
  bool false_colour = false;
  double false_colour_top = 0;  ///< luminance at the scale's end, dataset's unit; 0 = the picture's largest
};

/// One finished picture, immutable.
struct PreviewFrame {
  Picture8 shown;                           ///< to paint as it is
  std::shared_ptr<const Picture> radiance;  ///< the values behind it
  PreviewLook look;
  SceneCamera camera;
  std::vector<ScenePlacement> placements;  ///< of the luminaire
  MethodSettings method;                   ///< that computed the light
  Visibility visibility = Visibility::tile;
  bool environment = false;     ///< its light is in the picture
  double scale_top = 0;         ///< luminance at the false-colour scale's end, dataset's unit
  double average = 0;           ///< L̄ that the tone curve took
  int cells = 0, total = 0;     ///< in the picture, and of the grid
  int measured = 0;             ///< handed in, be they in the picture or not yet
  int half = 0;                 ///< of those, with one pass alone: the light of the others is missing
  bool coarse = false;          ///< fewer pixels or a coarser level of detail than asked for, while the view moves
  std::uint64_t luminaire = 0;  ///< LivePreview::luminaire of its cells
  double draw_s = 0;            ///< seconds spent on drawing the view and handing it over; 0 for that of the last frame
  double sum_s = 0;             ///< seconds spent on adding cells since the last frame
  double show_s = 0;            ///< seconds spent on shading and tone mapping
  /// When the oldest cell that this picture is the first to hold was handed in; the epoch when it holds no new one.
  std::chrono::steady_clock::time_point handed_in{};
};

/// What the render thread is at.
struct PreviewProgress {
  MethodSettings asked;  ///< the method chosen last
  Visibility visibility = Visibility::tile;
  bool environment = false;      ///< lights the picture that comes
  std::optional<Error> refused;  ///< why there is no picture by what is asked: the last one stays
  bool working = false;          ///< a picture comes that is finer, of more cells or by what is asked
  bool coarse = false;           ///< it is a coarse one
  double share = 0;              ///< of its light that is computed
  double left_s = 0;             ///< until it is shown, by the time that its share took; 0: not known
};

/// How the render thread divides its time, seconds.
struct PreviewPace {
  double frame = 0.04;    ///< least time from frame to frame
  double coarse = 0.055;  ///< a coarse picture is to take about as long; half of it while a scan runs
  /// A full picture is made in pieces of this time, a coarse one, or of a camera that moves, of twice as much; in
  /// between what has come is looked at.
  double slice = 0.05;
  double moment = 0.1;  ///< without a cell, after which a coarse picture gives way to the full one
};

/// The render thread: it owns the Renderer for life, takes cells as they come, and hands out pictures, at most 25 a
/// second. Cells are never dropped, only summed later; views may be: the latest counts. A camera that moves gets a
/// coarser picture at once; when it rests the full one follows, and a new move interrupts its making. Cells that come
/// faster than the full picture takes them, as from a dataset that is opened, are shown coarsely until they are in or
/// pause. A picture never has fewer cells than one before it had, of the same luminaire.
///
/// A full picture that has been begun is made to its end: where a cell that comes would have it begun anew or held up,
/// that cell waits for the next one, which is coarse where most cells are new. So pictures lag behind a scan by as much
/// as one takes, and never stop coming.
///
/// The thread and those of the drivers that it starts have niceness 10 for life: they yield to window and scan, and an
/// ordinary user could not take it back. While a scan runs it also rests after each frame as long as it worked.
///
/// Every member function returns at once and may be called from any thread; the callbacks come on the render thread.
/// What they throw is reported by `failed`.
class LivePreview {
 public:
  struct Callbacks {
    std::function<void(std::shared_ptr<const PreviewFrame>)> frame;
    std::function<void(const RendererInfo&)> ready;  ///< a renderer stands: after the start and after each set_scene
    /// No picture of this scene (another may do) or view, or a cell is refused. The same again is told once until a
    /// frame comes.
    std::function<void(const Error&)> failed;
    /// Told when something is taken or shown, and a few times a second while a picture is made.
    std::function<void(const PreviewProgress&)> progress = {};
  };
  /// Starts the thread; it waits for a scene.
  explicit LivePreview(Callbacks callbacks, PreviewPace pace = {});
  /// Joins; takes as long as the piece of work at hand, some 0.1 s.
  ~LivePreview();

  /// The view is then the scene's camera, and the luminaires stand where it has them. The cells stay.
  void set_scene(Scene scene);
  /// Forgets all cells.
  void set_luminaire(LuminaireGeometry geometry);
  /// The number of the last set_luminaire, from 1; 0 before it. A frame of another number is late: not to be shown.
  std::uint64_t luminaire() const;
  /// Adds or replaces one; `half`: what one pass alone makes. The image is kept while the luminaire is. A cell before
  /// set_luminaire is refused by `failed`.
  void add(CellIndex cell, std::shared_ptr<const CellImage> image, bool half = false);
  void set_camera(const SceneCamera& camera, bool moving);
  /// Moves the scene's luminaires, or takes others; until then those of the scene. Refused, those before stay.
  void set_placements(const std::vector<ScenePlacement>& placements, bool moving);
  /// Size of the full picture, 1024x768 until then.
  void set_size(int width_px, int height_px);
  void set_look(const PreviewLook& look);
  /// How the irradiance is computed, by the closed form until then. A method that is refused leaves the one before.
  void set_method(const MethodSettings& method);
  /// What casts shadows, each tile by itself until then.
  void set_visibility(Visibility visibility);
  /// Whether a scene's environment lights it; it does until then where a scene has one.
  void set_environment(bool on);
  /// Published shadows stand where the cells of now have their light.
  void refresh_shadows();
  void set_scan_running(bool running);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
