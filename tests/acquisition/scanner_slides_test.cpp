#include <algorithm>
#include <gmock/gmock.h>

#include "tests/support/scanner_fixture.h"

namespace lumifield {
namespace {

using test::ScannerTest;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Six cells; each filter is on a slide of its own, at one place, put in by hand.
class ScannerSlides : public ScannerTest {
 protected:
  ScannerSlides() {
    bench.filter.change = PassChange::by_operator;
    bench.filter.passes[1].offset_mm = {0, 0};
    scanner.obey(control);
  }
  /// Somebody is there: at each slide asked for, `change` acts, then the scan goes on. The other filter lets less light
  /// through.
  void attend() {
    attend([this](const std::string&) { lamp_dn_per_s = 7'000; });
  }
  void attend(std::function<void(const std::string&)> change) {
    control.attend();
    sink.on_progress = [this, change](const ScanProgress& p) {
      if (p.state != ScanState::paused) return;
      asked.push_back(p.slide);
      places_at_pauses.push_back(stage.at);
      change(p.slide);
      control.resume();
    };
  }
  Status run_left(const std::set<CellIndex>& done, const PassCells& taken) {
    const auto steps = make_scan_plan(bench, plan, done, taken);
    EXPECT_TRUE(steps) << steps.error().message();
    return scanner.run(*steps, sink, stop.get_token());
  }
  std::vector<std::string> passes_taken() const {
    std::vector<std::string> passes;
    for (const RawCell& cell : sink.cells) {
      EXPECT_EQ(cell.passes.size(), 1U);
      passes.push_back(cell.passes.front().name);
    }
    return passes;
  }

  ScanControl control;
  std::vector<std::string> asked;
  std::vector<Vec2> places_at_pauses;
};

TEST_F(ScannerSlides, OneWhoseCellsNobodyTakesAnyMoreHasFailed) {
  std::stop_source abandon;
  attend([&](const std::string&) { abandon.request_stop(); });
  const auto steps = make_scan_plan(bench, plan);
  ASSERT_TRUE(steps);
  const Status status = scanner.run(*steps, sink, stop.get_token(), abandon.get_token());
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message(), HasSubstr("nobody takes its cells"));
  EXPECT_EQ(scanner.state(), ScanState::failed);
}

TEST_F(ScannerSlides, PassesAreTheOuterLoopAndTheSlideIsAskedForBetween) {
  attend();
  ASSERT_TRUE(run());
  EXPECT_THAT(asked, ElementsAre("negative"));
  EXPECT_THAT(places_at_pauses, ElementsAre(dark_target_mm(bench)));  // behind the opaque patch, out of the way
  std::vector<std::string> passes(6, "positive");
  passes.resize(12, "negative");
  EXPECT_EQ(passes_taken(), passes);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(sink.cells[k].cell, sink.cells[k + 6].cell);
  EXPECT_EQ(stage.homings, 2);

  // Each pass has its own dark set and refers to its own first reading.
  EXPECT_EQ(sink.cells.front().dark, sink.cells[5].dark);
  EXPECT_NE(sink.cells.front().dark, sink.cells.back().dark);
  EXPECT_EQ(sink.cells.back().dark->block, 1);
  ASSERT_EQ(sink.references.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(sink.references[k].pass, k < 2 ? 0 : 1);
    EXPECT_NEAR(sink.references[k].signal_dn_per_s, k < 2 ? 20'000 : 7'000, 40);
    EXPECT_EQ(sink.references[k].drift, 0);
  }
  EXPECT_NE(sink.cells.front().reference_dn_per_s, sink.cells.back().reference_dn_per_s);
  EXPECT_EQ(sink.reports.back().state, ScanState::done);
  EXPECT_EQ(sink.reports.back().cells_done, 6);
  EXPECT_EQ(sink.reports.back().pass, "negative");
}

TEST_F(ScannerSlides, CellsDoneAreThoseOfThePassThatIsIn) {
  attend();
  std::vector<int> done;
  const auto answer = sink.on_progress;
  sink.on_progress = [&](const ScanProgress& p) {
    answer(p);
    if (p.state == ScanState::exposing && p.cell) done.push_back(p.cells_done);
  };
  ASSERT_TRUE(run());
  EXPECT_THAT(done, ElementsAre(0, 1, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5));
}

TEST_F(ScannerSlides, WithoutAnybodyThereItEndsParkedAndSaysWhatToDo) {
  const Status ended = run();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::waiting);
  EXPECT_EQ(ended.error().message(), "slide: the pass 'positive' is taken; put in the slide 'negative'");
  EXPECT_EQ(sink.cells.size(), 6U);
  EXPECT_EQ(stage.at, dark_target_mm(bench));
  EXPECT_EQ(sink.reports.back().state, ScanState::stopped);
  EXPECT_THAT(sink.notices, Contains("the slide 'positive' is taken to be in"));
}

TEST_F(ScannerSlides, AResumedScanTakesWhatIsMissingOfEachPass) {
  attend();
  const std::set<CellIndex> most = all_but({0, 1});
  ASSERT_TRUE(run_left({{1, 2}}, {most, {{1, 0}}}));
  EXPECT_THAT(asked, ElementsAre("negative"));
  ASSERT_EQ(sink.cells.size(), 5U);
  EXPECT_EQ(sink.cells[0].cell, (CellIndex{0, 1}));
  EXPECT_THAT(passes_taken(), ElementsAre("positive", "negative", "negative", "negative", "negative"));
  for (const RawCell& cell : sink.cells) EXPECT_NE(cell.cell, (CellIndex{1, 2}));
}

TEST_F(ScannerSlides, APassThatIsThereIsNotAskedFor) {
  std::set<CellIndex> all = all_but({0, 1});
  all.insert({0, 1});
  scanner.refer_to({0, 10'000, 0, 0.032, 1});
  plan.reference.limit = 2;
  ASSERT_TRUE(run_left({}, {all, {}}));
  EXPECT_EQ(passes_taken(), std::vector<std::string>(6, "negative"));
  EXPECT_EQ(stage.homings, 1);
  EXPECT_NEAR(sink.references.front().drift, 1, 0.01);  // against this pass' first reading of an earlier scan
}

TEST_F(ScannerSlides, ACellIsTakenAgainInThePassThatIsIn) {
  attend();
  const auto answer = sink.on_progress;
  int moments = 0;
  sink.on_progress = [&](const ScanProgress& p) {
    answer(p);
    if (p.state != ScanState::delivering || p.cells_done != 3 || !p.cell) return;
    if (++moments > 2) return;
    const std::vector<CellIndex> again{{0, 1}};
    control.retake(again);
  };
  ASSERT_TRUE(run());
  const auto count = [&](const char* pass) {
    return std::ranges::count_if(sink.cells, [&](const RawCell& c) {
      return c.cell == CellIndex{0, 1} && c.passes[0].name == pass;
    });
  };
  EXPECT_EQ(count("positive"), 2);
  EXPECT_EQ(count("negative"), 2);
  EXPECT_EQ(sink.cells.size(), 14U);
}

TEST_F(ScannerSlides, ACellThatWasWholeBeforeIsRefusedWithAReason) {
  attend();
  const std::vector<CellIndex> again{{1, 2}};
  control.retake(again);
  ASSERT_TRUE(run({{1, 2}}));
  EXPECT_EQ(sink.cells.size(), 10U);
  EXPECT_THAT(sink.notices, Contains(HasSubstr("cell (1, 2) is not taken again: it was whole before this scan")));
}

TEST_F(ScannerSlides, ASlideThatWasNotChangedIsAskedForOnceMore) {
  attend([&](const std::string&) {
    if (asked.size() == 2) lamp_dn_per_s = 7'000;
  });
  ASSERT_TRUE(run());
  EXPECT_THAT(asked, ElementsAre("negative", "negative"));
  EXPECT_THAT(sink.reports, Contains(testing::Field(&ScanProgress::trouble,
                                                    HasSubstr("it reads as through 'positive'; put in the slide "
                                                              "'negative', then go on"))));
  ASSERT_EQ(sink.references.size(), 4U);
  EXPECT_NEAR(sink.references[2].signal_dn_per_s, 7'000, 40);
}

TEST_F(ScannerSlides, ALampThatDriftedDoesNotHideASlideThatWasNotChanged) {
  attend([&](const std::string&) {
    if (asked.size() == 3) lamp_dn_per_s = 7'000;
  });
  const auto answer = sink.on_progress;
  sink.on_progress = [&](const ScanProgress& p) {
    answer(p);
    if (asked.empty() && p.cells_done == 3) lamp_dn_per_s = 20'000 * (1 + 1.5 * plan.reference.limit);
  };
  ASSERT_TRUE(run());
  EXPECT_THAT(asked, ElementsAre("", "negative", "negative"));
}

TEST_F(ScannerSlides, AResumedScanAsksForTheSlideThatIsNotIn) {
  attend();
  std::set<CellIndex> all = all_but({0, 1});
  all.insert({0, 1});
  scanner.refer_to({0, 20'000, 0, 0.032, 0});
  scanner.refer_to({0, 7'000, 0, 0.032, 1});
  ASSERT_TRUE(run_left({}, {all, {}}));
  EXPECT_THAT(asked, ElementsAre("negative"));
  ASSERT_EQ(sink.cells.size(), 6U);
  for (const ReferenceReading& reading : sink.references) EXPECT_NEAR(reading.drift, 0, 0.01);
}

TEST_F(ScannerSlides, TheOperatorsWordCountsWhereFiltersReadAlike) {
  attend([](const std::string&) {});
  ASSERT_TRUE(run());
  EXPECT_THAT(asked, ElementsAre("negative", "negative"));
  EXPECT_EQ(sink.cells.size(), 12U);
}

TEST_F(ScannerSlides, WithoutAnybodyThereAnUnchangedSlideEndsTheScanUnlessAccepted) {
  std::set<CellIndex> all = all_but({0, 1});
  all.insert({0, 1});
  scanner.refer_to({0, 20'000, 0, 0.032, 0});
  const Status ended = run_left({}, {all, {}});
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::waiting);
  EXPECT_THAT(ended.error().remedy, HasSubstr("put in the slide 'negative', or say by --accept-drift that it is in"));
  EXPECT_TRUE(sink.cells.empty());
  EXPECT_TRUE(sink.references.empty());

  Scanner trusting{camera, stage, bench, plan, clock};
  trusting.refer_to({0, 20'000, 0, 0.032, 0});
  trusting.accept_drift();
  ASSERT_TRUE(trusting.run(*make_scan_plan(bench, plan, {}, {all, {}}), sink, stop.get_token()));
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerSlides, StopWhileASlideIsAskedForEndsTheScan) {
  control.attend();
  sink.on_progress = [&](const ScanProgress& p) {
    if (p.state == ScanState::paused) stop.request_stop();
  };
  const Status ended = run();
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().kind, ErrorKind::stopped);
  EXPECT_EQ(sink.cells.size(), 6U);
}

TEST_F(ScannerSlides, StepsLostInALaterPassAreTakenAgainInThatPassOnly) {
  bench.stage.check_home = true;
  attend();
  const auto answer = sink.on_progress;
  bool slipped = false;
  sink.on_progress = [&](const ScanProgress& p) {
    answer(p);
    if (slipped || p.pass != "negative" || p.cells_done != 4) return;
    slipped = true;
    stage.slip_mm = {0.5, 0};
  };
  ASSERT_TRUE(run());
  EXPECT_THAT(asked, ElementsAre("negative", ""));  // the slip pauses too
  const auto passes = passes_taken();
  EXPECT_EQ(std::ranges::count(passes, "positive"), 6);
  EXPECT_EQ(std::ranges::count(passes, "negative"), 12);
}

TEST(ScanPlanBySlides, FiltersMayStandAnywhereButNotAtTheOpaquePatch) {
  Bench bench = test::bell_bench();
  bench.filter.passes[1].offset_mm = {0, 0};
  EXPECT_FALSE(make_scan_plan(bench, test::bell_plan()));
  bench.filter.change = PassChange::by_operator;
  EXPECT_TRUE(make_scan_plan(bench, test::bell_plan()));
  bench.filter.passes[1].offset_mm = {0, 60};
  const auto close = make_scan_plan(bench, test::bell_plan());
  ASSERT_FALSE(close);
  EXPECT_THAT(close.error().what, HasSubstr("filter 'negative' and the opaque patch"));
}

TEST(ScanPlanBySlides, EachPassHasItsReferenceReadingsAndDarkSetsNumberedOn) {
  Bench bench = test::bell_bench();
  bench.filter.change = PassChange::by_operator;
  const auto scan = make_scan_plan(bench, test::bell_plan());
  ASSERT_TRUE(scan) << scan.error().message();
  EXPECT_EQ(scan->cells, 63);
  int pass = -1, block = 0, cells = 0;
  for (const ScanStep& step : scan->steps) {
    if (const auto* slide = std::get_if<SlideStep>(&step)) pass = slide->pass;
    if (const auto* dark = std::get_if<DarkStep>(&step)) {
      EXPECT_EQ(dark->block, block++);
    }
    if (const auto* reference = std::get_if<ReferenceStep>(&step)) {
      EXPECT_EQ(reference->stage_mm, reference_target_mm(bench, test::bell_plan(), pass));
    }
    if (const auto* cell = std::get_if<CellStep>(&step)) {
      ++cells;
      ASSERT_THAT(cell->pass_order, ElementsAre(pass));
      EXPECT_EQ(cell->stage_mm.size(), 1U);
    }
  }
  EXPECT_EQ(pass, 1);
  EXPECT_EQ(block, 6);
  EXPECT_EQ(cells, 126);
  EXPECT_TRUE(std::holds_alternative<SlideStep>(scan->steps.front()));
}

}  // namespace
}  // namespace lumifield
