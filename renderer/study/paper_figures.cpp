#include "renderer/study/paper_figures.h"

#include <algorithm>
#include <cmath>

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
    const auto picture = [&](Inversion inversion, int depth) {
      MethodSettings s = settings;
      s.inversion = inversion;
      s.depth = depth;
      return bench_.small_picture(s);
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

}  // namespace

Result<std::vector<FigureRow>> paper_figures(const StudyBench& bench, bool quick, const StudyProgress& progress) {
  if (!bench.luminaire().of_table_1) return std::vector<FigureRow>{};
  Figures figures(bench, progress);
  if (bench.luminaire().name == "bike") bike_figures(figures, quick);
  if (bench.luminaire().name == "car1") car1_figures(figures);
  if (figures.error()) return tl::unexpected(*figures.error());
  return std::move(figures.rows);
}

}  // namespace lumifield
