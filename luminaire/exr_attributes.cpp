#include "luminaire/exr_attributes.h"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace lumifield {
namespace {

constexpr std::size_t magic_and_version = 8;
constexpr std::size_t longest_name = 255;

struct TypeSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr TypeSize fixed[] = {
    {"box2i", 16},
    {"box2f", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33f", 36},
    {"m33d", 72},
    {"m44f", 64},
    {"m44d", 128},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2i", 8},
    {"v2f", 8},
    {"v2d", 16},
    {"v3i", 12},
    {"v3f", 12},
    {"v3d", 24},
};

/// Takes little-endian numbers and texts from the front of what is left.
class Walk {
 public:
  explicit Walk(std::string_view bytes) : left_(bytes) {}

  /// Up to its NUL. False when there is none, or a longer text than the library reads.
  bool text(std::string_view& to) {
    const std::size_t end = left_.substr(0, longest_name).find('\0');
    if (end == std::string_view::npos) return false;
    to = left_.substr(0, end);
    left_.remove_prefix(end + 1);
    return true;
  }
  bool number(std::uint32_t& to) {
    if (left_.size() < 4) return false;
    to = 0;
    for (std::size_t k = 0; k < 4; ++k)
      to |= static_cast<std::uint32_t>(static_cast<unsigned char>(left_[k])) << (8 * k);
    left_.remove_prefix(4);
    return true;
  }
  bool skip(std::size_t bytes, std::string_view* skipped = nullptr) {
    if (bytes > left_.size()) return false;
    if (skipped) *skipped = left_.substr(0, bytes);
    left_.remove_prefix(bytes);
    return true;
  }
  bool at_end() const { return left_.empty(); }

 private:
  std::string_view left_;
};

bool channel_list_fits(std::string_view value) {
  constexpr std::size_t type_and_sampling = 16;
  Walk walk(value);
  std::string_view name;
  while (walk.text(name)) {
    if (name.empty()) return walk.at_end();
    if (!walk.skip(type_and_sampling)) return false;
  }
  return false;
}

bool texts_fit(std::string_view value) {
  Walk walk(value);
  std::uint32_t bytes = 0;
  while (!walk.at_end())
    if (!walk.number(bytes) || !walk.skip(bytes)) return false;
  return true;
}

bool preview_fits(std::string_view value) {
  Walk walk(value);
  std::uint32_t width = 0, height = 0;
  if (!walk.number(width) || !walk.number(height)) return false;
  return width <= 65536 && height <= 65536 && walk.skip(std::size_t{4} * width * height) && walk.at_end();
}

bool value_fits(std::string_view type, std::string_view value) {
  for (const TypeSize& each : fixed)
    if (type == each.type) return value.size() == each.bytes;
  if (type == "chlist") return channel_list_fits(value);
  if (type == "stringvector") return texts_fit(value);
  if (type == "floatvector") return value.size() % 4 == 0;
  if (type == "preview") return preview_fits(value);
  // Deep images only; it is compressed, so its length bounds nothing.
  return type != "idmanifest";
}

}  // namespace

bool exr_attributes_fit(std::string_view bytes) {
  Walk walk(bytes);
  if (!walk.skip(magic_and_version)) return false;
  std::string_view name, type, value;
  std::uint32_t size = 0;
  while (walk.text(name)) {
    if (name.empty()) return true;
    if (!walk.text(type) || type.empty() || !walk.number(size) || !walk.skip(size, &value)) return false;
    if (!value_fits(type, value)) return false;
  }
  return false;
}

}  // namespace lumifield
