#include <algorithm>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using test::ScannerTest;

class ScannerControlTest : public ScannerTest {
 protected:
  ScannerControlTest() { scanner.obey(control); }
  /// Calls `what` once, when the scan is in `state` with `cells` cells done.
  void when(ScanState state, int cells, std::function<void()> what) {
    sink.on_progress = [this, state, cells, what = std::move(what), once = false](const ScanProgress& p) mutable {
      if (p.state == ScanState::paused && !stays_paused) control.resume();
      if (once || p.state != state || p.cells_done != cells) return;
      once = true;
      what();
    };
  }
  std::vector<CellIndex> cells_taken() const {
    std::vector<CellIndex> cells;
    for (const RawCell& cell : sink.cells) cells.push_back(cell.cell);
    return cells;
  }

  ScanControl control;
  bool stays_paused = false;
};

TEST_F(ScannerControlTest, PausesBetweenTwoCellsAndReadsTheReferenceBeforeGoingOn) {
  when(ScanState::exposing, 2, [&] { control.pause(); });
  ASSERT_TRUE(run());
  EXPECT_EQ(sink.cells.size(), 6U);
  const auto states = sink.states();
  EXPECT_EQ(std::ranges::count(states, ScanState::paused), 1);
  const auto paused = std::ranges::find(sink.reports, ScanState::paused, &ScanProgress::state);
  EXPECT_EQ(paused->cells_done, 3);  // the cell at hand was finished
  // First, after the pause, last.
  ASSERT_EQ(sink.references.size(), 3U);
  EXPECT_EQ(sink.references[1].cells_done, 3);
  EXPECT_EQ(states.back(), ScanState::done);
}

TEST_F(ScannerControlTest, AReadingAfterAPauseCountsTheCellsOfThisScan) {
  when(ScanState::exposing, 3, [&] { control.pause(); });
  ASSERT_TRUE(run({{0, 1}, {1, 2}}));
  const auto paused = std::ranges::find(sink.reports, ScanState::paused, &ScanProgress::state);
  EXPECT_EQ(paused->cells_done, 4);
  ASSERT_EQ(sink.references.size(), 3U);
  EXPECT_EQ(sink.references[1].cells_done, 2);
}

TEST_F(ScannerControlTest, APauseIsNotIdleTime) {
  when(ScanState::exposing, 1, [&] { control.pause(); });
  const auto resume = sink.on_progress;
  sink.on_progress = [&, resume](const ScanProgress& p) {
    if (p.state == ScanState::paused) clock.now += 1000;
    resume(p);
  };
  ASSERT_TRUE(run());
  const ScanTiming& t = scanner.timing();
  EXPECT_NEAR(t.paused_s, 1000, 1e-9);
  EXPECT_LT(t.total_s - t.paused_s, 100);
  EXPECT_LT(t.idle_share(), 0.05);
}

TEST_F(ScannerControlTest, NoCellIsTakenAgainBeforeTheReferenceIsRead) {
  const std::vector<CellIndex> again{{0, 0}};
  control.retake(again);
  ASSERT_TRUE(run());
  const auto first_cell = std::ranges::find_if(sink.places_seen, [](const auto& p) { return p.starts_with("cell"); });
  const auto reference =
      std::ranges::find_if(sink.places_seen, [](const auto& p) { return p.starts_with("reference"); });
  EXPECT_LT(reference - sink.places_seen.begin(), first_cell - sink.places_seen.begin());
  EXPECT_EQ(sink.cells.size(), 7U);
}

TEST_F(ScannerControlTest, SaysWhatItWorksOn) {
  ASSERT_TRUE(run(all_but({0, 1})));
  for (const ScanProgress& p : sink.reports) {
    if (p.state != ScanState::exposing) continue;
    EXPECT_EQ(p.cell.has_value(), p.place.starts_with("cell")) << p.place;
    EXPECT_EQ(p.cell.value_or(CellIndex{0, 1}), (CellIndex{0, 1}));
  }
}

TEST_F(ScannerControlTest, StopEndsAPause) {
  stays_paused = true;
  when(ScanState::exposing, 2, [&] { control.pause(); });
  auto inner = std::exchange(sink.on_progress, {});
  sink.on_progress = [&, inner](const ScanProgress& p) {
    inner(p);
    if (p.state == ScanState::paused) stop.request_stop();
  };
  const Status status = run();
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::stopped);
  EXPECT_EQ(sink.cells.size(), 3U);
}

TEST_F(ScannerControlTest, TakesCellsAgainNextAndOnceEach) {
  when(ScanState::exposing, 2, [&] {
    const std::vector<CellIndex> again{{0, 1}, {0, 0}, {0, 1}, {7, 7}};
    control.retake(again);
  });
  ASSERT_TRUE(run());
  const auto cells = cells_taken();
  ASSERT_EQ(cells.size(), 8U);
  EXPECT_EQ(cells[3], (CellIndex{0, 1}));
  EXPECT_EQ(cells[4], (CellIndex{0, 0}));
  EXPECT_EQ(sink.reports.back().cells_total, 6);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
  for (const RawCell& cell : sink.cells) EXPECT_NE(cell.dark, nullptr);
}

TEST_F(ScannerControlTest, TakesCellsAgainThatWereAskedForAtTheLastMoment) {
  when(ScanState::delivering, 6, [&] {
    const std::vector<CellIndex> again{{1, 2}};
    control.retake(again);
  });
  ASSERT_TRUE(run());
  EXPECT_EQ(cells_taken().back(), (CellIndex{1, 2}));
  EXPECT_EQ(sink.cells.size(), 7U);
}

TEST_F(ScannerControlTest, ARetakeWaitsForThePauseToEnd) {
  stays_paused = true;
  std::vector<CellIndex> before_pause;
  when(ScanState::exposing, 1, [&] {
    control.pause();
    const std::vector<CellIndex> again{{0, 0}};
    control.retake(again);
  });
  auto inner = std::exchange(sink.on_progress, {});
  sink.on_progress = [&, inner](const ScanProgress& p) {
    inner(p);
    if (p.state != ScanState::paused) return;
    before_pause = cells_taken();
    control.resume();
  };
  ASSERT_TRUE(run());
  EXPECT_EQ(before_pause.size(), 2U);
  EXPECT_EQ(sink.cells.size(), 7U);
}

TEST_F(ScannerControlTest, ShowsEveryCompleteBracket) {
  ASSERT_TRUE(run(all_but({0, 1})));
  EXPECT_EQ(sink.places_seen.front(), "dark set 1");
  EXPECT_EQ(sink.places_seen.size(), 5U);  // dark, reference, two passes, reference
}

}  // namespace
}  // namespace lumifield
