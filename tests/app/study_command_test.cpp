#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/cli/command_line.h"
#include "app/cli/study_report.h"
#include "app/session/study_file.h"
#include "luminaire/dataset.h"
#include "tests/support/command_run.h"
#include "tests/support/dataset_folder.h"
#include "tests/support/made_up_study.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

constexpr const char* scene = LUMIFIELD_SOURCE_DIR "/resources/scenes/corner/scene.json";

int no_window(int, char**, const WindowOptions&) { return 99; }

/// What the chart's hook was given last.
Study drawn;
std::filesystem::path drawn_into;
Status take_chart(const Study& study, const std::filesystem::path& folder) {
  drawn = study;
  drawn_into = folder;
  return {};
}

class StudyCommand : public support::TemporaryFolder {
 protected:
  StudyCommand() { drawn_into.clear(); }
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"lumifield", "study", "--cache", folder_ / "cache"});
    std::vector<char*> argv;
    for (std::string& each : arguments) argv.push_back(each.data());
    argv.push_back(nullptr);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int code = run_command_line(static_cast<int>(arguments.size()), argv.data(), no_window, take_chart);
    out = testing::internal::GetCapturedStdout();
    error = testing::internal::GetCapturedStderr();
    return code;
  }
  /// A lamp of 2 × 1 cells.
  std::string dataset(const std::string& name) const {
    Manifest manifest;
    manifest.geometry = support::geometry(2, 1, 40, 40, {"Y"});
    auto writer = DatasetWriter::create(folder_ / name, manifest);
    for (int k = 0; k < 2; ++k)
      EXPECT_TRUE(
          writer->add({0, k}, {40, 40, 1, std::vector<float>(1600, 1 + static_cast<float>(k)), {}, {}}, {0, 0}));
    return folder_ / name;
  }
  std::string study_folder() const { return folder_ / "study"; }

  std::string out, error;
};

TEST_F(StudyCommand, AStudyThatIsThereIsReplacedOnlyWhenToldSo) {
  const Study before = test::made_up_study();
  ASSERT_TRUE(write_study(before, study_folder()));
  EXPECT_EQ(run({"--scene", scene, "--out", study_folder()}), 1);
  EXPECT_THAT(error, HasSubstr("there is a study already"));
  EXPECT_THAT(error, HasSubstr("--force"));
  EXPECT_EQ(study_json(*read_study(folder_ / "study" / "study.json")), study_json(before));

  // With --force it goes on: to the scene, which is not there.
  EXPECT_EQ(run({"--scene", folder_ / "none.json", "--out", study_folder(), "--force"}), 1);
  EXPECT_THAT(error, HasSubstr("none.json"));
  EXPECT_EQ(study_json(*read_study(folder_ / "study" / "study.json")), study_json(before));
}

TEST_F(StudyCommand, WhatIsWrongIsToldBeforeAnythingIsComputedAndLeavesNoFolder) {
  EXPECT_EQ(run({"--out", study_folder()}), 2);
  EXPECT_THAT(error, HasSubstr("--scene is required"));
  EXPECT_EQ(run({"--luminaire", folder_ / "none.lumi", "--scene", scene, "--out", study_folder()}), 1);
  EXPECT_THAT(error, HasSubstr("none.lumi"));
  EXPECT_EQ(run({"--luminaire", "bike", "--luminaire", "bike", "--scene", scene, "--out", study_folder()}), 1);
  EXPECT_THAT(error, HasSubstr("another luminaire is called 'bike' too"));
  EXPECT_EQ(run({"--json", "--luminaire", dataset("lamp.lumi"), "--luminaire", folder_ / "lamp.lumi" / "", "--scene",
                 scene, "--out", study_folder()}),
            1);
  EXPECT_EQ(nlohmann::json::parse(out)["error"]["what"], "another luminaire is called 'lamp' too");
  EXPECT_FALSE(std::filesystem::exists(study_folder()));
  support::write_text(folder_ / "file", "");
  EXPECT_EQ(run({"--scene", scene, "--out", folder_ / "file"}), 1);
  EXPECT_THAT(error, HasSubstr("a study cannot be written there"));
  EXPECT_EQ(run({"--scene", scene, "--out", dataset("other.lumi")}), 1);
  EXPECT_THAT(error, HasSubstr("that is a dataset"));
  EXPECT_TRUE(drawn_into.empty());
}

TEST_F(StudyCommand, WhatAStudyFileCannotHoldIsRefusedBeforeItIsMade) {
  std::vector<std::string> arguments{"--scene", scene, "--out", study_folder()};
  for (int k = 0; k < 33; ++k) arguments.insert(arguments.end(), {"--luminaire", "lamp" + std::to_string(k)});
  EXPECT_EQ(run(arguments), 1);
  EXPECT_THAT(error, HasSubstr("33 luminaires are more than a study holds"));
  // Two names that differ after 200 bytes only are one in the file.
  const std::string a = dataset(std::string(210, 'a') + "1.lumi"), b = dataset(std::string(210, 'a') + "2.lumi");
  EXPECT_EQ(run({"--luminaire", a, "--luminaire", b, "--scene", scene, "--out", study_folder()}), 1);
  EXPECT_THAT(error, HasSubstr("another luminaire is called 'aaa"));
  EXPECT_FALSE(std::filesystem::exists(study_folder()));
}

TEST_F(StudyCommand, ASignalStopsItAndNothingIsLeft) {
  const std::string lamp = dataset("lamp.lumi");
  const support::Operator one;
  EXPECT_EQ(run({"--luminaire", lamp, "--scene", scene, "--out", study_folder()}), 3) << error;
  EXPECT_THAT(error, HasSubstr("\nlumifield: stopping; once more ends it at once\n"));
  EXPECT_THAT(error, HasSubstr("stopped"));
  EXPECT_FALSE(std::filesystem::exists(study_folder()));
  EXPECT_TRUE(drawn_into.empty());
}

TEST_F(StudyCommand, WritesStudyTablesAndChart) {
  ASSERT_EQ(run({"--json", "--quick", "--ladders-only", "--luminaire", dataset("lamp.lumi"), "--scene", scene, "--out",
                 study_folder()}),
            0)
      << error;
  const Result<Study> study = read_study(folder_ / "study" / "study.json");
  ASSERT_TRUE(study) << study.error().message();
  EXPECT_EQ(drawn_into, study_folder());
  EXPECT_EQ(study_json(drawn), study_json(*study));
  EXPECT_TRUE(study->quick);
  ASSERT_FALSE(study->points.empty());
  EXPECT_EQ(study->points[0].luminaire, "lamp");
  for (const char* name : {"points.csv", "stability.csv", "figures.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "study" / name)) << name;
  EXPECT_FALSE(std::filesystem::is_empty(folder_ / "cache")) << "references are kept";
  const auto summary = nlohmann::json::parse(out);
  EXPECT_EQ(summary["points"], study->points.size());
  EXPECT_EQ(summary["luminaires"], nlohmann::json({"lamp", "lamp, in shadow", "lamp, GGX 0.2, in shadow"}));
  EXPECT_THAT(error, HasSubstr("100 %, "));
  EXPECT_THAT(error, HasSubstr(" elapsed, 0:00 left, "));
}

TEST(StudyReport, NamesEachMethodsLeastErrorAndWhatFailed) {
  const std::string text = study_summary_text(test::made_up_study(), "out", 75);
  // Eight cases of each method.
  const std::size_t cases = 8 * methods().size();
  EXPECT_THAT(text, testing::StartsWith("out: 87 points, " + std::to_string(cases) + " stability cases (" +
                                        std::to_string(cases - 8) + " ok, 7 refused, 1 failed), 1 figures, in 1:15\n"));
  EXPECT_THAT(text,
              HasSubstr("  bike\n    closed-form                 least error    3e-06 % in       88 ms  exact\n"));
  EXPECT_THAT(text, HasSubstr("    position-dependent          least error     1.41 % in      208 ms  K = 4096\n"));
  EXPECT_THAT(text, HasSubstr("  failed: position-dependent-printed, grazing: off by more than it says\n"));
  Study without = test::made_up_study();
  without.omissions = {{"Table 1", "/tmp: cannot be made; make room"}};
  EXPECT_THAT(study_summary_text(without, "out", 75),
              HasSubstr("  without Table 1: /tmp: cannot be made; make room\n"));
  EXPECT_EQ(nlohmann::json::parse(study_summary_json(without, "out", 75))["omissions"][0]["part"], "Table 1");
  const auto json = nlohmann::json::parse(study_summary_json(test::made_up_study(), "out\xff", 75));
  EXPECT_EQ(json["stability"]["failed"], 1);
  EXPECT_EQ(json["luminaires"].size(), 3U);
}

}  // namespace
}  // namespace lumifield
