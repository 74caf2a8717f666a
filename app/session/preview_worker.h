#pragma once

#include <map>
#include <set>
#include <stop_token>

#include "app/session/preview_commands.h"
#include "app/session/preview_detail.h"

namespace lumifield {

/// What the render thread does, in pieces of at most some 0.1 s: `take` what has come, `step`, wait as `step` says.
///
/// A view is first drawn, then handed over, then its cells are summed, then it is shown; a newer view starts anew at
/// any of these, but for a hasty picture, which another scene, luminaire or method alone ends before it is shown. The
/// sums have caught up when none of the view's cells waited once; from then on a picture may be shown
/// while more wait. Thread-bound.
class PreviewWorker {
 public:
  using Clock = std::chrono::steady_clock;
  /// `stop`: the thread is to end; a scene that is being taken is let go of.
  PreviewWorker(LivePreview::Callbacks callbacks, PreviewPace pace, std::stop_token stop);

  void take(PreviewCommands commands);

  /// When to step again: not before `rest`, whatever comes; at `wake`, or when something comes.
  struct Next {
    Clock::time_point rest{}, wake = Clock::time_point::max();
  };
  Next step();

  /// After an exception: the renderer's state is not known, so it goes.
  void give_up(const Error& error);

 private:
  struct View {
    SceneCamera camera;
    int width_px = 1024, height_px = 768;
    std::vector<ScenePlacement> placements;
    /// Each pixel is one for each luminaire.
    double receivers() const {
      return static_cast<double>(width_px) * height_px * static_cast<double>(placements.size());
    }
  };

  // preview_worker.cpp
  static bool same(const View& a, const View& b);
  void take_scene(const Scene& scene);
  void take_luminaire(const PreviewCommands::Luminaire& luminaire);
  void take_cell(PreviewCommands::Cell cell);
  void light();
  bool holds_cells() const;
  void let_in();
  void take_method(const MethodSettings& method);
  void take_visibility(Visibility visibility);
  void take_environment(bool on);
  void begin_anew();
  void report(const Error& error);
  bool working() const;
  void tell_progress();

  // preview_worker_step.cpp
  Next work();
  Next rested(Next next, Clock::time_point start);
  PreviewDetail detail_wanted(Clock::time_point now) const;
  PreviewDetail resting_detail(Clock::time_point now) const;
  bool all_in() const { return static_cast<int>(cells_.size()) == geometry_->sampling.cells(); }
  /// The method computes all cells together.
  bool together() const { return !is_additive(method_.method); }
  bool caught_up() const { return renderer_->waiting() == 0 || caught_up_; }
  void draw(PreviewDetail detail);
  double drawn_receivers() const;
  void hand_over();
  bool surround();
  void sum();
  void show();
  void show_again();
  void hand_out(PreviewFrame frame, Clock::time_point start);
  void stop_at(const Error& error);
  Clock::time_point due() const { return last_frame_at_ + seconds(pace_.frame); }
  static Clock::duration seconds(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }

  LivePreview::Callbacks callbacks_;
  PreviewPace pace_;
  std::stop_token stop_;
  PreviewCosts costs_;

  // What is wanted.
  std::optional<LuminaireGeometry> geometry_;
  std::uint64_t luminaire_ = 0;
  std::map<CellIndex, std::shared_ptr<const CellImage>> cells_;
  std::set<CellIndex> half_;  ///< of them
  View view_;
  bool moving_ = false, scan_ = false;
  PreviewLook look_;
  MethodSettings method_;
  Visibility visibility_ = Visibility::tile;
  bool environment_ = true;

  // What there is.
  std::unique_ptr<Renderer> renderer_;
  bool lit_ = false;    ///< the renderer has the luminaire
  bool stuck_ = false;  ///< after an error, until something comes
  bool view_changed_ = true, look_changed_ = false;
  std::optional<PreviewDetail> drawn_;  ///< empty before anything is
  View drawn_view_;
  std::vector<ScenePlacement> placed_;  ///< the last that the renderer took
  bool hasty_ = false;                  ///< coarse, or of a camera that moves: made to its end
  bool handed_over_ = false;
  std::set<CellIndex> held_;  ///< cells that would keep a picture from its end: the renderer gets them after it
  bool caught_up_ = false;
  bool dirty_ = false;  ///< drawn or summed since the last frame
  std::shared_ptr<const PreviewFrame> last_;
  Clock::time_point last_frame_at_{}, last_cell_at_{};
  int burst_ = 0;  ///< cells since the full picture was begun, no two of them a moment apart
  std::map<CellIndex, Clock::time_point> fresh_;  ///< in no frame yet: when handed in
  double unlearned_s_ = 0;                        ///< spent on cells that wait all the same
  double draw_s_ = 0, sum_s_ = 0;                 ///< since the last frame
  double surround_s_ = 0;                         ///< of these, spent on the environment
  double coarse_took_s_ = 0;                      ///< the last coarse picture, all in all
  double worked_s_ = 0;                           ///< since the last rest
  bool framed_ = false;                           ///< this step handed one out
  std::string last_error_;
  MethodSettings asked_;          ///< last
  std::optional<Error> refused_;  ///< why the method asked for is not the one used
  std::optional<Error> stopped_;  ///< why no picture came since the last
  Clock::time_point sum_began_at_{}, told_at_{};
};

}  // namespace lumifield
