#include "renderer/study/spot_figures.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <stdlib.h>
#include <system_error>

#include "renderer/renderer.h"
#include "renderer/study/hall.h"
#include "renderer/study/ladder.h"
#include "renderer/study/relative_rmse.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {

namespace {

using Clock = std::chrono::steady_clock;
const double none = std::nan("");
constexpr int size_px = 400, frames = 4;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Frames a second of Granier et al. 2003, Table 1, with shadows and without, by hall and luminaire; and one iteration.
struct Paper {
  double with, without;
};
struct Hall {
  const char* name;
  int sides;
  Paper iteration_ms;
  std::array<Paper, 3> rate;
};
constexpr std::array halls{Hall{"500", 10, {40, 35}, {{{2.7, 3.2}, {1.5, 1.7}, {1.2, 1.4}}}},
                           Hall{"8,000", 144, {85, 70}, {{{1.3, 1.6}, {0.7, 0.85}, {0.55, 0.7}}}}};
constexpr std::array<std::array<int, 2>, 3> sizes{{{5, 5}, {7, 7}, {9, 7}}};

/// The best of some frames, each of another view, seconds; `passes_s` of it its maps and lighting.
struct Timed {
  double frame_s = HUGE_VAL, passes_s = HUGE_VAL;
};

/// A hall in a folder of its own, which goes with it.
class HallFolder {
 public:
  static Result<std::unique_ptr<HallFolder>> create(int sides) {
    constexpr const char* remedy = "make room, or set TMPDIR to a folder to write to";
    std::error_code wrong;
    const std::filesystem::path place = std::filesystem::temp_directory_path(wrong);
    if (wrong) return fail("cannot be used: " + wrong.message(), "the folder for temporary files", remedy);
    std::string path = (place / "lumifield_hall_XXXXXX").string();
    if (!mkdtemp(path.data())) return fail("cannot be made: " + std::generic_category().message(errno), path, remedy);
    std::unique_ptr<HallFolder> folder(new HallFolder(path));
    auto scene = write_hall(path, sides);
    if (!scene) return tl::unexpected(scene.error());
    folder->scene_ = std::move(*scene);
    return folder;
  }
  ~HallFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  HallFolder(const HallFolder&) = delete;
  HallFolder& operator=(const HallFolder&) = delete;
  const Scene& scene() const { return scene_; }

 private:
  explicit HallFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
  Scene scene_;
};

/// One lamp in one hall, its cells in the sums.
class SpotBench {
 public:
  static Result<SpotBench> create(const Scene& scene, const LightField& field, Visibility visibility,
                                  const SpotSettings& spots) {
    auto renderer = Renderer::create(scene, size_px, size_px);
    if (!renderer) return tl::unexpected(renderer.error());
    SpotBench bench(std::move(*renderer), scene, field);
    const Status ready = bench.renderer_->set_method({.method = Method::shift_invariant, .spots = spots})
                             .and_then([&] { return bench.renderer_->set_visibility(visibility); })
                             .and_then([&] { return bench.renderer_->set_luminaire(field.geometry()); })
                             .and_then([&] { return bench.renderer_->add_all(field); });
    if (!ready) return tl::unexpected(ready.error());
    return bench;
  }

  /// With the depth maps of the frame before, or after the lamp has moved.
  Result<Timed> time(bool anew) {
    Timed best;
    for (int k = 0; k < frames; ++k) {
      camera_.target_mm.x() += 1;
      placements_[0].pose(0, 3) += anew ? 1 : 0;
      if (const Status placed = renderer_->set_placements(placements_); !placed) return tl::unexpected(placed.error());
      const auto start = Clock::now();
      if (const Status viewed = renderer_->set_view(camera_, size_px, size_px); !viewed)
        return tl::unexpected(viewed.error());
      if (const Status handed = renderer_->hand_over(); !handed) return tl::unexpected(handed.error());
      const auto passes = Clock::now();
      if (const Status summed = renderer_->sum_some(HUGE_VAL); !summed) return tl::unexpected(summed.error());
      best.passes_s = std::min(best.passes_s, seconds_since(passes));
      if (const auto picture = renderer_->picture(); !picture) return tl::unexpected(picture.error());
      best.frame_s = std::min(best.frame_s, seconds_since(start));
    }
    return best;
  }

  /// Of one cell that comes again into the picture that has all others, seconds: its map is there.
  Result<double> time_of_a_cell() {
    double best_s = HUGE_VAL;
    for (int k = 0; k < frames; ++k) {
      const CellIndex cell = field_->geometry().sampling.index(k);
      const auto start = Clock::now();
      if (const Status added = renderer_->add_cell(cell, std::make_shared<const CellImage>(*field_->cell(cell)));
          !added)
        return tl::unexpected(added.error());
      if (const auto picture = renderer_->picture(); !picture) return tl::unexpected(picture.error());
      best_s = std::min(best_s, seconds_since(start));
    }
    return best_s;
  }

  Result<Picture> picture() { return renderer_->picture(); }

 private:
  SpotBench(std::unique_ptr<Renderer> renderer, const Scene& scene, const LightField& field)
      : renderer_(std::move(renderer)), camera_(scene.camera), placements_(scene.luminaires), field_(&field) {}
  std::unique_ptr<Renderer> renderer_;
  SceneCamera camera_;
  std::vector<ScenePlacement> placements_;
  const LightField* field_;
};

/// The rows of Table 1 and what stands beside it.
class SpeedRows {
 public:
  SpeedRows(bool quick, const StudyProgress& progress) : quick_(quick), progress_(progress) {}

  Result<std::vector<FigureRow>> make() {
    for (const Hall& hall : halls) {
      const auto folder = HallFolder::create(hall.sides);
      if (!folder) return tl::unexpected(folder.error());
      for (std::size_t size = 0; size < sizes.size(); ++size) {
        if (quick_ && size != (&hall == &halls[0] ? 0U : 2U)) continue;
        if (const Status done = lamp((*folder)->scene(), hall, size); !done) return tl::unexpected(done.error());
      }
      if (&hall == &halls[1])
        if (const Status done = sums((*folder)->scene()); !done) return tl::unexpected(done.error());
    }
    return std::move(rows_);
  }

 private:
  Status go_on(const std::string& what) {
    progress_share_ += quick_ ? 0.3 : 0.1;
    return progress_(std::min(progress_share_, 0.99), what) ? Status{} : Status(study_stopped());
  }

  Status lamp(const Scene& scene, const Hall& hall, std::size_t size) {
    const auto [columns, rows] = sizes[size];
    name_ = std::to_string(columns) + "×" + std::to_string(rows) + " cells";
    const LightField field = make_luminaire({.name = name_, .columns = columns, .rows = rows}, 3);
    for (const bool shadows : {true, false}) {
      if (quick_ && !shadows) continue;
      const std::string what = std::string(hall.name) + " polygons, " + (shadows ? "shadows" : "no shadows");
      if (const Status on = go_on("Table 1, " + name_ + ", " + what); !on) return on;
      auto bench = SpotBench::create(scene, field, shadows ? Visibility::tile : Visibility::none,
                                     {.look_up = SpotLookUp::textured});
      if (!bench) return tl::unexpected(bench.error());
      const Paper& paper = hall.rate[size];
      const double cells = columns * rows, paper_rate = shadows ? paper.with : paper.without;
      const auto kept = bench->time(false);
      if (!kept) return tl::unexpected(kept.error());
      add(what + (shadows ? ", depth maps kept" : ""), "frames/s", 1 / kept->frame_s, paper_rate);
      add(what + (shadows ? ", depth maps kept" : ""), "time of a cell in its pass, ms", 1e3 * kept->passes_s / cells);
      if (!shadows) {
        add(what, "time of one iteration, ms", 1e3 * kept->passes_s / cells, hall.iteration_ms.without);
        continue;
      }
      const auto anew = bench->time(true);
      if (!anew) return tl::unexpected(anew.error());
      add(what + ", depth maps anew", "frames/s", 1 / anew->frame_s, paper_rate);
      add(what + ", depth maps anew", "time of one iteration, ms", 1e3 * anew->passes_s / cells,
          hall.iteration_ms.with);
      const auto cell_s = bench->time_of_a_cell();
      if (!cell_s) return tl::unexpected(cell_s.error());
      add(what + ", one more cell, until the picture", "time, ms", 1e3 * *cell_s);
    }
    return {};
  }

  /// Sums of 63 cells in sRGBE beside those in float.
  Status sums(const Scene& scene) {
    name_ = "9×7 cells";
    const LightField field = make_luminaire({.name = name_, .columns = 9, .rows = 7}, 3);
    for (const int x : {16, 8, 3, 1}) {
      if (quick_ && x != 16 && x != 3) continue;
      const std::string what = std::to_string(x) + " cells a pass";
      if (const Status on = go_on("Table 1, " + what); !on) return on;
      std::vector<Picture> pictures;
      for (const SpotSums kind : {SpotSums::float32, SpotSums::srgbe}) {
        auto bench = SpotBench::create(scene, field, Visibility::tile,
                                       {.look_up = SpotLookUp::textured, .sums = kind, .cells_per_pass = x});
        if (!bench) return tl::unexpected(bench.error());
        auto picture = bench->picture();
        if (!picture) return tl::unexpected(picture.error());
        pictures.push_back(std::move(*picture));
        if (quick_) continue;
        const auto kept = bench->time(false);
        if (!kept) return tl::unexpected(kept.error());
        add(what + (kind == SpotSums::float32 ? ", sums in float" : ", sums in sRGBE"), "frames/s", 1 / kept->frame_s);
      }
      add(what + ", sums in sRGBE against float", "relative RMSE", relative_rmse(pictures[1], pictures[0]));
    }
    return {};
  }

  void add(const std::string& what, const char* quantity, double ours, double paper = none) {
    rows_.push_back({"Table 1", name_, what, quantity, ours, paper});
  }

  bool quick_;
  const StudyProgress& progress_;
  double progress_share_ = 0;
  std::string name_;
  std::vector<FigureRow> rows_;
};

}  // namespace

Result<std::vector<FigureRow>> spot_speed_figures(bool quick, const StudyProgress& progress) {
  return SpeedRows(quick, progress).make();
}

}  // namespace lumifield
