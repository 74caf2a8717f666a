#include "app/session/pipeline.h"

#include <cerrno>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "app/session/guarded.h"
#include "luminaire/file_io.h"
#include "tests/calibration/synthetic_bench.h"

namespace lumifield {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class PipelineTest : public testing::Test {
 protected:
  PipelineTest() { fs::remove_all(folder_); }
  ~PipelineTest() override { fs::remove_all(folder_); }

  Result<DatasetWriter> create() {
    Manifest manifest;
    manifest.geometry = luminaire_geometry(bench_, plan_);
    return DatasetWriter::create(folder_, std::move(manifest));
  }
  CellImage image() const {
    CellImage image;
    image.width_px = plan_.measurement.width_px, image.height_px = plan_.measurement.height_px, image.channels = 1;
    image.value.assign(image.plane(), 1.5F);
    image.variance.assign(image.plane(), 0.25F);
    return image;
  }
  std::vector<std::string> notices() {
    pipeline_.events.close();
    std::vector<std::string> texts;
    while (auto event = pipeline_.events.pop())
      if (const auto* notice = std::get_if<Notice>(&*event)) texts.push_back(notice->text);
    return texts;
  }

  Bench bench_ = test::synthetic_bench();
  Plan plan_ = test::synthetic_plan();
  fs::path folder_ = fs::path(testing::TempDir()) / ("pipeline_" + std::to_string(getpid()) + ".lumi");
  Pipeline pipeline_;
  std::function<Status()> nothing_ = [] { return Status{}; };
};

TEST(Guarded, TurnsExceptionsIntoErrors) {
  EXPECT_EQ(guarded("store", []() -> Status { throw std::bad_alloc(); }).error().what, "out of memory");
  EXPECT_THAT(guarded("store", []() -> Status { throw std::runtime_error("odd"); }).error().what, HasSubstr("odd"));
  EXPECT_EQ(guarded("store", []() -> Status { throw 3; }).error().where, "store");
  EXPECT_EQ(guarded("store", []() -> Result<int> { return 3; }), 3);
}

TEST_F(PipelineTest, KeepsTheFirstErrorAndTellsLaterFaults) {
  pipeline_.fail({"no space", "disk", ""});
  pipeline_.fail({"stopped by the operator", "scan", "", ErrorKind::stopped});
  pipeline_.fail({"alarm", "stage", ""});
  EXPECT_EQ(pipeline_.error()->what, "no space");
  EXPECT_TRUE(pipeline_.abandon_token().stop_requested());
  EXPECT_FALSE(pipeline_.stop_token().stop_requested());
  EXPECT_EQ(notices(), std::vector<std::string>{"stage: alarm"});
}

TEST_F(PipelineTest, ABenchWithoutCameraEndsTheLine) {
  bench_.camera.kind = "none";
  BenchOutcome outcome;
  ScanRequest request;
  request.bench = bench_;
  request.plan = plan_;
  request.bench_view = std::make_shared<BenchView>();
  run_bench(request, {}, {}, pipeline_, outcome);
  EXPECT_EQ(request.bench_view->snapshot().camera.link, DeviceView::Link::closed);
  ASSERT_TRUE(pipeline_.error());
  EXPECT_EQ(pipeline_.error()->where, "camera.kind");
  EXPECT_FALSE(pipeline_.raw.push({}));
}

TEST_F(PipelineTest, ACellThatCannotBeDevelopedClosesBothSides) {
  auto developer = Developer::create(bench_, plan_);
  ASSERT_TRUE(developer) << developer.error().message();
  RawCell raw;
  raw.cell = {1, 2};
  raw.passes.resize(1);
  ASSERT_TRUE(pipeline_.raw.push(raw));
  std::vector<double> times;
  int warned = 0, adapted = 0;
  run_develop(*developer, pipeline_, times, warned, adapted);
  ASSERT_TRUE(pipeline_.error());
  EXPECT_EQ(pipeline_.error()->where, "cell (1, 2)") << "named once";
  EXPECT_FALSE(pipeline_.raw.push(raw));
  EXPECT_FALSE(pipeline_.developed.pop());
}

TEST_F(PipelineTest, ACellThatCannotBeStoredClosesBothSides) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{7, 7}, image(), {0, 0}}));
  std::vector<double> times;
  bool failed = false;
  run_store(*writer, {}, nothing_, pipeline_, times, failed);
  EXPECT_TRUE(failed);
  ASSERT_TRUE(pipeline_.error());
  EXPECT_THAT(pipeline_.error()->where, HasSubstr("cell (7, 7)"));
  EXPECT_FALSE(pipeline_.developed.push({{0, 0}, image(), {0, 0}}));
  EXPECT_FALSE(pipeline_.stored.pop());
}

TEST_F(PipelineTest, StoresTellsTheNotesAndHandsOnWithoutVariance) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{0, 1}, image(), {0, 0}}));
  pipeline_.developed.close();
  std::vector<double> times;
  bool failed = false;
  run_store(*writer, {"a torn line", "a damaged file"}, nothing_, pipeline_, times, failed);
  EXPECT_FALSE(failed);
  const auto stored = pipeline_.stored.pop();
  ASSERT_TRUE(stored);
  EXPECT_EQ(stored->image->value, image().value);
  EXPECT_EQ(stored->image->variance.capacity(), 0U);
  EXPECT_EQ(notices(), (std::vector<std::string>{"a torn line", "a damaged file"}));
}

TEST_F(PipelineTest, RecordsOnceBeforeTheFirstCell) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{0, 1}, image(), {0, 0}}));
  ASSERT_TRUE(pipeline_.developed.push({{1, 1}, image(), {0, 0}}));
  pipeline_.developed.close();
  std::vector<std::size_t> cells_at_record;
  std::vector<double> times;
  bool failed = false;
  const auto record = [&]() -> Status {
    cells_at_record.push_back(writer->manifest().cells.size());
    return {};
  };
  run_store(*writer, {}, record, pipeline_, times, failed);
  EXPECT_FALSE(failed);
  EXPECT_EQ(cells_at_record, std::vector<std::size_t>{0});
  EXPECT_EQ(writer->manifest().cells.size(), 2U);
}

TEST_F(PipelineTest, StoresNoCellWithoutItsRecord) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{0, 1}, image(), {0, 0}}));
  std::vector<double> times;
  bool failed = false;
  run_store(
      *writer, {}, [] { return fail("no space", "disk"); }, pipeline_, times, failed);
  EXPECT_TRUE(failed);
  EXPECT_EQ(pipeline_.error()->what, "no space");
  EXPECT_TRUE(writer->manifest().cells.empty());
  EXPECT_FALSE(pipeline_.developed.push({{1, 1}, image(), {0, 0}}));
}

TEST_F(PipelineTest, AFullDiskIsWaitedForAndLosesNothing) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{0, 1}, image(), {0, 0}}));
  pipeline_.developed.close();
  std::vector<double> times;
  bool failed = false;
  int asked = 0;
  const auto record = [&]() -> Status {
    return ++asked < 3 ? Status(system_failure("could not be written", "disk", ENOSPC)) : Status{};
  };
  run_store(*writer, {}, record, pipeline_, times, failed);
  EXPECT_FALSE(failed);
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(writer->manifest().cells.size(), 1U);
  EXPECT_THAT(notices(), testing::ElementsAre(HasSubstr("No space left on device (disk): storing waits"),
                                              HasSubstr("there is room on the disk again")));
}

TEST_F(PipelineTest, AStopEndsTheWaitForRoom) {
  auto writer = create();
  ASSERT_TRUE(writer) << writer.error().message();
  ASSERT_TRUE(pipeline_.developed.push({{0, 1}, image(), {0, 0}}));
  std::vector<double> times;
  bool failed = false;
  const auto record = [&]() -> Status {
    pipeline_.request_stop();
    return system_failure("could not be written", "disk", ENOSPC);
  };
  run_store(*writer, {}, record, pipeline_, times, failed);
  EXPECT_TRUE(failed);
  ASSERT_TRUE(pipeline_.error());
  EXPECT_EQ(pipeline_.error()->kind, ErrorKind::stopped);
  EXPECT_TRUE(writer->manifest().cells.empty());
}

TEST_F(PipelineTest, KeepsTheFirstReading) {
  EXPECT_FALSE(pipeline_.first_reading());
  pipeline_.tell_reading({0, 1000, 0, 0.01});
  pipeline_.tell_reading({6, 1100, 0.1, 0.01});
  EXPECT_EQ(pipeline_.first_reading()->signal_dn_per_s, 1000);
}

TEST_F(PipelineTest, WithoutARendererTheCellsPass) {
  ASSERT_TRUE(pipeline_.stored.push({}));
  pipeline_.stored.close();
  std::vector<double> render_s, kernel_s;
  run_render(nullptr, 0, 9, {0.5, 1}, pipeline_, render_s, kernel_s);
  EXPECT_FALSE(pipeline_.stored.pop());
  EXPECT_FALSE(pipeline_.error());
  EXPECT_TRUE(render_s.empty());
}

}  // namespace
}  // namespace lumifield
