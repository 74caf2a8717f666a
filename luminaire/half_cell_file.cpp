#include "luminaire/half_cell_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "luminaire/bench.h"
#include "luminaire/json_geometry.h"
#include "luminaire/plan.h"

namespace lumifield {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the frames are stored as they lie in memory");

constexpr std::string_view half_format = "lumifield-half-cell", dark_format = "lumifield-dark-set";
constexpr int version = 1;
constexpr std::size_t sha_digits = 64;
constexpr std::string_view patterns[] = {"mono", "rggb", "grbg", "gbrg", "bggr"};
constexpr const char* remedy = "go on with the scan by --resume: it is measured again";

std::string with_frames(Json header, const Bracket& bracket) {
  std::size_t bytes = 0;
  for (const RawImage& frame : bracket) {
    header["frames"].push_back({{"width_px", frame.width_px},
                                {"height_px", frame.height_px},
                                {"bits", frame.bits},
                                {"pattern", patterns[static_cast<std::size_t>(frame.pattern)]},
                                {"exposure_s", frame.exposure_s},
                                {"gain", frame.gain}});
    bytes += frame.dn.size() * sizeof(std::uint16_t);
  }
  std::string rest = header.dump() + "\n";
  rest.reserve(rest.size() + bytes);
  for (const RawImage& frame : bracket)
    rest.append(reinterpret_cast<const char*>(frame.dn.data()), frame.dn.size() * sizeof(std::uint16_t));
  return sha256_hex(rest) + "\n" + rest;
}

struct Parts {
  JsonDocument header;
  std::string_view dn;
};

/// Of a file that is whole and of this format.
Result<Parts> parts_of(std::string_view bytes, std::string_view where, std::string_view format) {
  const std::size_t end = bytes.size() > sha_digits ? bytes.find('\n', sha_digits + 1) : std::string_view::npos;
  if (end == std::string_view::npos || bytes[sha_digits] != '\n')
    return fail("ends early or is no half cell", std::string(where), remedy);
  const std::string_view rest = bytes.substr(sha_digits + 1);
  if (sha256_hex(rest) != bytes.substr(0, sha_digits))
    return fail("is not what was written: its SHA-256 differs", std::string(where), remedy);
  Result<JsonDocument> header = JsonDocument::parse(bytes.substr(sha_digits + 1, end - sha_digits - 1), where);
  if (!header) return tl::unexpected(header.error());
  if (Status ok = header->check_format(format, version); !ok) return tl::unexpected(ok.error());
  return Parts{std::move(*header), bytes.substr(end + 1)};
}

RawImage read_frame(const JsonValue& at) {
  RawImage frame;
  frame.width_px = at["width_px"].integer(1, most_pixels_per_axis);
  frame.height_px = at["height_px"].integer(1, most_pixels_per_axis);
  frame.bits = at["bits"].integer(1, 16);
  frame.pattern = static_cast<SensorPattern>(at["pattern"].choice(patterns));
  frame.exposure_s = at["exposure_s"].number({0, 3600, true});
  frame.gain = at["gain"].number({-200, 200});
  return frame;
}

std::size_t pixels(const RawImage& frame) {
  return static_cast<std::size_t>(frame.width_px) * static_cast<std::size_t>(frame.height_px);
}

/// Their DN are still to come; nothing of them is allocated before the file was asked for its size.
Bracket read_frames(const JsonValue& at) {
  Bracket bracket;
  for (const JsonValue& each : at.elements(1, most_exposures + 1)) bracket.push_back(read_frame(each));
  return bracket;
}

Status fill(Bracket& bracket, std::string_view dn, std::string_view where) {
  std::size_t bytes = 0;
  for (const RawImage& frame : bracket) bytes += pixels(frame) * sizeof(std::uint16_t);
  if (bytes != dn.size())
    return fail("holds " + std::to_string(dn.size()) + " bytes of frames, its header says " + std::to_string(bytes),
                std::string(where), remedy);
  for (RawImage& frame : bracket) {
    frame.dn.resize(pixels(frame));
    std::memcpy(frame.dn.data(), dn.data(), frame.dn.size() * sizeof(std::uint16_t));
    dn.remove_prefix(frame.dn.size() * sizeof(std::uint16_t));
  }
  return {};
}

/// Not finite is written as null.
double read_figure(const JsonValue& at) {
  return at.is_null() ? std::numeric_limits<double>::quiet_NaN() : at.number();
}

}  // namespace

std::string encode_half_cell(const HalfCell& half, const std::string& dark) {
  const RawPass& pass = half.raw.passes.front();
  return with_frames({{"format", half_format},
                      {"version", version},
                      {"row", half.raw.cell.row},
                      {"column", half.raw.cell.column},
                      {"pass", half.pass},
                      {"generation", half.generation},
                      {"stage_mm", to_json_array(pass.stage_mm)},
                      {"position_error_mm", half.raw.position_error_mm},
                      {"drift", half.raw.drift},
                      {"reference_dn_per_s", half.raw.reference_dn_per_s},
                      {"dark", dark}},
                     pass.bracket);
}

std::string encode_dark_set(const DarkSet& dark) {
  return with_frames({{"format", dark_format}, {"version", version}, {"block", dark.block}}, dark.bracket);
}

Result<HalfCellFile> decode_half_cell(std::string_view bytes, std::string_view where) {
  Result<Parts> parts = parts_of(bytes, where, half_format);
  if (!parts) return tl::unexpected(parts.error());
  const JsonValue root = parts->header.root();
  HalfCellFile file;
  RawCell& raw = file.half.raw;
  raw.cell = {root["row"].integer(0, most_cells_per_axis - 1), root["column"].integer(0, most_cells_per_axis - 1)};
  file.half.pass = root["pass"].integer(0, static_cast<int>(most_passes) - 1);
  file.half.generation = root["generation"].integer(1, 1'000'000'000);
  raw.position_error_mm = root["position_error_mm"].number(not_negative);
  raw.drift = root["drift"].number();
  raw.reference_dn_per_s = read_figure(root["reference_dn_per_s"]);
  file.dark = root["dark"].text();
  RawPass pass;
  pass.stage_mm = root["stage_mm"].vec2();
  pass.bracket = read_frames(root["frames"]);
  if (Status ok = parts->header.status(); !ok) return tl::unexpected(ok.error());
  if (Status ok = fill(pass.bracket, parts->dn, where); !ok) return tl::unexpected(ok.error());
  for (RawImage& frame : pass.bracket) frame.stage_mm = pass.stage_mm;
  raw.passes.push_back(std::move(pass));
  return file;
}

Result<DarkSet> decode_dark_set(std::string_view bytes, std::string_view where) {
  Result<Parts> parts = parts_of(bytes, where, dark_format);
  if (!parts) return tl::unexpected(parts.error());
  DarkSet dark;
  dark.block = parts->header.root()["block"].integer(0, 1'000'000);
  dark.bracket = read_frames(parts->header.root()["frames"]);
  if (Status ok = parts->header.status(); !ok) return tl::unexpected(ok.error());
  if (Status ok = fill(dark.bracket, parts->dn, where); !ok) return tl::unexpected(ok.error());
  return dark;
}

}  // namespace lumifield
