#include "luminaire/bench.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace lumifield {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

/// The bench file as its documentation spells it, with every value filled in and nothing optional.
constexpr const char* documented = R"({ "format": "lumifield-bench", "version": 1,
  "camera": { "kind": "aravis", "address": "127.0.0.1", "pixel_format": "Mono12", "readout_s": 0.02 },
  "stage": { "kind": "grbl" }, "stage_carries": "slide",
  "stage_to_luminaire": { "linear": [[1,0],[0,1]], "origin_mm": [0,0] },
  "limits_mm": { "low": [-40, -30], "high": [140, 120] }, "tolerance_mm": 0.02, "lamp_size_mm": [36, 22],
  "planes": { "separation_mm": 150 },
  "camera_model": { "width_px": 1024, "height_px": 768, "fx": 1200, "fy": 1201, "cx": 511.5, "cy": 383.5,
    "distortion": [0.1, -0.02, 1e-4, 2e-4, 0], "pose": [1,0,0,10, 0,0,-1,20, 0,1,0,300, 0,0,0,1] },
  "sensor": { "black_level_dn": 64, "gain_dn_per_e": 0.25, "read_noise_e": 3, "saturation_dn": 4000,
    "responsivity": { "value": 1.5e6, "date": "2024-05-01", "source": "integrating sphere" } },
  "filter": { "basis": "bell", "spacing_mm": [7.5,7.5], "window": 4,
    "passes": [ { "name": "positive", "offset_mm": [0,0], "scale": 1.879 },
                { "name": "negative", "offset_mm": [90,0], "scale": -0.300 } ],
    "dark": { "offset_mm": [0,90] } } })";

std::string refusal(const Json& json) {
  const Result<Bench> bench = parse_bench(json.dump(), "bench.json");
  return bench ? "accepted" : bench.error().message();
}

/// The documented bench with the value at `pointer` replaced.
std::string refusal_with(const char* pointer, const Json& value) {
  Json json = Json::parse(documented);
  json[Json::json_pointer(pointer)] = value;
  return refusal(json);
}

std::string refusal_without(const char* object, const char* key) {
  Json json = Json::parse(documented);
  json[Json::json_pointer(object)].erase(key);
  return refusal(json);
}

TEST(Bench, ReadsTheDocumentedFile) {
  std::vector<std::string> defaults;
  const Result<Bench> read = parse_bench(documented, "bench.json", &defaults);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->camera.address, "127.0.0.1");
  EXPECT_EQ(read->camera.packet_bytes, 8192);
  EXPECT_EQ(read->stage.home, true);
  EXPECT_EQ(read->limits.low_mm, Vec2(-40, -30));
  EXPECT_EQ(read->limits.high_mm, Vec2(140, 120));
  EXPECT_EQ(read->lamp_size_mm, Vec2(36, 22));
  EXPECT_EQ(read->separation_mm, 150);
  EXPECT_EQ(read->camera_model.pose(2, 3), 300);
  EXPECT_EQ(read->camera_model.pose(1, 2), -1);
  EXPECT_EQ(read->camera_model.distortion[1], -0.02);
  EXPECT_EQ(read->sensor.responsivity, std::vector<double>{1.5e6});
  ASSERT_EQ(read->filter.passes.size(), 2u);
  EXPECT_EQ(read->filter.passes[1].name, "negative");
  EXPECT_EQ(read->filter.passes[1].offset_mm, Vec2(90, 0));
  EXPECT_EQ(read->filter.passes[1].scale, -0.3);
  EXPECT_EQ(read->filter.dark_offset_mm, Vec2(0, 90));
  EXPECT_THAT(defaults, testing::Contains("bench.json: stage.home is absent, taken as true"));
  EXPECT_EQ(read->filter.change, PassChange::stage);
  EXPECT_THAT(defaults, testing::Contains("bench.json: filter.change is absent, taken as \"stage\""));
  EXPECT_THAT(defaults, testing::Contains("bench.json: camera_model.vignetting is absent, taken as [0, 0, 0]"));
}

TEST(Bench, ReturnsTheSameAfterWritingAndReading) {
  Bench bench = *parse_bench(documented, "bench.json");
  bench.name = "Prüfstand \"7\"";
  bench.camera.gain = 1.0 / 3;
  bench.camera.packet_bytes = 0;
  bench.camera.packet_delay_us = 2.5;
  bench.camera.binning = 2;
  bench.stage.path = "/dev/ttyACM0";
  bench.stage.home = false;
  bench.stage.approach_mm = {0.5, -0.25};
  bench.stage_carries = StageCarries::lamp;
  bench.stage_to_luminaire.linear << 0, -1, 1, 0.001;
  bench.camera_model.vignetting = {-0.1, 0.02, 1e-300};
  bench.sensor.responsivity = {1, 2, 0.1};
  bench.filter.change = PassChange::by_operator;
  const std::string once = to_json(bench);
  const Result<Bench> read = parse_bench(once, "bench.json");
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(to_json(*read), once);
  EXPECT_EQ(read->camera.gain, bench.camera.gain);
  EXPECT_EQ(read->camera.packet_delay_us, 2.5);
  EXPECT_EQ(read->camera.binning, 2);
  EXPECT_EQ(read->stage.approach_mm, Vec2(0.5, -0.25));
  EXPECT_EQ(read->stage_carries, StageCarries::lamp);
  EXPECT_EQ(read->stage_to_luminaire.linear, bench.stage_to_luminaire.linear);
  EXPECT_EQ(read->camera_model.vignetting, bench.camera_model.vignetting);
  EXPECT_EQ(read->sensor.responsivity, bench.sensor.responsivity);
  EXPECT_EQ(read->filter.change, PassChange::by_operator);
  EXPECT_EQ(read->name, bench.name);
}

const Json apt_stage = {{"kind", "apt"},
                        {"apt",
                         {{"serials", {"27000001", "27000002"}},
                          {"controller", "kdc101"},
                          {"counts_per_mm", {34304, 34304}},
                          {"travel_mm", {50, 25}}}}};

TEST(Bench, ReadsAPairOfAptControllers) {
  Json json = Json::parse(documented);
  json["stage"] = apt_stage;
  std::vector<std::string> notes;
  const Result<Bench> read = parse_bench(json.dump(), "bench.json", &notes);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->stage.apt.serials, (std::vector<std::string>{"27000001", "27000002"}));
  EXPECT_EQ(read->stage.apt.controller, "kdc101");
  EXPECT_EQ(read->stage.apt.counts_per_mm, Vec2(34304, 34304));
  EXPECT_EQ(read->stage.apt.direction, Vec2(1, 1));
  EXPECT_EQ(read->stage.apt.travel_mm, Vec2(50, 25));
  EXPECT_THAT(notes, testing::Contains("bench.json: stage.apt.direction is absent, taken as [1, 1]"));
  Bench turned = *read;
  turned.stage.apt.direction = {1, -1};
  EXPECT_EQ(to_json(*parse_bench(to_json(turned), "bench.json")), to_json(turned));
  EXPECT_EQ(parse_bench(to_json(turned), "bench.json")->stage.apt.direction, Vec2(1, -1));
}

TEST(Bench, NamesWhatIsWrongOfAptControllers) {
  const auto with = [](const char* member, const Json& value) {
    Json stage = apt_stage;
    stage["apt"][member] = value;
    return refusal_with("/stage", stage);
  };
  EXPECT_THAT(refusal_with("/stage", Json({{"kind", "apt"}})), HasSubstr("stage.apt.serials: is missing"));
  EXPECT_THAT(with("serials", Json({"27000001"})), HasSubstr("stage.apt.serials: names one controller of one axis"));
  EXPECT_THAT(with("serials", Json({"1", "1"})), HasSubstr("stage.apt.serials: names one controller twice"));
  EXPECT_THAT(with("serials", Json({"1", "2", "3"})), HasSubstr("stage.apt.serials: has 3 elements"));
  EXPECT_THAT(with("controller", "tdc"), HasSubstr("stage.apt.controller: \"tdc\" is not known"));
  EXPECT_THAT(with("counts_per_mm", Json({34304, 0})), HasSubstr("stage.apt.counts_per_mm[1]: is out of range"));
  EXPECT_THAT(with("direction", Json({1, 0})), HasSubstr("stage.apt.direction: is no direction; make each 1 or -1"));
  EXPECT_THAT(with("travel_mm", Json({-1, 10})), HasSubstr("stage.apt.travel_mm[0]: is out of range"));
}

TEST(Bench, IgnoresUnknownMembers) { EXPECT_EQ(refusal_with("/camera/colour_of_the_case", "red"), "accepted"); }

TEST(Bench, NamesThePlaceOfWhatIsWrong) {
  EXPECT_THAT(refusal_without("/camera", "address"), HasSubstr("bench.json: camera.address: is missing"));
  EXPECT_THAT(refusal_with("/camera/address", 7), HasSubstr("bench.json: camera.address: has the wrong type"));
  EXPECT_THAT(refusal_with("/camera", "aravis"), HasSubstr("bench.json: camera: has the wrong type"));
  EXPECT_THAT(refusal_with("/camera/packet_bytes", 575), HasSubstr("give 576 to 65535, or 0 to have it found"));
  EXPECT_EQ(refusal_with("/camera/packet_bytes", 0), "accepted");
  EXPECT_THAT(refusal_with("/camera/binning", 0), HasSubstr("camera.binning: is out of range"));
  EXPECT_THAT(refusal_with("/camera/packet_bytes", 1500.5), HasSubstr("camera.packet_bytes: is out of range"));
  EXPECT_THAT(refusal_with("/stage/home", 1), HasSubstr("stage.home: has the wrong type; make it true or false"));
  EXPECT_THAT(refusal_with("/stage", Json({{"kind", "grbl"}, {"home", false}, {"check_home", true}})),
              HasSubstr("stage.check_home: asks for switches that are not looked for at the start"));
  EXPECT_THAT(refusal_with("/stage_to_luminaire/linear", Json({{1, 2}, {2, 4}})), HasSubstr("cannot be inverted"));
  EXPECT_THAT(refusal_with("/limits_mm/low/0", 140), HasSubstr("limits_mm: has a low limit not below the high one"));
  EXPECT_THAT(refusal_with("/planes/separation_mm", 0), HasSubstr("planes.separation_mm: is out of range (0)"));
  EXPECT_THAT(refusal_with("/camera_model/width_px", 1000000), HasSubstr("camera_model.width_px: is out of range"));
  EXPECT_THAT(refusal_with("/camera_model/distortion", Json({1, 2})),
              HasSubstr("camera_model.distortion: has 2 elements"));
  EXPECT_THAT(refusal_with("/camera_model/distortion/3", nullptr),
              HasSubstr("camera_model.distortion[3]: has the wrong type"));
  EXPECT_THAT(refusal_with("/camera_model/pose/0", 2), HasSubstr("camera_model.pose: is no rigid placement"));
  EXPECT_THAT(refusal_with("/camera_model/pose/15", 0), HasSubstr("camera_model.pose: is no rigid placement"));
  EXPECT_THAT(refusal_with("/sensor/saturation_dn", 64), HasSubstr("sensor.saturation_dn: is out of range"));
  EXPECT_THAT(refusal_with("/sensor/responsivity/value", Json({1, 2})), HasSubstr("sensor.responsivity.value: has 2"));
  EXPECT_THAT(refusal_with("/filter/window", 1), HasSubstr("filter.window: is out of range (1)"));
  EXPECT_THAT(refusal_with("/filter/passes", Json::array()), HasSubstr("filter.passes: has 0 elements"));
  EXPECT_THAT(refusal_with("/filter/passes/1/name", "positive"), HasSubstr("filter.passes[1].name: is used twice"));
  EXPECT_THAT(refusal_with("/filter/passes/1/scale", 0), HasSubstr("filter.passes[1].scale: is zero"));
}

TEST(Bench, NamesTheUnknownMemberThatMayBeMeantForAMissingOne) {
  const auto renamed = [](const std::string& object, const std::string& from, const std::string& to) {
    Json json = Json::parse(documented);
    Json& at = json.at(Json::json_pointer(object));
    at[to] = at.at(from);
    at.erase(from);
    const Result<Bench> bench = parse_bench(json.dump(), "bench.json");
    return bench ? "accepted" : bench.error().message();
  };
  EXPECT_EQ(renamed("/camera", "address", "adress"),
            "bench.json: camera.address: is missing; \"adress\" is not known: is \"address\" meant? If not, add it: a "
            "text");
  EXPECT_THAT(renamed("", "camera", "camra"),
              HasSubstr("camera.address: is missing; \"camra\" is not known: is \"camera\" meant?"));
  EXPECT_THAT(renamed("", "version", "versoin"), HasSubstr("\"versoin\" is not known: is \"version\" meant?"));
  EXPECT_THAT(renamed("/filter/passes/1", "scale", "Scale"),
              HasSubstr("filter.passes[1].scale: is missing; \"Scale\" is not known"));
  EXPECT_THAT(renamed("/camera", "address", "colour_of_the_case"), HasSubstr("address: is missing; add it: a text"));
  // "fy" is nearer, but known.
  EXPECT_THAT(renamed("/camera_model", "fx", "f_x"), HasSubstr("\"f_x\" is not known: is \"fx\" meant?"));
  EXPECT_THAT(refusal_without("/camera_model", "fx"), HasSubstr("fx: is missing; add it"));
}

TEST(Bench, RefusesAnotherFormatOrVersion) {
  EXPECT_THAT(refusal_with("/format", "lumifield-plan"), HasSubstr("format: is not \"lumifield-bench\""));
  EXPECT_THAT(refusal_with("/version", 2), HasSubstr("version: is a version this program does not know"));
  EXPECT_THAT(refusal_without("", "version"), HasSubstr("version: is missing"));
}

TEST(Bench, RefusesWhatIsNoJson) {
  const auto message = [](std::string_view text) { return parse_bench(text, "bench.json").error().message(); };
  EXPECT_THAT(message(""), HasSubstr("bench.json: is no valid JSON"));
  EXPECT_THAT(message("[1]"), HasSubstr("holds no JSON object"));
  EXPECT_THAT(message(std::string_view(documented).substr(0, 300)), HasSubstr("is no valid JSON"));
  EXPECT_THAT(refusal_with("/filter/change", "robot"),
              HasSubstr("bench.json: filter.change: \"robot\" is not known; make it one of \"stage\", \"operator\""));
  EXPECT_THAT(message(R"({"format": NaN})"), HasSubstr("is no valid JSON"));
  EXPECT_THAT(message(R"({"format": 1e999})"), HasSubstr("is no valid JSON"));
  EXPECT_THAT(message(std::string(100'000, '[')), HasSubstr("is nested deeper than 32 levels"));
  EXPECT_THAT(message("{\"a\":[" + std::string(500'000, ',') + "]}"), HasSubstr("holds more than 400000 values"));
  EXPECT_THAT(message(std::string(5 << 20, ' ')), HasSubstr("holds more than 4194304 bytes"));
}

TEST(Bench, NotFiniteNumbersDoNotComeBack) {
  Bench bench = *parse_bench(documented, "bench.json");
  bench.tolerance_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(parse_bench(to_json(bench), "bench.json").error().message(),
              HasSubstr("tolerance_mm: has the wrong type"));
}

TEST(Bench, ReadsFilesAndSaysWhyNot) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("bench_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "bench.json") << documented;
  EXPECT_TRUE(read_bench(folder / "bench.json"));
  EXPECT_THAT(read_bench(folder / "none.json").error().message(),
              HasSubstr("No such file or directory; check the path"));
  EXPECT_THAT(read_bench(folder).error().message(), HasSubstr("is no regular file"));
  std::filesystem::remove_all(folder);
}

TEST(Bench, AFolderOfFramesCountsFromTheBenchFile) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("bench_test_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto read = [&](const std::filesystem::path& file, const std::string& kind, const std::string& address,
                        const std::string& path) {
    Json json = Json::parse(documented);
    json["camera"]["kind"] = json["stage"]["kind"] = kind;
    json["camera"]["address"] = address;
    json["stage"]["path"] = path;
    std::ofstream(folder / "bench.json") << json;
    const auto bench = read_bench(file);
    EXPECT_TRUE(bench) << bench.error().message();
    return bench ? std::pair(bench->camera.address, bench->stage.path) : std::pair<std::string, std::string>();
  };
  using testing::Pair;
  const std::filesystem::path file = folder / "bench.json", here = std::filesystem::current_path();
  EXPECT_THAT(read(file, "replay", ".", "../a/./b/"), Pair(folder.string(), (folder.parent_path() / "a/b").string()));
  EXPECT_THAT(read(std::filesystem::relative(file), "replay", "a", "/frames/../b"),
              Pair((folder / "a").string(), "/frames/../b"));
  EXPECT_THAT(read(file, "replay", "..", ""), Pair(folder.parent_path().string(), ""));
  std::filesystem::current_path(folder);
  EXPECT_THAT(read("bench.json", "replay", ".", "a"), Pair(folder.string(), (folder / "a").string()));
  std::filesystem::current_path(here);
  std::filesystem::remove_all(folder);
}

TEST(Bench, OnlyAFolderOfFramesCountsFromTheBenchFile) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / ("bench_test_" + std::to_string(getpid()) + ".json");
  std::ofstream(file) << documented;
  const auto read = read_bench(file), parsed = parse_bench(documented, "bench.json");
  ASSERT_TRUE(read && parsed);
  EXPECT_EQ(to_json(*read), to_json(*parsed));
  Json json = Json::parse(documented);
  json["camera"]["kind"] = "replay", json["camera"]["address"] = ".";
  EXPECT_EQ(parse_bench(json.dump(), "bench.json")->camera.address, ".") << "a text lies nowhere";
  std::filesystem::remove(file);
}

TEST(Bench, TwoReadingsOfAPlaceAreTwiceTheToleranceApart) {
  Json json = Json::parse(documented);
  for (const auto& [tolerance_mm, same_mm] : {std::pair(0.02, 0.1), std::pair(0.3, 0.6)}) {
    json["tolerance_mm"] = tolerance_mm;
    const Result<Bench> bench = parse_bench(json.dump(), "bench.json");
    ASSERT_TRUE(bench) << bench.error().message();
    EXPECT_EQ(bench->camera.same_place_mm, same_mm);
    EXPECT_EQ(bench->stage.same_place_mm, same_mm);
  }
}

TEST(Bench, AReadingNearerToANeighbourIsNotOfThePlace) {
  Json json = Json::parse(documented);
  json["filter"]["spacing_mm"] = {0.3, 0.15};
  json["stage_to_luminaire"]["linear"] = {{-1.5, 0}, {0, 1}};
  const Result<Bench> bench = parse_bench(json.dump(), "bench.json");
  ASSERT_TRUE(bench) << bench.error().message();
  EXPECT_DOUBLE_EQ(cell_step_mm(*bench), 0.1);
  EXPECT_DOUBLE_EQ(bench->camera.same_place_mm, 0.05);
  EXPECT_DOUBLE_EQ(bench->stage.same_place_mm, 0.05);
}

TEST(Bench, TellsWhatHasNoEffectOnItsKindOfCamera) {
  Json json = Json::parse(documented);
  const auto told = [&](const char* kind) {
    json["camera"]["kind"] = kind;
    std::vector<std::string> notes;
    EXPECT_TRUE(parse_bench(json.dump(), "bench.json", &notes));
    return notes;
  };
  json["camera"]["binning"] = 2;
  EXPECT_THAT(told("v4l2"), testing::Contains("bench.json: camera.binning has no effect with the kind \"v4l2\""));
  EXPECT_THAT(told("aravis"), testing::Not(testing::Contains(HasSubstr("width_px"))));
  json["camera"]["width_px"] = 640;
  EXPECT_THAT(told("aravis"), testing::Contains(HasSubstr("camera.width_px has no effect")));
  EXPECT_THAT(told("replay"), testing::Not(testing::Contains(HasSubstr("has no effect"))));
}

TEST(Bench, TellsWhatItDoesNotKnow) {
  std::vector<std::string> notes;
  const std::string written = to_json(*parse_bench(documented, "bench.json"));
  ASSERT_TRUE(parse_bench(written, "bench.json", &notes));
  EXPECT_THAT(notes, testing::Not(testing::Contains(HasSubstr("is not known"))));
  Json json = Json::parse(written);
  json["filter"]["passes"][0]["ofset_mm"] = {1, 2};
  notes.clear();
  ASSERT_TRUE(parse_bench(json.dump(), "bench.json", &notes));
  EXPECT_THAT(notes, testing::Contains("bench.json: filter.passes[0].ofset_mm is not known and ignored"));
}

TEST(Bench, OnlyACarriedLampIsDisplaced) {
  Bench bench = *parse_bench(documented, "bench.json");
  bench.stage_to_luminaire.linear << 0, -2, 3, 0;
  bench.stage_to_luminaire.origin_mm = {10, 20};
  EXPECT_EQ(lamp_displacement_mm(bench, {5, 7}), Vec2(0, 0));
  bench.stage_carries = StageCarries::lamp;
  EXPECT_EQ(lamp_displacement_mm(bench, {5, 7}), Vec2(-4, 35));
}

}  // namespace
}  // namespace lumifield
