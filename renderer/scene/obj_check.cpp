#include "renderer/scene/obj_check.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

namespace lumifield {
namespace {

constexpr std::string_view blanks = " \t\r";

/// Takes the next word off the front of a line; empty at its end.
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

template <class T>
std::optional<T> number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The first three words as finite floats.
std::optional<std::array<float, 3>> three_numbers(std::string_view line) {
  std::array<float, 3> values{};
  for (float& value : values) {
    const std::optional<double> read = number<double>(next_word(line));
    if (!read || !std::isfinite(static_cast<float>(*read))) return std::nullopt;
    value = static_cast<float>(*read);
  }
  return values;
}

/// Largest index that the faces name of positions, texture coordinates and normals, and where.
struct Highest {
  std::array<long long, 3> index{};
  std::array<std::size_t, 3> line{};
};

/// One corner "v", "v/t", "v//n" or "v/t/n"; negative indices count back from the last element so far.
bool check_corner(std::string_view corner, const std::array<std::size_t, 3>& counts, std::size_t line,
                  Highest& highest) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view field = corner.substr(0, corner.find('/'));
    const bool last = field.size() == corner.size();
    const bool skipped = k == 1 && field.empty() && !last;
    const std::optional<int> index = number<int>(field);
    if (!skipped && (!index || *index == 0)) return false;
    if (!skipped && *index < 0 && static_cast<std::size_t>(-static_cast<long long>(*index)) > counts[k]) return false;
    if (!skipped && *index > highest.index[k]) {
      highest.index[k] = *index;
      highest.line[k] = line;
    }
    if (last) return true;
    corner.remove_prefix(field.size() + 1);
  }
  return false;
}

}  // namespace

Result<ObjCounts> check_obj(std::istream& obj, const std::string& name, std::size_t max_triangles) {
  ObjCounts counts;
  Highest highest;
  std::size_t line_number = 0;
  const auto broken = [&](const std::string& what, std::size_t line) {
    return fail(what, name + ":" + std::to_string(line), "export the mesh again");
  };
  std::string text;
  while (std::getline(obj, text)) {
    ++line_number;
    std::string_view line = text;
    const std::string_view key = next_word(line);
    if (key == "v" || key == "vn") {
      if (!three_numbers(line)) return broken("not three finite numbers", line_number);
      ++(key == "v" ? counts.positions : counts.normals);
    } else if (key == "vt") {
      ++counts.texture_coordinates;
    } else if (key == "f") {
      std::size_t corners = 0;
      for (std::string_view corner = next_word(line); !corner.empty(); corner = next_word(line), ++corners)
        if (!check_corner(corner, {counts.positions, counts.texture_coordinates, counts.normals}, line_number, highest))
          return broken("the face's corner \"" + std::string(corner) + "\" names nothing", line_number);
      if (corners < 3) return broken("a face of " + std::to_string(corners) + " corners", line_number);
      counts.triangles += corners - 2;
      if (counts.triangles > max_triangles)
        return fail("more than " + std::to_string(max_triangles) + " triangles", name, "simplify the mesh");
    }
  }
  if (obj.bad()) return fail("cannot be read to its end", name, "check the disk");
  const std::array<std::size_t, 3> totals = {counts.positions, counts.texture_coordinates, counts.normals};
  for (std::size_t k = 0; k < 3; ++k)
    if (static_cast<std::size_t>(highest.index[k]) > totals[k])
      return broken("index " + std::to_string(highest.index[k]) + " of " + std::to_string(totals[k]), highest.line[k]);
  return counts;
}

Status check_mtl(std::istream& mtl, const std::string& name) {
  std::size_t line_number = 0;
  std::string text;
  while (std::getline(mtl, text)) {
    ++line_number;
    std::string_view line = text;
    if (next_word(line) != "Kd") continue;
    const auto diffuse = three_numbers(line);
    if (!diffuse || std::ranges::any_of(*diffuse, [](float v) { return v < 0 || v > 1; }))
      return fail("Kd is not three numbers from 0 to 1", name + ":" + std::to_string(line_number),
                  "give the reflectance of red, green and blue");
  }
  if (mtl.bad()) return fail("cannot be read to its end", name, "check the disk");
  return {};
}

}  // namespace lumifield
