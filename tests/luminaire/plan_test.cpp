#include "luminaire/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace lumifield {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr const char* documented = R"({ "format": "lumifield-plan", "version": 1, "columns": 9, "rows": 7,
  "center_mm": [0,0], "order": "serpentine",
  "measurement": { "width_px": 300, "height_px": 200, "pixel_mm": [1.0, 0.5], "center_mm": [0, 3] },
  "exposures_s": [0.002, 0.008, 0.032, 0.128], "settle_s": 0.15, "dark_every_cells": 21,
  "reference_cell": { "row": 3, "column": 4, "every": 21, "limit": 0.01 }, "warm_up_s": 0,
  "limits": { "saturated_share": 0.001, "median_snr": 20 } })";

constexpr const char* limits_default =
    "plan.json: exposure_limits_s is absent, taken as [0.002,0.128], the plan's exposures alone";
constexpr const char* stabilisation_default =
    "plan.json: stabilisation is absent, taken as null, the scan does not wait for a steady lamp";

std::string refusal_with(const char* pointer, const Json& value) {
  Json json = Json::parse(documented);
  json[Json::json_pointer(pointer)] = value;
  const Result<Plan> plan = parse_plan(json.dump(), "plan.json");
  return plan ? "accepted" : plan.error().message();
}

TEST(Plan, ReadsTheDocumentedFile) {
  std::vector<std::string> defaults;
  const Result<Plan> plan = parse_plan(documented, "plan.json", &defaults);
  ASSERT_TRUE(plan) << plan.error().message();
  EXPECT_EQ(plan->columns, 9);
  EXPECT_EQ(plan->rows, 7);
  EXPECT_EQ(plan->order, ScanOrder::serpentine);
  EXPECT_EQ(plan->measurement.height_px, 200);
  EXPECT_EQ(plan->measurement.pixel_mm, Vec2(1, 0.5));
  EXPECT_EQ(plan->measurement.center_mm, Vec2(0, 3));
  EXPECT_EQ(plan->exposures_s, (std::vector<double>{0.002, 0.008, 0.032, 0.128}));
  EXPECT_EQ(plan->dark_every_cells, 21);
  EXPECT_EQ(plan->reference.cell, (CellIndex{3, 4}));
  EXPECT_EQ(plan->reference.every, 21);
  EXPECT_EQ(plan->limits.median_snr, 20);
  EXPECT_FALSE(plan->exposure_limits_s);
  EXPECT_THAT(defaults,
              testing::ElementsAre("plan.json: name is absent, taken as \"\"", limits_default, stabilisation_default));
}

TEST(Plan, TellsWhatItDoesNotKnow) {
  Json json = Json::parse(documented);
  json["dark_every_cell"] = 5;
  json["measurement"]["colour"] = {{"inner", 1}};
  std::vector<std::string> notes;
  ASSERT_TRUE(parse_plan(json.dump(), "plan.json", &notes));
  EXPECT_THAT(notes, testing::ElementsAre("plan.json: name is absent, taken as \"\"", limits_default,
                                          stabilisation_default, "plan.json: dark_every_cell is not known and ignored",
                                          "plan.json: measurement.colour is not known and ignored"));

  json = Json::parse(documented);
  for (int k = 0; k < 1000; ++k) json["key" + std::to_string(k)] = k;
  notes.clear();
  ASSERT_TRUE(parse_plan(json.dump(), "plan.json", &notes));
  EXPECT_EQ(notes.size(), 24u);
  EXPECT_EQ(notes.back(), "plan.json: 980 more members are not known and ignored");
}

TEST(Plan, KnowsAllThatItWrites) {
  std::vector<std::string> notes;
  ASSERT_TRUE(parse_plan(to_json(*parse_plan(documented, "plan.json")), "plan.json", &notes));
  EXPECT_THAT(notes, testing::IsEmpty());
}

TEST(Plan, ReturnsTheSameAfterWritingAndReading) {
  Plan plan = *parse_plan(documented, "plan.json");
  plan.name = "quick";
  plan.order = ScanOrder::coarse_to_fine;
  plan.center_mm = {0.1, -1e-7};
  plan.warm_up_s = 600;
  const std::string once = to_json(plan);
  const Result<Plan> read = parse_plan(once, "plan.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(to_json(*read), once);
  EXPECT_EQ(read->order, ScanOrder::coarse_to_fine);
  EXPECT_EQ(read->center_mm, plan.center_mm);
  EXPECT_EQ(read->warm_up_s, 600);
}

TEST(Plan, LimitsTheExposuresThatAScanMayChoose) {
  Json json = Json::parse(documented);
  json["exposure_limits_s"] = {0.0001, 2};
  std::vector<std::string> notes;
  const Result<Plan> plan = parse_plan(json.dump(), "plan.json", &notes);
  ASSERT_TRUE(plan) << plan.error().message();
  ASSERT_TRUE(plan->exposure_limits_s);
  EXPECT_EQ(plan->exposure_limits_s->shortest_s, 0.0001);
  EXPECT_EQ(plan->exposure_limits_s->longest_s, 2);
  EXPECT_THAT(notes, testing::Not(testing::Contains(HasSubstr("exposure_limits_s"))));
  EXPECT_EQ(Json::parse(to_json(*plan))["exposure_limits_s"], json["exposure_limits_s"]);
  EXPECT_EQ(Json::parse(to_json(*parse_plan(documented, "plan.json")))["exposure_limits_s"], Json({0.002, 0.128}));
  for (const Json& wrong : {Json({1, 0.001}), Json({0, 1}), Json({0.001}), Json(1), Json(nullptr)})
    EXPECT_THAT(refusal_with("/exposure_limits_s", wrong), HasSubstr("plan.json: exposure_limits_s")) << wrong;
}

TEST(Plan, SaysWhenALampIsSteady) {
  Json json = Json::parse(documented);
  json["stabilisation"] = {{"within", 0.005}, {"over_s", 900}, {"limit_s", 3600}};
  std::vector<std::string> notes;
  const Result<Plan> plan = parse_plan(json.dump(), "plan.json", &notes);
  ASSERT_TRUE(plan) << plan.error().message();
  ASSERT_TRUE(plan->stabilisation);
  EXPECT_EQ(plan->stabilisation->within, 0.005);
  EXPECT_EQ(plan->stabilisation->over_s, 900);
  EXPECT_EQ(plan->stabilisation->limit_s, 3600);
  EXPECT_THAT(notes, testing::Not(testing::Contains(HasSubstr("stabilisation"))));
  EXPECT_EQ(Json::parse(to_json(*plan))["stabilisation"], json["stabilisation"]);
  EXPECT_EQ(Json::parse(to_json(*parse_plan(documented, "plan.json")))["stabilisation"], nullptr);

  const auto refused = [&](const char* member, const Json& value) {
    Json wrong = json["stabilisation"];
    wrong[member] = value;
    return refusal_with("/stabilisation", wrong);
  };
  EXPECT_THAT(refused("within", 0), HasSubstr("plan.json: stabilisation.within: is out of range"));
  EXPECT_THAT(refused("within", 1), HasSubstr("stabilisation.within: is no spread of a steady lamp"));
  EXPECT_THAT(refused("within", "1 %"), HasSubstr("stabilisation.within: has the wrong type"));
  EXPECT_THAT(refused("over_s", 0.5), HasSubstr("stabilisation.over_s: is out of range"));
  EXPECT_THAT(refused("limit_s", 899), HasSubstr("stabilisation.limit_s: is shorter than over_s"));
  EXPECT_THAT(refused("limit_s", 1e6), HasSubstr("stabilisation.limit_s: is out of range"));
  EXPECT_THAT(refusal_with("/stabilisation", {{"within", 0.01}}), HasSubstr("stabilisation.over_s"));
  EXPECT_THAT(refusal_with("/stabilisation", 5), HasSubstr("stabilisation"));
}

TEST(Plan, NamesThePlaceOfWhatIsWrong) {
  EXPECT_THAT(refusal_with("/columns", 0), HasSubstr("plan.json: columns: is out of range"));
  EXPECT_THAT(refusal_with("/order", "random"), HasSubstr("order: \"random\" is not known"));
  EXPECT_THAT(refusal_with("/exposures_s", Json::array()), HasSubstr("exposures_s: has 0 elements"));
  EXPECT_THAT(refusal_with("/exposures_s/2", 0.001), HasSubstr("exposures_s: does not ascend"));
  EXPECT_THAT(refusal_with("/exposures_s/2", "1"), HasSubstr("exposures_s[2]: has the wrong type"));
  EXPECT_THAT(refusal_with("/reference_cell/row", 7), HasSubstr("reference_cell.row: is out of range (7)"));
  EXPECT_THAT(refusal_with("/reference_cell/limit", 0), HasSubstr("reference_cell.limit: is out of range"));
  EXPECT_THAT(refusal_with("/limits/saturated_share", 1.5), HasSubstr("limits.saturated_share: is out of range"));
  EXPECT_THAT(refusal_with("/measurement/pixel_mm", Json({1, 0})),
              HasSubstr("measurement.pixel_mm[1]: is out of range"));
  EXPECT_THAT(refusal_with("/format", "lumifield-bench"), HasSubstr("format: is not \"lumifield-plan\""));
  EXPECT_THAT(refusal_with("/version", 0), HasSubstr("version"));
}

TEST(Plan, NamesTheUnknownMemberThatMayBeMeantForAMissingOne) {
  Json json = Json::parse(documented);
  json["collumns"] = json["columns"];
  json["clumns"] = 3;
  json.erase("columns");
  EXPECT_THAT(parse_plan(json.dump(), "p").error().message(),
              HasSubstr("p: columns: is missing; \"clumns\" is not known: is \"columns\" meant? If not, add it"));
}

TEST(Plan, RefusesGridsAndImagesBeyondTheLimits) {
  Json json = Json::parse(documented);
  json["columns"] = json["rows"] = 31623;
  EXPECT_THAT(parse_plan(json.dump(), "p").error().message(), HasSubstr("columns: is a grid of 1000014129 cells"));
  json["columns"] = json["rows"] = 1e300;
  EXPECT_THAT(parse_plan(json.dump(), "p").error().message(), HasSubstr("columns: is out of range"));
  json = Json::parse(documented);
  json["measurement"]["width_px"] = json["measurement"]["height_px"] = 16384;
  EXPECT_THAT(parse_plan(json.dump(), "p").error().message(), HasSubstr("measurement: is an image of 16384 x 16384"));
}

}  // namespace
}  // namespace lumifield
