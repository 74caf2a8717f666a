#include "app/session/study_file.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "tests/support/dataset_folder.h"

namespace lumifield {
namespace {

using Json = nlohmann::json;
using support::read_text;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Study small_study() {
  Study study;
  study.scene = "corner";
  study.quick = true;
  study.points = {{Method::closed_form, "bike", 0, 81.25, 0, 1e-3, "pthread, PoCL", 256, 192},
                  {Method::position_dependent, "bike", 200, 1.0 / 3, 0.1, 2.5, "pthread", 1024, 768}};
  study.stability = {{Method::closed_form, "on S", StabilityOutcome::ok, 1e-7, ""},
                     {Method::far_field, "on S", StabilityOutcome::refused, none, "nearer than 5 × its width"},
                     {Method::uniform_box, "grazing", StabilityOutcome::failed, 0.5, "says \"done\",\nis not"}};
  study.figures = {{"Fig. 5", "bike", "secant, depth 3", "mean Lab ΔE", 1.25, none},
                   {"Fig. 9", "car1", "K_max 40", "time, ms", -2, 140}};
  study.omissions = {{"Table 1", "/tmp: cannot be made; make room"}};
  return study;
}

class StudyFile : public support::TemporaryFolder {
 protected:
  static std::string refusal_with(const char* pointer, const Json& value) {
    Json json = Json::parse(study_json(small_study()));
    json[Json::json_pointer(pointer)] = value;
    const Result<Study> study = parse_study(json.dump(), "study.json");
    return study ? "accepted" : study.error().message();
  }
};

TEST_F(StudyFile, IsReadAsItWasWritten) {
  const std::filesystem::path folder = folder_ / "deep" / "study";
  const Study study = small_study();
  ASSERT_TRUE(write_study(study, folder));
  const Result<Study> read = read_study(folder / "study.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(study_json(*read), study_json(study));
  EXPECT_TRUE(read->quick);
  ASSERT_EQ(read->points.size(), 2U);
  EXPECT_EQ(read->points[1].method, Method::position_dependent);
  EXPECT_EQ(read->points[1].time_ms, 1.0 / 3);
  EXPECT_EQ(read->points[1].height_px, 768);
  EXPECT_EQ(read->points[0].device, "pthread, PoCL");
  EXPECT_EQ(read->stability[2].outcome, StabilityOutcome::failed);
  EXPECT_EQ(read->stability[2].reason, "says \"done\",\nis not");
  EXPECT_EQ(read->figures[1].ours, -2);
  EXPECT_EQ(read->figures[1].paper, 140);
  ASSERT_EQ(read->omissions.size(), 1U);
  EXPECT_EQ(read->omissions[0].part, "Table 1");
  EXPECT_EQ(read->omissions[0].reason, "/tmp: cannot be made; make room");
}

TEST_F(StudyFile, OfBeforeThereWereOmissionsIsRead) {
  Json json = Json::parse(study_json(small_study()));
  json.erase("omissions");
  const Result<Study> read = parse_study(json.dump(), "study.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->omissions.empty());
  EXPECT_EQ(read->figures.size(), 2U);
}

TEST_F(StudyFile, WhatIsNotFiniteIsNullAndAnEmptyField) {
  Study study = small_study();
  study.points[0].rel_rmse = std::numeric_limits<double>::infinity();
  study.points[1].lab_delta_e = none;
  ASSERT_TRUE(write_study(study, folder_));
  const Json json = Json::parse(read_text(folder_ / "study.json"));
  EXPECT_TRUE(json["points"][0]["rel_rmse"].is_null());
  EXPECT_TRUE(json["stability"][1]["rel_error"].is_null());
  EXPECT_TRUE(json["figures"][0]["paper"].is_null());
  const Result<Study> read = read_study(folder_ / "study.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(std::isnan(read->points[0].rel_rmse));
  EXPECT_TRUE(std::isnan(read->points[1].lab_delta_e));
  EXPECT_TRUE(std::isnan(read->stability[1].rel_error));
  EXPECT_TRUE(std::isnan(read->figures[0].paper));
  EXPECT_THAT(read_text(folder_ / "figures.csv"), HasSubstr("mean Lab ΔE,1.25,\n"));
}

TEST_F(StudyFile, TheListsAreTables) {
  ASSERT_TRUE(write_study(small_study(), folder_));
  EXPECT_EQ(read_text(folder_ / "points.csv"),
            "method,luminaire,cost,time_ms,rel_rmse,lab_delta_e,device,width_px,height_px\n"
            "closed-form,bike,0,81.25,0,0.001,\"pthread, PoCL\",256,192\n"
            "position-dependent,bike,200,0.3333333333333333,0.1,2.5,pthread,1024,768\n");
  EXPECT_EQ(read_text(folder_ / "stability.csv"),
            "method,case,outcome,rel_error,reason\n"
            "closed-form,on S,ok,1e-07,\n"
            "far-field,on S,refused,,nearer than 5 × its width\n"
            "uniform-box,grazing,failed,0.5,\"says \"\"done\"\",\nis not\"\n");
  EXPECT_THAT(read_text(folder_ / "figures.csv"), StartsWith("figure,luminaire,what,quantity,ours,paper\n"
                                                             "Fig. 5,bike,\"secant, depth 3\",mean Lab ΔE,1.25,\n"));
}

TEST_F(StudyFile, AnEmptyStudyIsAStudy) {
  Study study;
  study.figures.resize(1);
  ASSERT_TRUE(write_study(study, folder_));
  const Result<Study> read = read_study(folder_ / "study.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_TRUE(read->points.empty());
  EXPECT_EQ(read_text(folder_ / "figures.csv"), "figure,luminaire,what,quantity,ours,paper\n,,,,0,0\n");
  EXPECT_EQ(read_text(folder_ / "stability.csv"), "method,case,outcome,rel_error,reason\n");
}

TEST_F(StudyFile, NamesThePlaceOfWhatIsWrong) {
  EXPECT_EQ(refusal_with("/scene", "pillars"), "accepted");
  EXPECT_THAT(refusal_with("/version", 2), HasSubstr("study.json: version: is a version this program does not know"));
  EXPECT_THAT(refusal_with("/format", "lumifield-scene"), HasSubstr("format: is not \"lumifield-study\""));
  EXPECT_THAT(refusal_with("/points/1/method", "magic"), HasSubstr("points[1].method: \"magic\" is not known"));
  EXPECT_THAT(refusal_with("/points/1/time_ms", -1), HasSubstr("points[1].time_ms: is out of range (-1)"));
  EXPECT_THAT(refusal_with("/points/0/rel_rmse", "0.1"), HasSubstr("points[0].rel_rmse: has the wrong type"));
  EXPECT_THAT(refusal_with("/points/0/cost", nullptr), HasSubstr("points[0].cost: has the wrong type"));
  EXPECT_THAT(refusal_with("/points/0/width_px", 0), HasSubstr("points[0].width_px: is out of range"));
  EXPECT_THAT(refusal_with("/points/0/luminaire", std::string(201, 'x')), HasSubstr("is longer than 200 bytes"));
  EXPECT_THAT(refusal_with("/stability/0/outcome", "fine"), HasSubstr("stability[0].outcome: \"fine\" is not known"));
  EXPECT_THAT(refusal_with("/stability/1", 7), HasSubstr("stability[1]: has the wrong type"));
  EXPECT_THAT(refusal_with("/figures", Json::object()), HasSubstr("figures: has the wrong type"));
  EXPECT_THAT(refusal_with("/omissions/0/part", 3), HasSubstr("omissions[0].part: has the wrong type"));
  EXPECT_THAT(refusal_with("/quick", 1), HasSubstr("quick: has the wrong type"));
}

TEST_F(StudyFile, SizesAreBounded) {
  Study many = small_study();
  for (std::size_t k = 0; k < most_study_plots; ++k) {
    many.points.push_back(many.points[0]);
    many.points.back().luminaire = "lamp " + std::to_string(k);
  }
  EXPECT_THAT(parse_study(study_json(many), "study.json").error().message(),
              HasSubstr("points: name more than 72 luminaires and looks"));
  many.points.assign(10'001, many.points[0]);
  EXPECT_THAT(parse_study(study_json(many), "study.json").error().message(), HasSubstr("points: has 10001 elements"));
  support::write_text(folder_ / "study.json", std::string((4U << 20) + 1, ' '));
  EXPECT_THAT(read_study(folder_ / "study.json").error().message(), HasSubstr("study.json"));
  EXPECT_FALSE(read_study(folder_));
  EXPECT_FALSE(read_study("/dev/zero"));
}

TEST_F(StudyFile, HowALongNamedLuminaireLooksIsKept) {
  const std::string looks = study_luminaire_name(std::string(300, 'x')) + ", GGX 0.05, in shadow";
  EXPECT_EQ(study_name(looks), looks);
}

TEST_F(StudyFile, HostileNamesAreWrittenAsTheyAreRead) {
  std::string umlauts;
  for (int k = 0; k < 150; ++k) umlauts += "ü";
  Study study = small_study();
  study.scene = std::string(5'000, 's');
  study.points[0].luminaire = "a" + umlauts;
  study.points[0].device = std::string("no\0thing, \"quoted\",\r\n\t\x1b[31m", 27);
  study.points[1].luminaire = "half\xc3 and \xff";
  study.stability[0].case_name = std::string(201, 'c');
  study.stability[1].reason = std::string(4'001, 'r');
  study.figures[0].what = umlauts;
  ASSERT_TRUE(write_study(study, folder_));
  const Result<Study> read = read_study(folder_ / "study.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(study_json(*read), study_json(study));
  EXPECT_EQ(read->points[0].luminaire, "a" + umlauts.substr(0, 196) + "…");
  EXPECT_EQ(read->points[0].device, study.points[0].device);
  EXPECT_EQ(read->points[1].luminaire, "half\uFFFD and \uFFFD");
  EXPECT_EQ(read->scene.size(), 4'000U);
  EXPECT_EQ(read->stability[0].case_name, std::string(197, 'c') + "…");
  EXPECT_EQ(read->stability[1].reason, std::string(3'997, 'r') + "…");
  EXPECT_EQ(read->figures[0].what, umlauts.substr(0, 196) + "…");
  const std::string csv = read_text(folder_ / "points.csv");
  EXPECT_THAT(csv, HasSubstr("half\uFFFD and \uFFFD"));
  EXPECT_THAT(csv, HasSubstr(",\"no" + std::string(1, '\0') + "thing, \"\"quoted\"\",\r\n\t\x1b[31m\","));
}

TEST_F(StudyFile, WhatWouldNotBeReadIsNotWritten) {
  const auto refused = [&](auto change) {
    Study study = small_study();
    change(study);
    const Status written = write_study(study, folder_ / "new");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "new"));
    return written ? "written" : written.error().message();
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refused([](Study& s) { s.points[1].cost = infinity; }), HasSubstr("points[1].cost: has the wrong type"));
  EXPECT_THAT(refused([](Study& s) { s.points[1].cost = 1e300; }), HasSubstr("points[1].cost: is out of range"));
  EXPECT_THAT(refused([](Study& s) { s.points[0].time_ms = -1; }), HasSubstr("points[0].time_ms: is out of range"));
  EXPECT_THAT(refused([](Study& s) { s.points[0].width_px = 0; }), HasSubstr("points[0].width_px: is out of range"));
  EXPECT_THAT(refused([](Study& s) { s.figures.resize(10'001); }), HasSubstr("figures: has 10001 elements"));
  for (const double end : {infinity, -infinity, none}) {
    Study study = small_study();
    study.points[0].time_ms = study.stability[0].rel_error = study.figures[0].ours = end;
    ASSERT_TRUE(write_study(study, folder_));
    const Result<Study> read = read_study(folder_ / "study.json");
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_TRUE(std::isnan(read->points[0].time_ms));
    EXPECT_TRUE(std::isnan(read->stability[0].rel_error));
    EXPECT_TRUE(std::isnan(read->figures[0].ours));
  }
}

TEST_F(StudyFile, AFolderThatCannotBeMadeIsNamed) {
  support::write_text(folder_ / "file", "");
  const Status written = write_study(small_study(), folder_ / "file" / "study");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message(), HasSubstr("file/study"));
}

}  // namespace
}  // namespace lumifield
