#include "app/session/pass_by_pass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/session/scan_session.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/double_bench.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

using testing::Contains;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int width = 160, height = 120;

/// Exposures of a pass up to its third cell: dark set, reference cell, cells.
constexpr int three_cells = (1 + 1 + 3) * 3;

/// What a session told.
struct Told {
  std::vector<PassStored> passes;
  std::vector<CellIndex> cells;
  std::vector<std::string> notices, troubles;
  Result<ScanSummary> summary;
  ScanKept kept;
};

class PassByPassTest : public support::TemporaryFolder {
 protected:
  PassByPassTest() {
    request_.bench = test::developed_bench();
    request_.bench.filter.change = PassChange::by_operator;
    request_.plan = test::developed_plan();
    request_.out = folder_ / "lamp.lumi";
    request_.devices = doubles_.devices();
  }
  /// Runs a session; `at` sees every event. Somebody who is there goes on after every pause.
  Told scan(const std::function<void(ScanSession&, const SessionEvent&)>& at = {}) {
    Told told;
    auto session = ScanSession::start(request_);
    EXPECT_TRUE(session) << session.error().message();
    while (auto event = (*session)->next_event()) {
      if (at) at(**session, *event);
      if (auto* pass = std::get_if<PassStored>(&*event)) told.passes.push_back(*pass);
      if (auto* cell = std::get_if<CellStored>(&*event)) told.cells.push_back(cell->entry.cell);
      if (auto* notice = std::get_if<Notice>(&*event)) told.notices.push_back(notice->text);
      const auto* progress = std::get_if<ScanProgress>(&*event);
      if (!progress || progress->state != ScanState::paused) continue;
      told.troubles.push_back(progress->trouble);
      (*session)->resume();
    }
    told.summary = (*session)->wait();
    told.kept = (*session)->kept();
    request_.resume = true;
    return told;
  }
  int half_cells() const {
    const auto report = check_dataset(request_.out);
    EXPECT_TRUE(report && report->problems.empty());
    return report ? report->half_cells : -1;
  }
  std::vector<std::vector<float>> values() const {
    const auto dataset = read_dataset(request_.out);
    EXPECT_TRUE(dataset) << dataset.error().message();
    std::vector<std::vector<float>> values;
    for (const CellEntry& entry : dataset->index.manifest.cells)
      values.push_back(dataset->light_field.cell(entry.cell)->value);
    return values;
  }

  test::DoubleBench doubles_{width, height};
  ScanRequest request_;
};

TEST_F(PassByPassTest, AScanByHandIsTheScanOfAStageThatChangesThePass) {
  request_.attended = true;
  const Told told = scan();
  ASSERT_TRUE(told.summary) << told.summary.error().message();
  EXPECT_THAT(told.troubles, Contains("slide: the pass 'positive' is taken; put in the slide 'negative', then go on"));
  ASSERT_EQ(told.passes.size(), 6U);
  EXPECT_EQ(told.cells.size(), 6U);
  EXPECT_TRUE(told.summary->coverage.complete());
  EXPECT_FALSE(fs::exists(request_.out / "halves"));
  const auto by_hand = values();
  // The first pass alone adds more light than both, the second being negative.
  EXPECT_EQ(told.passes[0].pass, "positive");
  ASSERT_TRUE(told.passes[0].image);
  EXPECT_GT(told.passes[0].image->value[200], 1.05F * by_hand[0][200]);

  request_.bench.filter.change = PassChange::stage;
  request_.out = folder_ / "stage.lumi";
  request_.resume = false;
  ASSERT_TRUE(scan().summary);
  EXPECT_EQ(values(), by_hand);
}

TEST_F(PassByPassTest, WithoutAnybodyThereItWaitsForTheNextRun) {
  Told told = scan();
  ASSERT_FALSE(told.summary);
  EXPECT_EQ(told.summary.error().kind, ErrorKind::waiting);
  EXPECT_EQ(half_cells(), 6);
  EXPECT_EQ(told.kept.half_cells, 6);
  EXPECT_EQ(told.kept.cells, 0);
  EXPECT_TRUE(told.cells.empty());

  request_.accept_drift = true;  // these filters read alike
  told = scan();
  ASSERT_TRUE(told.summary) << told.summary.error().message();
  EXPECT_TRUE(told.passes.empty());
  EXPECT_EQ(told.cells.size(), 6U);
  EXPECT_EQ(half_cells(), 0);
  EXPECT_THAT(told.notices, Contains("of 6 cells the pass 'positive' is there"));
  EXPECT_THAT(told.notices, Contains("the slide 'negative' is taken to be in"));
  const auto drift = told.summary->references;
  ASSERT_FALSE(drift.empty());
  EXPECT_EQ(drift.front().pass, 1);
}

TEST_F(PassByPassTest, AWindowThatGoesOnShowsThePassThatIsThere) {
  ASSERT_FALSE(scan().summary);
  request_.attended = true;
  const Told told = scan();
  ASSERT_TRUE(told.summary) << told.summary.error().message();
  EXPECT_EQ(told.passes.size(), 6U);
  for (const PassStored& pass : told.passes) EXPECT_TRUE(pass.image);
}

TEST_F(PassByPassTest, StoppedBeforeTheFirstHalfCellNothingIsLeft) {
  doubles_.hold_exposures_after(three_cells / 5);
  const Told told = scan([&](ScanSession& session, const SessionEvent& event) {
    if (!std::holds_alternative<ScanPrediction>(event)) return;
    session.stop();
    doubles_.hold_exposures(false);
  });
  ASSERT_FALSE(told.summary);
  EXPECT_EQ(told.summary.error().kind, ErrorKind::stopped);
  EXPECT_THAT(told.summary.error().message(), Not(HasSubstr("and then")));
  EXPECT_FALSE(fs::exists(request_.out)) << told.summary.error().message();
}

TEST_F(PassByPassTest, AStoppedPassGoesOnWithTheCellsThatAreMissing) {
  doubles_.hold_exposures_after(three_cells);
  Told told = scan([&, taken = 0](ScanSession& session, const SessionEvent& event) mutable {
    if (!std::holds_alternative<PassStored>(event) || ++taken != 2) return;
    session.stop();
    doubles_.hold_exposures(false);
  });
  ASSERT_FALSE(told.summary);
  EXPECT_EQ(told.summary.error().kind, ErrorKind::stopped);
  const int before = half_cells();
  ASSERT_GE(before, 2);
  ASSERT_LT(before, 6);
  told = scan();
  EXPECT_EQ(told.passes.size(), static_cast<std::size_t>(6 - before));
  EXPECT_EQ(half_cells(), 6);
}

TEST_F(PassByPassTest, ADamagedHalfIsMeasuredAgain) {
  ASSERT_FALSE(scan().summary);
  const fs::path file = request_.out / "halves" / "r01_c02.0.raw";
  std::string bytes = support::read_text(file);
  bytes[bytes.size() / 2] ^= 1;
  support::write_text(file, bytes);
  const Told told = scan();
  EXPECT_EQ(told.summary.error().kind, ErrorKind::waiting);
  EXPECT_THAT(told.notices, Contains(HasSubstr("r01_c02.0.raw: half of cell (1, 2): is not what was written")));
  ASSERT_EQ(told.passes.size(), 1U);
  EXPECT_EQ(told.passes[0].cell, (CellIndex{1, 2}));
  EXPECT_EQ(half_cells(), 6);
}

TEST_F(PassByPassTest, ACellMayBeTakenAgainInTheLastPassUntilTheScanEnds) {
  request_.attended = true;
  const Told told = scan([&, once = false](ScanSession& session, const SessionEvent& event) mutable {
    const auto* progress = std::get_if<ScanProgress>(&event);
    if (progress && progress->state == ScanState::paused) doubles_.hold_exposures_after(three_cells);
    if (!std::holds_alternative<CellStored>(event) || std::exchange(once, true)) return;
    const std::vector<CellIndex> again{std::get<CellStored>(event).entry.cell};
    session.retake(again);
    doubles_.hold_exposures(false);
  });
  ASSERT_TRUE(told.summary) << told.summary.error().message();
  EXPECT_EQ(told.cells.size(), 7U);
  EXPECT_EQ(told.passes.size(), 6U);
  EXPECT_FALSE(fs::exists(request_.out / "halves"));
}

TEST_F(PassByPassTest, WholeCellsThatAreTakenAgainAskForEverySlide) {
  request_.attended = true;
  ASSERT_TRUE(scan().summary);
  request_.retake = {{0, 1}};
  // Stopped between the passes, the retake is gone on with.
  int slides = 0;  // the first is asked for, too, as the last of before is in
  Told told = scan([&](ScanSession& session, const SessionEvent& event) {
    const auto* progress = std::get_if<ScanProgress>(&event);
    if (progress && progress->state == ScanState::paused && ++slides == 1) session.stop();
  });
  ASSERT_FALSE(told.summary);
  ASSERT_EQ(told.passes.size(), 1U);
  EXPECT_FALSE(told.passes[0].image);  // the cell that is whole stays in the preview
  EXPECT_EQ(half_cells(), 1);
  request_.retake.clear();
  told = scan();
  ASSERT_TRUE(told.summary) << told.summary.error().message();
  EXPECT_EQ(told.cells, std::vector<CellIndex>({{0, 1}}));
  EXPECT_EQ(half_cells(), 0);
}

TEST_F(PassByPassTest, AScanThatWasBegunByStageIsNotGoneOnWithByHand) {
  ASSERT_FALSE(scan().summary);
  request_.bench.filter.change = PassChange::stage;
  const auto refused = ScanSession::start(request_);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("bench: filter.change: is \"stage\", but the dataset was begun with "
                                                   "\"operator\""));
}

TEST_F(PassByPassTest, AHalfThatIsGoneIsAnErrorThatSaysWhatToDo) {
  ASSERT_FALSE(scan().summary);
  const auto manifest = read_dataset_index(request_.out);
  ASSERT_TRUE(manifest);
  auto passes = PassByPass::open(request_.bench, request_.plan, request_.out, manifest->manifest);
  ASSERT_TRUE(passes);
  fs::remove(request_.out / "halves" / "r00_c00.0.raw");
  RawCell last;
  last.cell = {0, 0};
  last.passes.resize(1);
  last.passes[0].name = "negative";
  EXPECT_TRUE(passes->is_last(last));
  const auto whole = passes->whole(last);
  ASSERT_FALSE(whole);
  EXPECT_THAT(whole.error().message(), HasSubstr("r00_c00.0.raw"));
}

}  // namespace
}  // namespace lumifield
