#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "acquisition/camera.h"
#include "acquisition/scan/bench_clock.h"
#include "acquisition/scan/device_recovery.h"
#include "acquisition/scan/exposure_ladder.h"
#include "acquisition/scan/lamp_stability.h"
#include "acquisition/scan/motion_time.h"
#include "acquisition/scan/reference_drift.h"
#include "acquisition/scan/scan_control.h"
#include "acquisition/scan/scan_plan.h"
#include "acquisition/scan/scan_state.h"
#include "acquisition/stage.h"

namespace lumifield {

/// How far the lamp's stabilisation is.
struct StabilisationProgress {
  double signal_dn_per_s = 0;      ///< the last reading of the reference cell
  std::optional<double> spread;    ///< of the readings over the last Stabilisation::over_s; absent before the second
  double within = 0;               ///< the spread that is allowed
  double left_s = 0, limit_s = 0;  ///< at most; of that much
};

struct ScanProgress {
  ScanState state = ScanState::idle;
  int cells_done = 0, cells_total = 0;  ///< of the whole grid; a cell taken again counts once
  int cells_before = 0;                 ///< of cells_done: there before this scan
  std::optional<CellIndex> cell;        ///< the one being worked on; none at dark sets and at the reference
  std::string place;                    ///< "cell (2, 3)", "dark set 1", "reference cell (3, 4)"
  double elapsed_s = 0, left_s = 0;
  std::string
      trouble;  ///< in a pause: why the scan cannot go on by itself, and what to do; empty when it was asked for
  std::optional<StabilisationProgress> stabilisation = {};  ///< while the lamp is watched, from the first reading on
  /// Its name, where the operator changes it: cells are then those whose pass is taken.
  std::string pass = {};
  std::string slide = {};  ///< in a pause: the pass whose slide is to be put in
};

/// Where the scan's time went. Everything but move, settle, exposure and readout is idle time of the bench.
struct ScanTiming {
  double move_s = 0;      ///< homing and parking too
  double settle_s = 0;    ///< the warm-up too, and the time between readings while the lamp is watched
  double exposure_s = 0;  ///< sum of the exposure times, as the camera reports them
  double readout_s = 0;   ///< the rest of each frame, up to bench.camera.readout_s
  double waiting_s = 0;   ///< in ScanSink::cell
  double other_s = 0;     ///< slower read-outs, frames taken again inside the camera, positions read back, progress
  double paused_s = 0;    ///< until the operator's word: not idle
  double lost_s = 0;      ///< until a camera that was gone was back: not idle
  double total_s = 0;
  double idle_share() const {
    return total_s > 0 ? 1 - (move_s + settle_s + exposure_s + readout_s + paused_s + lost_s) / total_s : 0;
  }
};

/// Takes what the scanner makes, on the bench thread. `cell` may block when those behind it are busy: the time counts
/// as waiting.
class ScanSink {
 public:
  virtual ~ScanSink() = default;
  virtual void cell(RawCell raw) = 0;
  virtual void reference(const ReferenceReading& reading) = 0;
  virtual void progress(const ScanProgress& progress) = 0;  ///< at every change of state, and while a camera is gone
  virtual void notice(const std::string& text) = 0;         ///< what goes wrong and is helped, for the operator
  /// Every complete bracket, for whoever watches: where it was taken, and the stage's reading.
  virtual void seen(const Bracket& bracket, const std::string& place, const Vec2& stage_mm);
};

/// Runs a ScanPlan on a camera and a stage, through the states of scan_state.h.
///
/// Every position is come to from one side, as StageSettings::approach_mm says (way_to), parking apart. It exposes only
/// after the settle time has passed and the position read back lies within the bench's tolerance; a
/// position off by more is moved to once more and then fails the scan. A bracket during which the position changed by
/// more than the tolerance is discarded and taken once more. The reference cell comes first, every N cells and last,
/// its drift is recorded and handed on; a dark set opens every block of cells, the first one after the warm-up. A cell
/// is handed on as soon as its last pass is exposed, and the stage moves on at once. At the end and after a device
/// error the stage is parked behind the opaque patch; at a stop it is halted and stays.
///
/// Stabilisation. With Plan::stabilisation the reference cell is read again and again before its first reading counts,
/// ten times within over_s where it takes no longer, until the lamp is steady (LampStability). After a trouble and a
/// pause the watch begins anew. A lamp that is not steady within limit_s is a trouble, its `kind` is waiting; on the
/// operator's word, or with accept_drift, the scan goes on without, and the reading records it.
///
/// Exposures. The reference cell is taken with the plan's, dark sets with the whole ExposureLadder, so that every frame
/// has its dark frame. Each pass of a cell begins with the plan's: while its shortest frame is_saturated by more than
/// the plan's limits.saturated_share, the next shorter one is taken; while its longest may_be_longer, the next longer.
/// A frame in which nothing stands above its dark frame by more than five standard errors, the mean over all pixels
/// taken, calls for no longer one: most cells at the rim of the grid are dark, and would each go to the longest.
///
/// Troubles. A camera that fails is opened again until it is back, and the step begun anew (recover_with). One that
/// stays away, a stage that fails, stands wrong or does not hold, and a lamp that drifted beyond the plan's limit pause
/// the scan with the stage halted, if somebody attends (ScanControl): on their word the stage is opened and homed
/// again, the reference cell read, and the step begun anew. So does a camera that is well and refuses what it does not
/// have (ErrorKind::refused), which is not opened again for it. If nobody does, the scan ends with the error, and
/// parks; of drift its `kind` is waiting. Drift that the operator has seen is what further drift is measured from.
///
/// Lost steps. Before an exposure, what the controller knows can be seen: that it does not answer, is locked, did not
/// arrive, or reads another position; then nothing is exposed. Steps that the motors lost change no reading, and no
/// exposure can be kept from a place that is wrong by them. With StageSettings::check_home they are found afterwards:
/// the home switches are looked for before the first reading of the reference cell is handed on and before drift is
/// believed, before every dark set but the first, and at the end. A stage that slipped by more than the tolerance is
/// homed, on the operator's word if somebody attends, else three times in a row by itself; what was exposed since the
/// last look that found nothing, dark set, reference and cells, is taken again. So it is when a trouble made the stage
/// be homed, which hides whether it had slipped. A slip that is gone at the next look, and one by less than the
/// tolerance, both to within 0.01 mm, is not found. Cells that no look came after, when the scan ends early, are told
/// as a notice.
///
/// Slides. Where the operator changes the pass (PassChange::by_operator) a cell is handed on with one pass at a time.
/// At a SlideStep after another the stage waits behind the opaque patch: the scan pauses until the operator's word if
/// somebody attends, else it ends, parked, and `kind` is waiting. The first slide is taken to be in. After a change the
/// stage is homed, and drift is that against the first reading through this pass: what the lamp does meanwhile is not
/// seen. A first reading that is that of another pass, within the plan's limit of drift, is no reading: the slide is
/// asked for once more; then, or with accept_drift, the operator's word counts. A cell is taken again in the pass that
/// is in, if it is one of this scan's; others are refused by a notice.
///
/// Thread-bound to the bench thread; camera, stage, bench, plan and clock outlive it.
class Scanner {
 public:
  Scanner(Camera& camera, Stage& stage, const Bench& bench, const Plan& plan, BenchClock& clock = steady_bench_clock());

  /// Lets the drift refer to the first reading of an earlier scan of the same dataset, through the same pass. Before
  /// `run`.
  void refer_to(const ReferenceReading& first) { drifts_[first.pass] = ReferenceDrift(first); }

  /// Lets the operator pause the scan and have cells taken again between two steps. After a pause the reference cell is
  /// read before anything else. Before `run`; `control` outlives the scanner.
  void obey(ScanControl& control) { control_ = &control; }

  /// Lets the scanner open devices again; it then uses the recovery's, at first those that it was made with. Before
  /// `run`; `recovery` outlives the scanner.
  void recover_with(DeviceRecovery& recovery) { recovery_ = &recovery; }

  /// The operator knows of the drift that is read first, whatever it is, and of a lamp that does not become steady.
  /// Before `run`.
  void accept_drift() {
    drift_seen_.reset();
    accepts_unsteady_ = true;
  }

  /// Runs all steps. Legal once, in state idle; refused in any other state. `stop` is the operator's; `abandon` tells
  /// that nobody takes the cells any more: the scan ends as after a device error, parked, but `kind` is stopped, as its
  /// cause lies elsewhere; a stage that cannot be parked then is told as that failure.
  /// Errors: that of the device, with the cell and pass in front of its place; a stage that does not reach or does not
  /// hold a position; a reference cell that cannot serve; a stop request, `kind` = stopped. A device that fails while
  /// the scan is being stopped is told as that failure.
  Status run(const ScanPlan& steps, ScanSink& sink, std::stop_token stop, std::stop_token abandon = {});

  ScanState state() const { return state_; }
  const ScanTiming& timing() const { return timing_; }
  /// Times that the camera was gone and came back.
  int cameras_lost() const { return cameras_lost_; }

 private:
  /// A bracket taken while the stage stood still within the tolerance.
  struct Standing {
    Bracket bracket;
    Vec2 stage_mm;
    double position_error_mm;
  };

  enum class Culprit { none, camera, stage, slip, lamp, unsteady_lamp, slide };  ///< slip: of a stage that answers
  enum class Exposures { plan, ladder, adapted };

  Camera& camera() { return recovery_ ? recovery_->camera() : camera_; }
  Stage& stage() { return recovery_ ? recovery_->stage() : stage_; }
  tl::unexpected<Error> blame(Culprit culprit, std::string_view place, Error error);

  Status scan(const ScanPlan& steps);
  Status persist(const std::function<Status()>& action);
  Status help(Error error, int& reconnections);
  Status reconnect(const Error& error);
  Status hold(Error error, Culprit culprit);
  Status await_operator();
  Status bring_back(Culprit culprit, const Error& error);
  bool home_check_due(const std::vector<ScanStep>& steps, std::size_t next) const;
  Status check_home();
  Status home_again();
  std::size_t go_back(const std::vector<ScanStep>& steps, std::size_t next);
  void tell_unchecked();
  Status read_reference();
  Status check_drift(const ReferenceReading& reading, const std::string& place);
  Status stabilise(const ReferenceStep& step, const std::string& place);
  Status watch_lamp(const ReferenceStep& step, const std::string& place);
  Status wait_for_reading(double due_s);
  Status judge(const LampStability& lamp, double watched_s, const std::string& place);
  Result<double> reference_signal(const ReferenceStep& step, const std::string& place);
  Status take(const DarkStep& step);
  Status take(const ReferenceStep& step);
  Status take(const CellStep& step);
  Status take(const VisitStep& step);
  Status take(const SlideStep& step);
  Status wait_for_slide(const SlideStep& step);
  tl::unexpected<Error> ask_for_slide(int pass, std::string why, const std::string& place);
  Status change_slide();
  Status check_slide(double signal_dn_per_s, bool is_first, const std::string& place);
  bool may_take_again(CellIndex cell) const;
  Status between_steps();
  Status pause();
  Status retake(CellIndex cell);
  void work_on(std::string place, std::optional<CellIndex> cell = {});
  Result<ReferenceReading> read_light(ReferenceDrift& drift, const Bracket& lit, const ReferenceStep& step,
                                      const std::string& place);
  Result<Standing> bracket_at(const Vec2& target_mm, const std::string& place, Exposures exposures);
  Status move(std::span<const Vec2> stops, const std::string& place);
  Result<Vec2> stand_at(const Vec2& target_mm, const std::string& place);
  Result<Bracket> expose_bracket(const Vec2& stage_mm, const std::string& place, Exposures exposures);
  Status adapt(Bracket& bracket, const Vec2& stage_mm, const std::string& place);
  Result<RawImage> expose_at(double exposure_s, const Vec2& stage_mm, const std::string& place);
  Result<RawImage> expose_frame(double exposure_s);
  Status home();
  Status park();
  ReferenceDrift& drift() { return drifts_[slide_.value_or(0)]; }
  Status end(Status status);

  void enter(ScanState state);
  Status wait(double seconds);

  Camera& camera_;
  Stage& stage_;
  const Bench& bench_;
  const Plan& plan_;
  BenchClock& clock_;
  ScanState state_ = ScanState::idle;
  ScanTiming timing_;

  ScanSink* sink_ = nullptr;
  std::stop_token stop_;  ///< the operator's
  std::stop_source end_;  ///< asked to stop by either
  ScanProgress progress_;
  std::vector<double> step_times_s_;  ///< predicted
  TimeLeft time_left_;
  ExposureLadder ladder_;
  double begin_s_ = 0, first_step_s_ = 0, warm_up_left_s_ = 0;
  std::shared_ptr<const DarkSet> dark_;
  bool reference_read_ = false;
  std::map<int, ReferenceDrift> drifts_;  ///< by pass
  ScanControl* control_ = nullptr;
  DeviceRecovery* recovery_ = nullptr;
  Culprit culprit_ = Culprit::none;  ///< of the error on its way
  bool reference_due_ = false;       ///< before the next step
  int cameras_lost_ = 0;
  bool dark_due_ = false;                 ///< before the reference cell is read
  bool go_back_ = false;                  ///< to the step after the last good check
  std::size_t checked_ = 0;               ///< that step
  std::vector<CellIndex> unchecked_;      ///< handed on since then
  int homings_in_a_row_ = 0;              ///< without a good check between
  std::optional<double> drift_seen_ = 0;  ///< by the operator; absent, the one read next
  Vec2 stands_mm_{0, 0};                  ///< read back last
  std::optional<Vec2> came_to_mm_;        ///< the target of the last move, when nothing has come between

  bool accepts_unsteady_ = false;
  std::optional<StabilisationEnd> stabilised_;  ///< until the reading that records it
  bool stabilisation_due_ = true;               ///< before the reference cell is read, if the plan asks for it
  const ScanPlan* steps_ = nullptr;
  std::optional<int> slide_;  ///< the pass that is in, where the operator changes it
  int slide_asked_ = 0;
  bool slide_doubted_ = false;  ///< once: the operator's word counts
};

}  // namespace lumifield
