#include "renderer/study/paper_figures.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/host_method.h"
#include "renderer/methods/image_sampler_device.h"
#include "renderer/study/lab.h"
#include "renderer/study/ladder.h"

namespace lumifield {

namespace {

const double none = std::nan("");
constexpr const char* lab = "mean Lab ΔE";
constexpr const char* time = "kernel time of a picture, ms";

/// NaN where the paper gives none.
struct Paper {
  double lab = none, time_ms = none;
};

/// Collects rows; the first error ends it.
class Figures {
 public:
  Figures(const StudyBench& bench, const StudyProgress& progress) : bench_(bench), progress_(progress) {}

  /// Of a kernel: ΔE and time.
  void kernel(const char* figure, const std::string& what, const MethodSettings& settings, Paper paper = {}) {
    if (error_ || !go_on(figure)) return;
    auto method = bench_.make(settings);
    if (!method) return stop_at(method.error());
    const auto point = bench_.judge(**method, 3);
    if (!point) return stop_at(point.error());
    add(figure, what, lab, point->lab_delta_e, paper.lab);
    add(figure, what, time, point->time_ms, paper.time_ms);
  }

  /// Searches that end at depth 3, on the host: against the reference, and against the same draws searched to the end,
  /// which tells the search's own error from the samples'.
  void searches(const MethodSettings& settings) {
    if (error_ || !go_on("Fig. 5")) return;
    const LightField& field = bench_.luminaire().light_field;
    const auto picture = [&](Inversion inversion, int depth) {
      MethodSettings s = settings;
      s.inversion = inversion;
      s.depth = depth;
      return make_host_method(field, s).and_then([&](const auto& method) { return bench_.small_picture(*method); });
    };
    const auto whole = picture(Inversion::bisection, whole_depth);
    if (!whole) return stop_at(whole.error());
    for (const auto& [name, inversion, paper] :
         {std::tuple("modified secant (two neighbouring look-ups a step)", Inversion::secant, 0.89),
          {"bisection", Inversion::bisection, 0.93}}) {
      const auto early = picture(inversion, 3);
      if (!early) return stop_at(early.error());
      const std::string what = std::string(name) + ", depth 3, K = 200";
      add("Fig. 5", what, lab, mean_lab_delta_e(*early, bench_.small_reference()), paper);
      add("Fig. 5", what + ", against the same draws searched to the end", lab, mean_lab_delta_e(*early, *whole), none);
    }
  }

  /// Shares of a picture's time at K = 200.
  void steps() {
    if (error_ || !go_on("Fig. 10")) return;
    double took[3] = {};
    for (const SamplingSteps step : {SamplingSteps::balance, SamplingSteps::draws, SamplingSteps::all}) {
      auto device = ImageSamplerDevice::create(bench_.luminaire().light_field.geometry(),
                                               {.method = Method::position_dependent}, step);
      if (!device) return stop_at(device.error());
      if (Status set = (*device)->set_cells(bench_.luminaire().light_field); !set) return stop_at(set.error());
      std::vector<double> e;
      const auto s = timed_evaluation(**device, bench_.frame().receivers, 5, e);
      if (!s) return stop_at(s.error());
      took[static_cast<int>(step) - 1] = 1e3 * *s;
    }
    constexpr const char* share = "share of the kernel's time, %";
    add("Fig. 10", "K = 200: the balance A_m (paper: of a frame with shadows)", share, 100 * took[0] / took[2], 5.3);
    add("Fig. 10", "K = 200: drawing samples", share, 100 * (took[1] - took[0]) / took[2], 33.6);
    add("Fig. 10", "K = 200: weighing and summing them (paper: shading)", share, 100 * (took[2] - took[1]) / took[2],
        31.9);
    add("Fig. 10", "K = 200: all", time, took[2], none);
  }

  /// Against scalar searches through the tables, with the same draws.
  void plain() {
    if (error_ || !go_on("plain transcription")) return;
    auto device = ImageSamplerDevice::create(bench_.luminaire().light_field.geometry(),
                                             {.method = Method::position_dependent}, SamplingSteps::all, true);
    if (!device) return stop_at(device.error());
    if (Status set = (*device)->set_cells(bench_.luminaire().light_field); !set) return stop_at(set.error());
    const auto point = bench_.judge(**device, 3);
    if (!point) return stop_at(point.error());
    add("kernel", "position-dependent, K = 200, with scalar searches: the same draws", time, point->time_ms, none);
  }

  std::vector<FigureRow> rows;
  const std::optional<Error>& error() const { return error_; }

 private:
  bool go_on(const char* figure) {
    if (progress_(0, bench_.luminaire().name + ", " + figure)) return true;
    error_ = study_stopped().value();
    return false;
  }
  void stop_at(const Error& error) { error_ = error; }
  void add(const char* figure, const std::string& what, const char* quantity, double ours, double paper) {
    rows.push_back({figure, bench_.luminaire().name, what, quantity, ours, paper});
  }

  const StudyBench& bench_;
  const StudyProgress& progress_;
  std::optional<Error> error_;
};

void bike_figures(Figures& figures, bool quick) {
  const MethodSettings dynamic{.method = Method::position_dependent, .samples = 200};
  figures.searches(dynamic);
  figures.kernel("Fig. 9", "K = 200, no bound", dynamic, {.time_ms = 1000 / 11.6});
  MethodSettings s = dynamic;
  s.k_max = 7;
  figures.kernel("Fig. 9", "K = 200, K_max = 7 (paper: ΔE between the two)", s, {0.63, 1000 / 13.5});

  s = dynamic;
  for (const auto& [samples, time_ms] : {std::pair(63.0, 62.0), {1000.0, 359.0}}) {
    s.samples = samples;
    figures.kernel("Fig. 11", "position-dependent, K = " + std::to_string(int(samples)), s, {.time_ms = time_ms});
  }
  const double lights = quick ? 10000 : 63000;
  figures.kernel("Fig. 11", "precomputed-lights, " + std::to_string(int(lights)) + " (paper: 63000)",
                 {.method = Method::precomputed_lights, .samples = lights}, {.time_ms = 4821});

  s.samples = 252;
  figures.kernel("Fig. 12", "importance, K = 252", s, {1.4, 118});
  s.method = Method::uniform_box;
  figures.kernel("Fig. 12", "uniform, K = 252", s, {3.4, 84});
  s.samples = 1008;
  figures.kernel("Fig. 12", "uniform, K = 1008", s, {1.4, 201});
  figures.plain();
}

void car1_figures(Figures& figures) {
  for (const double samples : {20.0, 50.0, 200.0, 1000.0}) {
    MethodSettings s{.method = Method::position_dependent, .samples = samples};
    const std::string k = ", K = " + std::to_string(int(samples));
    figures.kernel("Fig. 8", "Halton" + k, s);
    s.sequence = PointSequence::twister;
    figures.kernel("Fig. 8", "Mersenne twister" + k, s);
  }
  struct Convergence {
    double samples, time_ms, lab;
  };
  for (const Convergence& c : {Convergence{100, 50, 1.12}, {200, 84, 0.84}, {400, 149, 0.53}})
    figures.kernel("Fig. 13", "K = " + std::to_string(int(c.samples)) + " (paper: close-up)",
                   {.method = Method::position_dependent, .samples = c.samples}, {c.lab, c.time_ms});
}

/// The time at which a ladder reaches an error, by lines in the logarithms.
struct Reached {
  double time_ms;
  const char* beyond;  ///< said of a time that no two points hold between them, else empty
};
std::optional<Reached> time_at(std::vector<StudyPoint> ladder, double error) {
  std::ranges::sort(ladder, {}, &StudyPoint::time_ms);
  if (ladder.size() < 2) return std::nullopt;
  const auto reached = std::ranges::find_if(ladder.begin() + 1, ladder.end() - 1,
                                            [&](const StudyPoint& p) { return p.rel_rmse <= error; });
  const StudyPoint &a = *(reached - 1), &b = *reached;
  const double x0 = std::log(a.time_ms), x1 = std::log(b.time_ms);
  const double y0 = std::log(a.rel_rmse), y1 = std::log(b.rel_rmse);
  if (!(y1 < y0)) return std::nullopt;
  const char* beyond = "";
  if (b.rel_rmse > error) beyond = " (beyond the ladder, by its last slope)";
  if (a.rel_rmse < error) beyond = " (beyond the ladder's start, by its first slope)";
  return Reached{std::exp(x0 + (std::log(error) - y0) / (y1 - y0) * (x1 - x0)), beyond};
}

}  // namespace

Result<std::vector<FigureRow>> paper_figures(const StudyBench& bench, bool quick, const StudyProgress& progress) {
  if (!bench.luminaire().of_table_1) return std::vector<FigureRow>{};
  Figures figures(bench, progress);
  if (bench.luminaire().name == "bike") bike_figures(figures, quick);
  if (bench.luminaire().name == "car1") car1_figures(figures);
  if (bench.luminaire().name == "car2") figures.steps();
  if (figures.error()) return tl::unexpected(*figures.error());
  return std::move(figures.rows);
}

std::vector<FigureRow> equal_error_rows(const std::vector<StudyPoint>& points, const std::string& luminaire) {
  const auto ladder_of = [&](Method method) {
    std::vector<StudyPoint> ladder;
    for (const StudyPoint& p : points)
      if (p.method == method && p.luminaire == luminaire) ladder.push_back(p);
    return ladder;
  };
  std::vector<FigureRow> rows;
  for (const double error : {0.005, 0.001}) {
    double ours = HUGE_VAL;
    for (const StudyPoint& p : ladder_of(Method::closed_form))
      if (p.rel_rmse <= error) ours = std::min(ours, p.time_ms);
    for (const Method method : {Method::position_dependent, Method::uniform_box}) {
      const auto theirs = time_at(ladder_of(method), error);
      if (!theirs || !std::isfinite(ours)) continue;
      char what[160];
      std::snprintf(what, sizeof what, "%s over closed-form at %.1f %% relative RMSE%s",
                    std::string(to_string(method)).c_str(), 100 * error, theirs->beyond);
      rows.push_back({"equal error", luminaire, what, "ratio of kernel times", theirs->time_ms / ours, none});
    }
  }
  return rows;
}

}  // namespace lumifield
