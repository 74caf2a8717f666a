#include "luminaire/json_reader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "luminaire/nearest_word.h"

namespace lumifield {
namespace {

constexpr std::size_t most_unknown_told = 20;

/// Counts brackets and separators outside strings, so that depth and memory are known before the text is parsed.
Status check_limits(std::string_view json, std::string_view name, const JsonLimits& limits) {
  const auto refuse = [&](const std::string& what) {
    return fail(what, std::string(name), "check that it is the right file");
  };
  if (json.size() > limits.bytes) return refuse("holds more than " + std::to_string(limits.bytes) + " bytes");
  int depth = 0;
  std::size_t values = 1;
  bool quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    if (quoted) {
      if (c == '\\') ++k;
      quoted = c != '"';
      continue;
    }
    quoted = c == '"';
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == '[' || c == '{' || c == ',') ++values;
    if (depth > limits.depth) return refuse("is nested deeper than " + std::to_string(limits.depth) + " levels");
    if (values > limits.values) return refuse("holds more than " + std::to_string(limits.values) + " values");
  }
  return {};
}

std::string short_text(double x) {
  std::ostringstream out;
  out << x;
  return out.str();
}

std::string in_words(Range range) {
  const bool below = range.low <= -largest_number, above = range.high >= largest_number;
  if (below && above) return "a number";
  if (above)
    return range.open_low ? "a number above " + short_text(range.low) : "a number from " + short_text(range.low);
  return "a number " + std::string(range.open_low ? "above " : "from ") + short_text(range.low) + " to " +
         short_text(range.high);
}

std::string list_of(std::span<const std::string_view> choices) {
  std::string text;
  for (const std::string_view choice : choices) text += (text.empty() ? "\"" : ", \"") + std::string(choice) + "\"";
  return text;
}

}  // namespace

JsonDocument::JsonDocument(std::string name) : name_(std::move(name)), json_(std::make_unique<nlohmann::json>()) {}
JsonDocument::~JsonDocument() = default;
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;

Result<JsonDocument> JsonDocument::parse(std::string_view json, std::string_view name, const JsonLimits& limits) {
  if (Status ok = check_limits(json, name, limits); !ok) return tl::unexpected(ok.error());
  JsonDocument document{std::string(name)};
  try {
    *document.json_ = nlohmann::json::parse(json.begin(), json.end());
  } catch (const nlohmann::json::exception& e) {
    // The library's own prefix, "[json.exception.parse_error.101] ", says nothing to an operator.
    std::string_view what = e.what();
    if (const auto end = what.find("] "); end != std::string_view::npos) what.remove_prefix(end + 2);
    return fail("is no valid JSON (" + std::string(what) + ")", std::string(name), "correct it");
  }
  if (!document.json_->is_object())
    return fail("holds no JSON object", std::string(name), "check that it is the right file");
  return document;
}

JsonValue JsonDocument::root() { return {this, json_.get(), ""}; }

Status JsonDocument::check_format(std::string_view format, int version) {
  const JsonValue found = root()["format"];
  if (found.text() != format)
    found.refuse("is not \"" + std::string(format) + "\"", "check that it is the right kind of file");
  const JsonValue number = root()["version"];
  if (number.integer(0, 1'000'000) != version)
    number.refuse("is a version this program does not know (it reads " + std::to_string(version) + ")",
                  "use the program that wrote the file");
  return status();
}

Status JsonDocument::status() const {
  if (!error_) return {};
  Error error = *error_;
  if (const auto found = misspelt())
    error.remedy = "\"" + *found + "\" is not known: is \"" + missing_ + "\" meant? If not, " + error.remedy;
  return fail_in(name_, std::move(error));
}

/// A member that nothing has asked for, beside one that was missed. A guess, which gets better the more was asked for.
std::optional<std::string> JsonDocument::misspelt() const {
  if (!notes_unknown_ || !lacking_) return {};
  std::vector<std::string> unknown;
  for (const auto& [key, member] : lacking_->items())
    if (!asked_.contains(&member)) unknown.push_back(key);
  return nearest_word(missing_, unknown);
}

Status JsonDocument::finish(std::vector<std::string>* notes, ReaderNotes kind) const {
  if (error_) return status();
  if (!notes) return {};
  if (kind == ReaderNotes::all)
    for (const std::string& each : defaults_) notes->push_back(name_ + ": " + each);
  for (const std::string& each : no_effect_) notes->push_back(name_ + ": " + each);
  std::vector<std::string> unknown;
  if (notes_unknown_) collect_unknown(*json_, "", unknown);
  for (std::size_t k = 0; k < std::min(unknown.size(), most_unknown_told); ++k)
    notes->push_back(name_ + ": " + unknown[k] + " is not known and ignored");
  if (unknown.size() > most_unknown_told)
    notes->push_back(name_ + ": " + std::to_string(unknown.size() - most_unknown_told) +
                     " more members are not known and ignored");
  return {};
}

void JsonDocument::collect_unknown(const nlohmann::json& value, const std::string& place,
                                   std::vector<std::string>& unknown) const {
  if (value.is_array())
    for (std::size_t k = 0; k < value.size(); ++k)
      collect_unknown(value[k], place + "[" + std::to_string(k) + "]", unknown);
  if (!visited_.contains(&value)) return;
  for (const auto& [key, member] : value.items()) {
    const std::string at = place.empty() ? key : place + "." + key;
    if (asked_.contains(&member))
      collect_unknown(member, at, unknown);
    else
      unknown.push_back(at.substr(0, 200));
  }
}

bool JsonValue::is_null() const { return value_ && value_->is_null(); }
bool JsonValue::is_array() const { return value_ && value_->is_array(); }

void JsonValue::refuse(std::string what, std::string remedy) const {
  if (!document_->error_) document_->error_ = Error{std::move(what), place_, std::move(remedy)};
}

void JsonValue::note_default(std::string_view standard) const {
  document_->defaults_.push_back(place_ + " is absent, taken as " + std::string(standard));
}

void JsonValue::note_no_effect(std::string_view why) const {
  document_->no_effect_.push_back(place_ + " has no effect " + std::string(why));
}

bool JsonValue::require(bool right_type, std::string_view type) const {
  if (!present())
    refuse_missing(type);
  else if (!right_type)
    refuse("has the wrong type", "make it " + std::string(type));
  return right_type;
}

void JsonValue::refuse_missing(std::string_view type) const {
  if (document_->error_) return;
  document_->lacking_ = lacking_;
  document_->missing_ = missing_;
  refuse("is missing", "add it: " + std::string(type));
}

JsonValue JsonValue::operator[](std::string_view key) const {
  JsonValue absent{document_, nullptr, place_.empty() ? std::string(key) : place_ + "." + std::string(key)};
  absent.lacking_ = present() ? value_ : lacking_;
  absent.missing_ = present() ? std::string(key) : missing_;
  if (!present() || !require(value_->is_object(), "an object")) return absent;
  const auto found = value_->find(std::string(key));
  const nlohmann::json* member = found == value_->end() ? nullptr : &*found;
  if (document_->notes_unknown_) {
    document_->visited_.insert(value_);
    if (member) document_->asked_.insert(member);
  }
  return member ? JsonValue{document_, member, std::move(absent.place_)} : absent;
}

JsonValue JsonValue::element(std::size_t k) const {
  return {document_, &(*value_)[k], place_ + "[" + std::to_string(k) + "]"};
}

double JsonValue::number(Range range) const {
  const std::string type = in_words(range);
  if (!require(present() && value_->is_number(), type)) return std::max(range.low, 0.0);
  const double x = value_->get<double>();
  const bool inside = std::isfinite(x) && x <= range.high && (range.open_low ? x > range.low : x >= range.low);
  if (!inside) {
    const bool too_large = x > range.high && range.high >= largest_number;
    refuse("is out of range (" + short_text(x) + ")",
           "make it " + type + (too_large ? ", at most " + short_text(range.high) : ""));
  }
  return x;
}

double JsonValue::number_or(double standard, Range range) const {
  if (present()) return number(range);
  note_default(short_text(standard));
  return standard;
}

int JsonValue::integer(int low, int high) const {
  const std::string type = "a whole number from " + std::to_string(low) + " to " + std::to_string(high);
  if (!require(present() && value_->is_number(), type)) return low;
  const double x = value_->get<double>();
  if (x >= low && x <= high && x == std::floor(x)) return static_cast<int>(x);
  refuse("is out of range (" + short_text(x) + ")", "make it " + type);
  return low;
}

int JsonValue::integer_or(int standard, int low, int high) const {
  if (present()) return integer(low, high);
  note_default(std::to_string(standard));
  return standard;
}

bool JsonValue::flag_or(bool standard) const {
  if (present()) return require(value_->is_boolean(), "true or false") && value_->get<bool>();
  note_default(standard ? "true" : "false");
  return standard;
}

std::string JsonValue::text() const {
  constexpr std::size_t longest = 65536;
  if (!require(present() && value_->is_string(), "a text")) return {};
  const auto& text = value_->get_ref<const std::string&>();
  if (text.size() > longest) refuse("is longer than " + std::to_string(longest) + " bytes", "shorten it");
  return text.substr(0, longest);
}

std::string JsonValue::text_or(std::string_view standard) const {
  if (present()) return text();
  note_default("\"" + std::string(standard) + "\"");
  return std::string(standard);
}

std::size_t JsonValue::choice(std::span<const std::string_view> choices) const {
  const std::string chosen = text();
  const auto found = std::find(choices.begin(), choices.end(), chosen);
  if (found != choices.end()) return static_cast<std::size_t>(found - choices.begin());
  refuse("\"" + chosen.substr(0, 100) + "\" is not known", "make it one of " + list_of(choices));
  return 0;
}

std::size_t JsonValue::choice_or(std::size_t standard, std::span<const std::string_view> choices) const {
  if (present()) return choice(choices);
  note_default("\"" + std::string(choices[standard]) + "\"");
  return standard;
}

std::vector<JsonValue> JsonValue::elements(std::size_t fewest, std::size_t most) const {
  const std::string type = "an array of " + std::to_string(fewest) +
                           (fewest == most ? "" : " to " + std::to_string(most)) +
                           (most == 1 ? " element" : " elements");
  if (!require(present() && value_->is_array(), type)) return {};
  if (value_->size() < fewest || value_->size() > most) {
    refuse("has " + std::to_string(value_->size()) + " elements", "make it " + type);
    return {};
  }
  std::vector<JsonValue> all;
  all.reserve(value_->size());
  for (std::size_t k = 0; k < value_->size(); ++k) all.push_back(element(k));
  return all;
}

std::vector<double> JsonValue::numbers(std::size_t fewest, std::size_t most, Range range) const {
  std::vector<double> all;
  for (const JsonValue& each : elements(fewest, most)) all.push_back(each.number(range));
  return all;
}

Vec2 JsonValue::vec2(Range range) const {
  const std::vector<double> v = numbers(2, 2, range);
  return v.size() == 2 ? Vec2(v[0], v[1]) : Vec2(0, 0);
}

Vec3 JsonValue::vec3(Range range) const {
  const std::vector<double> v = numbers(3, 3, range);
  return v.size() == 3 ? Vec3(v[0], v[1], v[2]) : Vec3(0, 0, 0);
}

Vec2 JsonValue::vec2_or(const Vec2& standard, Range range) const {
  if (present()) return vec2(range);
  note_default("[" + short_text(standard.x()) + ", " + short_text(standard.y()) + "]");
  return standard;
}

Vec3 JsonValue::vec3_or(const Vec3& standard, Range range) const {
  if (present()) return vec3(range);
  note_default("[" + short_text(standard.x()) + ", " + short_text(standard.y()) + ", " + short_text(standard.z()) +
               "]");
  return standard;
}

Pose JsonValue::rigid_pose() const {
  constexpr double tolerance = 1e-4;
  const std::vector<double> v = numbers(16, 16);
  Pose pose = Pose::Identity();
  if (v.size() != 16) return pose;
  for (int k = 0; k < 16; ++k) pose(k / 4, k % 4) = v[static_cast<std::size_t>(k)];
  const Eigen::Matrix3d rotation = pose.topLeftCorner<3, 3>();
  const Vec3 x = rotation.col(0), y = rotation.col(1), z = rotation.col(2);
  const double determinant = x.cross(y).dot(z);
  const bool orthonormal =
      (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= tolerance;
  if (!orthonormal || determinant < 0 || pose.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
    refuse("is no rigid placement", "give a rotation and a shift, row by row, the last row 0 0 0 1");
  return pose;
}

std::vector<std::string> JsonValue::keys(std::size_t most) const {
  if (!require(present() && value_->is_object(), "an object")) return {};
  if (value_->size() > most) {
    refuse("has " + std::to_string(value_->size()) + " members", "leave at most " + std::to_string(most));
    return {};
  }
  std::vector<std::string> all;
  for (const auto& [key, value] : value_->items()) all.push_back(key);
  return all;
}

std::string JsonValue::dump() const {
  return present() ? value_->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) : std::string();
}

}  // namespace lumifield
