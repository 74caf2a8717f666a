#include "app/cli/scan_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace lumifield {
namespace {

using testing::HasSubstr;
using testing::Not;

ScanProgress progress(ScanState state, int done, int before) {
  ScanProgress p;
  p.state = state, p.cells_done = done, p.cells_total = 63, p.cells_before = before;
  p.elapsed_s = 75, p.left_s = 9;
  return p;
}

ScanSummary summary(int before) {
  ScanSummary s;
  s.dataset = "lamp.lumi";
  s.coverage.measured = s.coverage.total = 63;
  s.cells_before = before;
  s.timing.total_s = 78;
  return s;
}

std::string printed(const std::vector<ScanProgress>& reports, const ScanSummary& end) {
  testing::internal::CaptureStderr();
  ProgressLine line;
  for (const ScanProgress& report : reports) line.show(report);
  line.done(end);
  return testing::internal::GetCapturedStderr();
}

TEST(ScanReport, ProgressNamesTheCellsThatWereThere) {
  EXPECT_EQ(progress_text(progress(ScanState::moving, 21, 0)),
            "[##########....................] 21 of 63 cells, 1:15 elapsed, 0:09 left, moving    ");
  EXPECT_THAT(progress_text(progress(ScanState::moving, 21, 20)), HasSubstr("21 of 63 cells, 20 there before, 1:15"));
  EXPECT_THAT(progress_text(progress(ScanState::stopped, 21, 0)), HasSubstr("21 of 63 cells, stopped after 1:15"));
}

TEST(ScanReport, TellsHowSteadyTheLampIs) {
  ScanProgress p = progress(ScanState::stabilising, 0, 0);
  p.stabilisation = {12345.6, std::nullopt, 0.005, 1800, 1800};
  EXPECT_THAT(progress_text(p),
              HasSubstr("0 of 63 cells, lamp at 12346 DN/s, spread — of 0.50 % allowed, 30:00 left at most, stabil"));
  std::vector<ScanProgress> reports{p, p};
  p.stabilisation->spread = 0.0123;
  p.stabilisation->left_s = 1500;
  reports.push_back(p);
  ScanSummary ended = summary(0);
  ended.references.push_back({});
  ended.references.back().stabilised = StabilisationEnd{400, 0.0041, true};
  const std::string text = printed(reports, ended);
  EXPECT_EQ(std::ranges::count(text, '\n'), 3) << text;  // the first, one for the next tenth of the time, the end
  EXPECT_THAT(text, HasSubstr("spread 1.23 % of 0.50 % allowed, 25:00 left"));
  EXPECT_THAT(summary_text(ended), HasSubstr("lamp      steady after 6:40: spread 0.41 %"));
  EXPECT_EQ(nlohmann::json::parse(summary_json(ended))["stabilisation"]["watched_s"], 400);
  ended.references.back().stabilised->steady = false;
  EXPECT_THAT(summary_text(ended), HasSubstr("NOT STEADY after 6:40"));
}

TEST(ScanReport, PredictsTimeAndRoom) {
  ScanPrediction scan{20, 75, 0, 3.6e6, 8e9};
  EXPECT_EQ(prediction_line(scan), "20 cells, about 1:15, up to 3.6 MB of 8000.0 MB that are free");
  scan.stabilisation_s = 1800;
  scan.free_bytes = 1e6;
  EXPECT_EQ(prediction_line(scan),
            "20 cells, about 1:15 once the lamp is steady (30:00 at most), up to 3.6 MB of 1.0 MB that are free: TOO "
            "LITTLE ROOM, free some");
  ScanSummary ended = summary(0);
  ended.prediction = scan;
  const auto json = nlohmann::json::parse(summary_json(ended))["prediction"];
  EXPECT_EQ(json["predicted_s"], 75);
  EXPECT_EQ(json["bytes"], 3.6e6);
  EXPECT_EQ(json["room"], false);
  scan.free_bytes.reset();
  EXPECT_THAT(prediction_line(scan), testing::EndsWith("up to 3.6 MB"));
}

TEST(ScanReport, PredictsWhatRecordedFramesTake) {
  ScanPrediction scan{20, 75, 0, 3e6, 8e6};
  scan.recording = RecordingPrediction{4e6, 8e6, true};
  EXPECT_THAT(prediction_line(scan),
              testing::EndsWith("3.0 MB of 8.0 MB that are free, recorded frames up to 4.0 MB more"));
  scan.recording->bytes = 6e6;
  EXPECT_THAT(prediction_line(scan), testing::EndsWith("up to 6.0 MB more: TOO LITTLE ROOM, free some"));
  scan.recording->on_same_disk = false;
  EXPECT_THAT(prediction_line(scan), testing::EndsWith("recorded frames up to 6.0 MB of 8.0 MB that are free there"));
  scan.recording->free_bytes = 5e6;
  EXPECT_THAT(prediction_line(scan), testing::EndsWith("of 5.0 MB that are free there: TOO LITTLE ROOM, free some"));
  const auto json = prediction_json(scan);
  EXPECT_EQ(json["recording"]["bytes"], 6e6);
  EXPECT_EQ(json["recording"]["free_bytes"], 5e6);
  EXPECT_EQ(json["room"], false);
  scan.recording->free_bytes.reset();
  EXPECT_THAT(prediction_line(scan), testing::EndsWith("recorded frames up to 6.0 MB"));
}

TEST(ScanReport, TheLastLineSaysDone) {
  const std::string text = printed(
      {progress(ScanState::moving, 62, 0), progress(ScanState::moving, 63, 0), progress(ScanState::done, 63, 0)},
      summary(0));
  EXPECT_THAT(text, testing::EndsWith("\n[##############################] 63 of 63 cells, done in 1:18\n"));
  EXPECT_THAT(printed({}, summary(40)), HasSubstr("63 of 63 cells, 40 there before, done in 1:18\n"));
  EXPECT_THAT(printed({}, summary(63)), HasSubstr("63 of 63 cells, done before\n"));
}

TEST(ScanReport, AScanThatEndsEarlySaysHowFarItCame) {
  const std::string text =
      printed({progress(ScanState::moving, 20, 0), progress(ScanState::failed, 20, 0)}, summary(0));
  EXPECT_THAT(text, HasSubstr("20 of 63 cells, failed after 1:15\n"));
}

TEST(ScanReport, HowToGoOnIsSaidWhereSomethingIsKept) {
  const Error fault{"alarm 1", "stage", "clear the way, then home"};
  const Error stopped{"stopped by the operator", "scan", {}, ErrorKind::stopped};
  EXPECT_EQ(go_on_text({0, 20, 0}, fault, true), "");
  EXPECT_EQ(go_on_text({5, 20, 0}, fault, false),
            "5 of 20 cells are kept; when that is mended, run again with --resume to go on");
  EXPECT_EQ(go_on_text({5, 20, 0}, fault, true),
            "5 of 20 cells are kept; when that is mended, run again with --resume to go on (the stage is homed first)");
  EXPECT_EQ(go_on_text({5, 20, 0}, stopped, true), "5 of 20 cells are kept; run again with --resume to go on");
  EXPECT_EQ(go_on_text({0, 20, 12}, stopped, true),
            "0 of 20 cells are kept, and one pass alone of 12 more; run again with --resume to go on");
  EXPECT_EQ(go_on_text({20, 20, 0}, fault, true), "all 20 cells are kept") << "only parking failed";
}

TEST(ScanReport, TheSummaryNamesTheCellsThatWereThere) {
  EXPECT_THAT(summary_text(summary(0)), testing::StartsWith("lamp.lumi: 63 of 63 cells, in 1:18\n"));
  EXPECT_THAT(summary_text(summary(40)), testing::StartsWith("lamp.lumi: 63 of 63 cells, 40 there before, in 1:18\n"));
  EXPECT_EQ(summary_text(summary(63)), "lamp.lumi: 63 of 63 cells, complete before: nothing was left to measure\n");
  EXPECT_EQ(nlohmann::json::parse(summary_json(summary(40)))["cells_before"], 40);
}

TEST(ScanReport, TheSummaryCountsTheCellsWithAdaptedExposures) {
  ScanSummary s = summary(0);
  EXPECT_THAT(summary_text(s), Not(HasSubstr("adapted")));
  EXPECT_EQ(nlohmann::json::parse(summary_json(s))["cells_with_adapted_exposures"], 0);
  s.cells_adapted = 5;
  EXPECT_THAT(summary_text(s), HasSubstr("5 cells with adapted exposures\n"));
  EXPECT_EQ(nlohmann::json::parse(summary_json(s))["cells_with_adapted_exposures"], 5);
}

TEST(ScanReport, APathThatIsNotUtf8DoesNotBreakTheJson) {
  ScanSummary s = summary(0);
  s.dataset = "lamp\xff.lumi";
  EXPECT_EQ(nlohmann::json::parse(summary_json(s))["dataset"], "lamp\xEF\xBF\xBD.lumi");
}

}  // namespace
}  // namespace lumifield
