#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/geometry.h"
#include "luminaire/reader_notes.h"

namespace lumifield {

/// Typed reading of JSON files, for the sources that read one.
///
/// A document remembers the first thing found wrong and its place ("bench.json: camera.readout_s"); after that every
/// access returns a value of the asked type without meaning, so that a parser reads straight through and asks
/// `status()` once at its end. A parser must not act on values (allocate, index) before it asked. Defaults taken are
/// recorded. Unknown keys are ignored, and recorded on demand: then a member that is missing is told with the unknown
/// one beside it that may be meant. Thread-bound.

/// Numbers allowed; `open_low` leaves `low` itself out.
struct Range {
  double low = std::numeric_limits<double>::lowest(), high = std::numeric_limits<double>::max();
  bool open_low = false;
};
/// Largest length, time or factor that files may hold: keeps products of a few of them finite.
constexpr double largest_number = 1e12;
constexpr Range any_number{-largest_number, largest_number};
constexpr Range positive{0, largest_number, true};
constexpr Range not_negative{0, largest_number};
constexpr Range share{0, 1};

struct JsonLimits {
  std::size_t bytes = std::size_t{4} << 20;
  std::size_t values = 400'000;
  int depth = 32;
};

class JsonDocument;

/// One value of a document and its place. Value type, valid as long as its document.
class JsonValue {
 public:
  /// A member; absent members and members of absent objects are absent. Refuses what is present and no object.
  JsonValue operator[](std::string_view key) const;
  bool present() const { return value_ != nullptr; }
  bool is_null() const;
  bool is_array() const;

  double number(Range range = any_number) const;
  double number_or(double standard, Range range = any_number) const;
  int integer(int low, int high) const;
  int integer_or(int standard, int low, int high) const;
  bool flag_or(bool standard) const;
  std::string text() const;
  std::string text_or(std::string_view standard) const;
  /// One of `choices`; its index.
  std::size_t choice(std::span<const std::string_view> choices) const;
  std::size_t choice_or(std::size_t standard, std::span<const std::string_view> choices) const;

  /// An array of numbers, `fewest` to `most` of them; empty when wrong.
  std::vector<double> numbers(std::size_t fewest, std::size_t most, Range range = any_number) const;
  Vec2 vec2(Range range = any_number) const;
  Vec2 vec2_or(const Vec2& standard, Range range = any_number) const;
  Vec3 vec3(Range range = any_number) const;
  Vec3 vec3_or(const Vec3& standard, Range range = any_number) const;
  /// Sixteen numbers, row by row, of a rigid placement: refuses what is not orthonormal within 1e-4.
  Pose rigid_pose() const;

  /// The elements of an array, or of nothing when absent or wrong.
  std::vector<JsonValue> elements(std::size_t fewest, std::size_t most) const;
  std::vector<std::string> keys(std::size_t most) const;
  /// The value as JSON text, in one line.
  std::string dump() const;

  /// Records the value as wrong: `what` is "is no number", `remedy` "give a number".
  void refuse(std::string what, std::string remedy) const;
  /// Records that the value is absent and what stands for it.
  void note_default(std::string_view standard) const;
  /// Records that the value, as the others are, has no effect: `why` is "without a camera".
  void note_no_effect(std::string_view why) const;
  const std::string& place() const { return place_; }

 private:
  friend class JsonDocument;
  JsonValue(JsonDocument* document, const nlohmann::json* value, std::string place)
      : document_(document), value_(value), place_(std::move(place)) {}
  JsonValue element(std::size_t k) const;
  bool require(bool right_type, std::string_view type) const;
  void refuse_missing(std::string_view type) const;

  JsonDocument* document_;
  const nlohmann::json* value_;
  std::string place_;
  // Of an absent member: the innermost object that is there, and which of its members is not.
  const nlohmann::json* lacking_ = nullptr;
  std::string missing_ = {};
};

class JsonDocument {
 public:
  /// Refuses text that is no JSON object, too large, too deep or with too many values. `name` stands for the file.
  static Result<JsonDocument> parse(std::string_view json, std::string_view name, const JsonLimits& limits = {});
  ~JsonDocument();
  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;

  JsonValue root();
  /// Requires "format" and "version" to be these.
  Status check_format(std::string_view format, int version);
  /// The first thing found wrong.
  Status status() const;
  /// From now on keys of visited objects that nobody asks for are recorded. Before the first access.
  void note_unknown_keys() { notes_unknown_ = true; }
  /// Same as status(), with defaults taken (if `kind` is all), and keys that are unknown or without effect, appended to
  /// `notes`, if given, when all is right; each with the file's name.
  Status finish(std::vector<std::string>* notes, ReaderNotes kind = ReaderNotes::all) const;
  const std::vector<std::string>& defaults() const { return defaults_; }

 private:
  friend class JsonValue;
  explicit JsonDocument(std::string name);
  std::optional<std::string> misspelt() const;
  void collect_unknown(const nlohmann::json& value, const std::string& place, std::vector<std::string>& unknown) const;
  std::string name_;
  std::unique_ptr<nlohmann::json> json_;
  std::optional<Error> error_;
  const nlohmann::json* lacking_ = nullptr;  ///< of an error of a missing member: as in JsonValue
  std::string missing_;
  std::vector<std::string> defaults_, no_effect_;
  bool notes_unknown_ = false;
  std::set<const nlohmann::json*> visited_, asked_;  ///< objects with an access to members; values asked for
};

/// Text of a JSON file: two spaces a level, arrays of numbers in one line, a final newline.
std::string json_file_text(const nlohmann::ordered_json& json);

}  // namespace lumifield
