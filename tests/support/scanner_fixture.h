#pragma once

#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <vector>

#include "acquisition/scan/scanner.h"
#include "tests/support/bench_doubles.h"
#include "tests/support/small_bench.h"

namespace lumifield::test {

/// Keeps everything a scan delivers; `busy_s` is the time that it blocks per cell.
class RecordingSink final : public ScanSink {
 public:
  explicit RecordingSink(ManualClock& manual_clock) : clock(manual_clock) {}
  void cell(RawCell raw) override {
    cells.push_back(std::move(raw));
    clock.now += busy_s;
  }
  void reference(const ReferenceReading& reading) override { references.push_back(reading); }
  void progress(const ScanProgress& progress) override {
    reports.push_back(progress);
    if (on_progress) on_progress(progress);
  }
  void notice(const std::string& text) override { notices.push_back(text); }
  void seen(const Bracket& bracket, const std::string& place, const Vec2& stage_mm) override {
    EXPECT_EQ(bracket.front().stage_mm, stage_mm);
    places_seen.push_back(place);
  }
  std::vector<ScanState> states() const {
    std::vector<ScanState> states;
    for (const ScanProgress& report : reports) states.push_back(report.state);
    return states;
  }

  ManualClock& clock;
  double busy_s = 0;
  std::function<void(const ScanProgress&)> on_progress;
  std::vector<RawCell> cells;
  std::vector<ReferenceReading> references;
  std::vector<ScanProgress> reports;
  std::vector<std::string> places_seen, notices;
};

/// Six cells, two passes, three exposures each; the lamp shines but behind the opaque patch.
class ScannerTest : public ::testing::Test {
 protected:
  ScannerTest() {
    camera.signal_dn_per_s = [this](const Vec2& at) { return at.y() > 45 ? 0.0 : lamp_dn_per_s; };
  }

  void TearDown() override {
    const std::vector<ScanState> states = sink.states();
    for (std::size_t k = 1; k < states.size(); ++k)
      EXPECT_TRUE(is_final(states[k - 1]) || can_follow(states[k - 1], states[k]))
          << to_string(states[k - 1]) << " → " << to_string(states[k]);
  }

  /// Leaves out all but one cell.
  static std::set<CellIndex> all_but(CellIndex kept) {
    std::set<CellIndex> done;
    for (int row = 0; row < 2; ++row)
      for (int column = 0; column < 3; ++column) done.insert({row, column});
    done.erase(kept);
    return done;
  }

  Status run(const std::set<CellIndex>& done = {}) {
    const auto steps = make_scan_plan(bench, plan, done);
    EXPECT_TRUE(steps) << steps.error().message();
    return scanner.run(*steps, sink, stop.get_token());
  }

  ManualClock clock;
  StageDouble stage{clock};
  CameraDouble camera{clock, stage};
  double lamp_dn_per_s = 20'000;
  Bench bench = test::small_bench();
  Plan plan = test::small_plan();
  RecordingSink sink{clock};
  std::stop_source stop;
  Scanner scanner{camera, stage, bench, plan, clock};
};

}  // namespace lumifield::test
