#include "luminaire/bench.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "luminaire/file_io.h"
#include "luminaire/json_geometry.h"

namespace lumifield {
namespace {

constexpr std::string_view format = "lumifield-bench";
constexpr int version = 1;
constexpr std::string_view apt_controllers[] = {"kdc101", "bbd30x", "bsc20x"};
constexpr std::string_view carried[] = {"slide", "lamp"};
constexpr std::string_view changes[] = {"stage", "operator"};
constexpr std::string_view bases[] = {"box", "tent", "bell", "bspline2"};
constexpr BasisKind kinds[] = {BasisKind::box, BasisKind::tent, BasisKind::bell, BasisKind::bspline2};

CameraSettings read_camera(const JsonValue& at) {
  CameraSettings c;
  c.kind = at["kind"].text_or(c.kind);
  c.address = at["address"].text();
  if (c.address.empty()) at["address"].refuse("is empty", "give a host address, an id, a serial number or a path");
  c.pixel_format = at["pixel_format"].text_or(c.pixel_format);
  c.gain = at["gain"].number_or(c.gain, {-1e6, 1e6});
  c.readout_s = at["readout_s"].number_or(c.readout_s, {0, 3600});
  c.packet_bytes = at["packet_bytes"].integer_or(c.packet_bytes, 0, 65535);
  if (c.packet_bytes > 0 && c.packet_bytes < 576)
    at["packet_bytes"].refuse("is out of range", "give 576 to 65535, or 0 to have it found");
  c.packet_delay_us = at["packet_delay_us"].number_or(c.packet_delay_us, {0, 1e4});
  c.binning = at["binning"].integer_or(c.binning, 1, 16);
  const auto side = [&](const char* name) {
    return c.kind == "v4l2" || at[name].present() ? at[name].integer_or(0, 0, 65536) : 0;
  };
  c.width_px = side("width_px"), c.height_px = side("height_px");
  const auto only = [&](std::string_view kind, const char* name, bool is_set) {
    if (is_set && c.kind != kind && c.kind != "replay")  // which keeps what the recorded one had
      at[name].note_no_effect("with the kind \"" + c.kind + "\"");
  };
  only("v4l2", "width_px", c.width_px != 0), only("v4l2", "height_px", c.height_px != 0);
  only("aravis", "binning", c.binning != 1);
  return c;
}

AptSettings read_apt(const JsonValue& at) {
  AptSettings a;
  for (const JsonValue& each : at["serials"].elements(1, 2)) a.serials.push_back(each.text());
  a.controller = apt_controllers[at["controller"].choice(apt_controllers)];
  if (a.serials.size() == 1 && a.controller == "kdc101")
    at["serials"].refuse("names one controller of one axis", "name that of the y axis too");
  if (a.serials.size() == 2 && a.serials[0] == a.serials[1])
    at["serials"].refuse("names one controller twice", "name one alone, for bays 1 and 2, or another for the y axis");
  a.counts_per_mm = at["counts_per_mm"].vec2(positive);
  a.direction = at["direction"].vec2_or(a.direction);
  if (!(a.direction.array().abs() == 1).all()) at["direction"].refuse("is no direction", "make each 1 or -1");
  a.travel_mm = at["travel_mm"].vec2(positive);
  return a;
}

StageSettings read_stage(const JsonValue& at) {
  StageSettings s;
  s.kind = at["kind"].text_or(s.kind);
  if (s.kind == "apt")
    s.apt = read_apt(at["apt"]);
  else
    s.path = at["path"].text_or(s.path);
  s.rapid_mm_s = at["rapid_mm_s"].number_or(s.rapid_mm_s, not_negative);
  s.acceleration_mm_s2 = at["acceleration_mm_s2"].number_or(s.acceleration_mm_s2, not_negative);
  s.home = at["home"].flag_or(s.home);
  s.approach_mm = at["approach_mm"].vec2_or(s.approach_mm, {-100, 100});
  s.check_home = at["check_home"].flag_or(s.check_home);
  if (s.check_home && !s.home)
    at["check_home"].refuse("asks for switches that are not looked for at the start", "make \"home\" true too");
  return s;
}

StageToLuminaire read_stage_to_luminaire(const JsonValue& at) {
  StageToLuminaire t;
  const JsonValue linear = at["linear"];
  if (linear.present()) {
    const std::vector<JsonValue> rows = linear.elements(2, 2);
    for (std::size_t k = 0; k < rows.size(); ++k) t.linear.row(static_cast<int>(k)) = rows[k].vec2();
    if (!(std::abs(t.linear.determinant()) > 1e-9 * t.linear.squaredNorm()))
      linear.refuse("cannot be inverted", "make its rows independent");
  } else {
    linear.note_default("[[1, 0], [0, 1]]");
  }
  t.origin_mm = at["origin_mm"].vec2_or(t.origin_mm);
  return t;
}

StageLimits read_limits(const JsonValue& at) {
  const StageLimits limits{at["low"].vec2(), at["high"].vec2()};
  if (!(limits.low_mm.array() < limits.high_mm.array()).all())
    at.refuse("has a low limit not below the high one", "correct it");
  return limits;
}

CameraModel read_camera_model(const JsonValue& at) {
  CameraModel m;
  m.width_px = at["width_px"].integer(1, most_pixels_per_axis);
  m.height_px = at["height_px"].integer(1, most_pixels_per_axis);
  m.fx = at["fx"].number(positive);
  m.fy = at["fy"].number(positive);
  m.cx = at["cx"].number();
  m.cy = at["cy"].number();
  const std::vector<double> distortion = at["distortion"].numbers(5, 5);
  for (std::size_t k = 0; k < distortion.size(); ++k) m.distortion[k] = distortion[k];
  m.pose = at["pose"].rigid_pose();
  if (!at["vignetting"].present()) {
    at["vignetting"].note_default("[0, 0, 0]");
    return m;
  }
  const std::vector<double> vignetting = at["vignetting"].numbers(3, 3);
  for (std::size_t k = 0; k < vignetting.size(); ++k) m.vignetting[k] = vignetting[k];
  return m;
}

Sensor read_sensor(const JsonValue& at) {
  Sensor s;
  s.black_level_dn = at["black_level_dn"].number({0, 65535});
  s.gain_dn_per_e = at["gain_dn_per_e"].number(positive);
  s.read_noise_e = at["read_noise_e"].number(not_negative);
  s.saturation_dn = at["saturation_dn"].number({s.black_level_dn, 65535, true});
  const JsonValue responsivity = at["responsivity"];
  const JsonValue value = responsivity["value"];
  s.responsivity = value.is_array() ? value.numbers(1, 3, positive) : std::vector<double>{value.number(positive)};
  if (s.responsivity.size() == 2) value.refuse("has 2 elements", "give one number, or three for R, G, B");
  s.responsivity_date = responsivity["date"].text_or("");
  s.responsivity_source = responsivity["source"].text_or("");
  return s;
}

FilterSlide read_filter(const JsonValue& at) {
  FilterSlide f;
  f.basis = kinds[at["basis"].choice(bases)];
  f.spacing_mm = at["spacing_mm"].vec2(positive);
  f.window = at["window"].integer(static_cast<int>(std::ceil(2 * Basis(f.basis).half_support())), 64);
  for (const JsonValue& each : at["passes"].elements(1, most_passes)) {
    FilterPass& pass = f.passes.emplace_back();
    pass.name = each["name"].text();
    pass.offset_mm = each["offset_mm"].vec2();
    pass.scale = each["scale"].number();
    if (pass.scale == 0) each["scale"].refuse("is zero", "give the factor of this filter");
    for (std::size_t k = 0; k + 1 < f.passes.size(); ++k)
      if (f.passes[k].name == pass.name) each["name"].refuse("is used twice", "give each pass its own name");
  }
  f.dark_offset_mm = at["dark"]["offset_mm"].vec2();
  f.change = at["change"].choice_or(0, changes) == 0 ? PassChange::stage : PassChange::by_operator;
  return f;
}

using Json = nlohmann::ordered_json;

Json row_major(const Pose& pose) {
  Json json = Json::array();
  for (int k = 0; k < 16; ++k) json.push_back(pose(k / 4, k % 4));
  return json;
}

Json json_of(const StageSettings& s) {
  Json json = {{"kind", s.kind}};
  if (s.kind == "apt")
    json["apt"] = {{"serials", s.apt.serials},
                   {"controller", s.apt.controller},
                   {"counts_per_mm", to_json_array(s.apt.counts_per_mm)},
                   {"direction", to_json_array(s.apt.direction)},
                   {"travel_mm", to_json_array(s.apt.travel_mm)}};
  else
    json["path"] = s.path;
  json["rapid_mm_s"] = s.rapid_mm_s;
  json["acceleration_mm_s2"] = s.acceleration_mm_s2;
  json["home"] = s.home;
  json["approach_mm"] = to_json_array(s.approach_mm);
  json["check_home"] = s.check_home;
  return json;
}

Json json_of(const CameraModel& m) {
  return {{"width_px", m.width_px},
          {"height_px", m.height_px},
          {"fx", m.fx},
          {"fy", m.fy},
          {"cx", m.cx},
          {"cy", m.cy},
          {"distortion", m.distortion},
          {"pose", row_major(m.pose)},
          {"vignetting", m.vignetting}};
}

Json json_of(const Sensor& s) {
  Json json = {{"black_level_dn", s.black_level_dn},
               {"gain_dn_per_e", s.gain_dn_per_e},
               {"read_noise_e", s.read_noise_e},
               {"saturation_dn", s.saturation_dn}};
  Json& responsivity = json["responsivity"];
  responsivity["value"] = s.responsivity;
  if (!s.responsivity_date.empty()) responsivity["date"] = s.responsivity_date;
  if (!s.responsivity_source.empty()) responsivity["source"] = s.responsivity_source;
  return json;
}

Json json_of(const FilterSlide& f) {
  Json passes = Json::array();
  for (const FilterPass& pass : f.passes)
    passes.push_back({{"name", pass.name}, {"offset_mm", to_json_array(pass.offset_mm)}, {"scale", pass.scale}});
  return {{"basis", to_string(f.basis)},
          {"spacing_mm", to_json_array(f.spacing_mm)},
          {"window", f.window},
          {"passes", passes},
          {"dark", {{"offset_mm", to_json_array(f.dark_offset_mm)}}},
          {"change", f.change == PassChange::stage ? "stage" : "operator"}};
}

/// A folder of frames, as seen from the bench file.
void count_from(const std::filesystem::path& file, std::string& frames) {
  if (frames.empty() || std::filesystem::path(frames).is_absolute()) return;
  const std::filesystem::path place = (file.parent_path() / frames / "").lexically_normal();
  frames = place.parent_path().string();  // without the last slash
}

}  // namespace

Bench with_pass(const Bench& bench, int pass) {
  Bench one = bench;
  one.filter.passes = {bench.filter.passes[static_cast<std::size_t>(pass)]};
  return one;
}

double cell_step_mm(const Bench& bench) {
  return bench.filter.spacing_mm.minCoeff() / bench.stage_to_luminaire.linear.operatorNorm();
}

double same_place_mm(const Bench& bench) {
  const double wide_mm = std::max(0.1, 2 * bench.tolerance_mm), half_step_mm = cell_step_mm(bench) / 2;
  return half_step_mm > 0 ? std::min(wide_mm, half_step_mm) : wide_mm;
}

Vec2 lamp_displacement_mm(const Bench& bench, const Vec2& stage_mm) {
  if (bench.stage_carries == StageCarries::slide) return Vec2::Zero();
  return bench.stage_to_luminaire.linear * stage_mm + bench.stage_to_luminaire.origin_mm;
}

Result<Bench> parse_bench(std::string_view json, std::string_view name, std::vector<std::string>* notes,
                          ReaderNotes kind) {
  Result<JsonDocument> document = JsonDocument::parse(json, name);
  if (!document) return tl::unexpected(document.error());
  document->note_unknown_keys();
  if (Status ok = document->check_format(format, version); !ok) return tl::unexpected(ok.error());
  const JsonValue root = document->root();
  Bench b;
  b.name = root["name"].text_or("");
  b.camera = read_camera(root["camera"]);
  b.stage = read_stage(root["stage"]);
  b.stage_carries = root["stage_carries"].choice_or(0, carried) == 0 ? StageCarries::slide : StageCarries::lamp;
  b.stage_to_luminaire = read_stage_to_luminaire(root["stage_to_luminaire"]);
  b.limits = read_limits(root["limits_mm"]);
  b.tolerance_mm = root["tolerance_mm"].number_or(b.tolerance_mm, positive);
  b.lamp_size_mm = root["lamp_size_mm"].vec2(not_negative);
  b.separation_mm = root["planes"]["separation_mm"].number(positive);
  b.camera_model = read_camera_model(root["camera_model"]);
  b.sensor = read_sensor(root["sensor"]);
  b.filter = read_filter(root["filter"]);
  b.camera.same_place_mm = b.stage.same_place_mm = same_place_mm(b);
  if (Status ok = document->finish(notes, kind); !ok) return tl::unexpected(ok.error());
  return b;
}

Result<Bench> read_bench(const std::filesystem::path& file, std::vector<std::string>* notes, ReaderNotes kind) {
  const Result<std::string> text = read_file(file, JsonLimits{}.bytes);
  if (!text) return tl::unexpected(text.error());
  Result<Bench> bench = parse_bench(*text, file.string(), notes, kind);
  if (!bench) return bench;
  std::error_code code;
  const std::filesystem::path whole = std::filesystem::absolute(file, code);
  if (code) return system_failure("could not be followed", file, code.value());
  if (bench->camera.kind == "replay") count_from(whole, bench->camera.address);
  if (bench->stage.kind == "replay") count_from(whole, bench->stage.path);
  return bench;
}

std::string to_json(const Bench& b) {
  Json json;
  json["format"] = format;
  json["version"] = version;
  json["name"] = b.name;
  json["camera"] = {{"kind", b.camera.kind},
                    {"address", b.camera.address},
                    {"pixel_format", b.camera.pixel_format},
                    {"gain", b.camera.gain},
                    {"readout_s", b.camera.readout_s},
                    {"packet_bytes", b.camera.packet_bytes},
                    {"packet_delay_us", b.camera.packet_delay_us},
                    {"binning", b.camera.binning},
                    {"width_px", b.camera.width_px},
                    {"height_px", b.camera.height_px}};
  json["stage"] = json_of(b.stage);
  json["stage_carries"] = b.stage_carries == StageCarries::slide ? "slide" : "lamp";
  const Eigen::Matrix2d& a = b.stage_to_luminaire.linear;
  json["stage_to_luminaire"]["linear"] = Json::array({to_json_array(a.row(0)), to_json_array(a.row(1))});
  json["stage_to_luminaire"]["origin_mm"] = to_json_array(b.stage_to_luminaire.origin_mm);
  json["limits_mm"]["low"] = to_json_array(b.limits.low_mm);
  json["limits_mm"]["high"] = to_json_array(b.limits.high_mm);
  json["tolerance_mm"] = b.tolerance_mm;
  json["lamp_size_mm"] = to_json_array(b.lamp_size_mm);
  json["planes"]["separation_mm"] = b.separation_mm;
  json["camera_model"] = json_of(b.camera_model);
  json["sensor"] = json_of(b.sensor);
  json["filter"] = json_of(b.filter);
  return json_file_text(json);
}

}  // namespace lumifield
