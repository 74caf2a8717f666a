#include "renderer/scene/checked_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "luminaire/scene.h"

namespace lumifield {
namespace {

constexpr std::string_view blanks = " \t";
constexpr std::size_t longest_line = std::size_t{16} << 20;
constexpr const char* again = "export the mesh again";

void skip_blanks(std::string_view& line) { line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size())); }

/// Takes the next word off the front of a line; empty at its end.
std::string_view next_word(std::string_view& line) {
  skip_blanks(line);
  const std::string_view word = line.substr(0, line.find_first_of(blanks));
  line.remove_prefix(word.size());
  return word;
}

template <class T>
std::optional<T> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<float> finite(std::string_view word) {
  const std::optional<double> read = number<double>(word);
  if (!read || !std::isfinite(static_cast<float>(*read))) return std::nullopt;
  return static_cast<float>(*read);
}

/// The first three words as finite floats.
std::optional<std::array<float, 3>> three_numbers(std::string_view line) {
  std::array<float, 3> values{};
  for (float& value : values) {
    const std::optional<float> read = finite(next_word(line));
    if (!read) return std::nullopt;
    value = *read;
  }
  return values;
}

/// Digits enough to read the same floats again.
std::string spelled(std::string_view keyword, std::span<const float> values) {
  std::string line(keyword);
  std::array<char, 32> digits{};
  for (const float value : values) {
    const auto [end, error] =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::scientific, 8);
    line.append(" ").append(digits.data(), end);
  }
  return line;
}

std::string joined(std::string_view keyword, std::string_view rest) {
  skip_blanks(rest);
  return rest.empty() ? std::string() : std::string(keyword).append(" ").append(rest);
}

}  // namespace

std::string CheckedText::refuse(std::string what, std::string remedy) {
  std::string where = name_;
  where.append(":").append(std::to_string(line_number_));
  status_ = fail(std::move(what), std::move(where), std::move(remedy));
  return {};
}

/// Lines end with \n, \r\n or \r.
bool CheckedText::read_line() {
  constexpr auto end = traits_type::eof();
  line_.clear();
  int_type c = source_.sbumpc();
  if (c == end) return false;
  ++line_number_;
  for (; c != end && c != '\n' && c != '\r'; c = source_.sbumpc()) {
    if (c == 0 || line_.size() == longest_line) {
      refuse("not lines of text", "use a Wavefront OBJ or MTL file");
      return false;
    }
    line_.push_back(static_cast<char>(c));
  }
  if (c == '\r' && source_.sgetc() == '\n') source_.sbumpc();
  return true;
}

CheckedText::int_type CheckedText::underflow() {
  given_.clear();
  while (given_.empty()) {
    if (!status_ || !read_line()) return traits_type::eof();
    std::string_view rest = line_;
    const std::string_view keyword = next_word(rest);
    given_ = plain(keyword, rest);
    if (!status_) return traits_type::eof();
  }
  given_.push_back('\n');
  setg(given_.data(), given_.data(), given_.data() + given_.size());
  return traits_type::to_int_type(given_.front());
}

std::string ObjText::plain(std::string_view keyword, std::string_view rest) {
  if (keyword == "v" || keyword == "vn") return vertex(keyword, rest);
  if (keyword == "f") return face(rest);
  if (keyword == "usemtl" || keyword == "mtllib") return joined(keyword, rest);
  if (keyword == "vt") return texture_coordinates(rest);
  return {};
}

std::string ObjText::vertex(std::string_view keyword, std::string_view rest) {
  const auto values = three_numbers(rest);
  if (!values) return refuse("not three finite numbers", again);
  std::size_t& count = keyword == "v" ? positions_ : normals_;
  if (++count > 3 * most_triangles_) return refuse("too many vertices", "simplify the mesh");
  return spelled(keyword, *values);
}

/// u, and v where it is given; a third is depth, which pictures have none of.
std::string ObjText::texture_coordinates(std::string_view rest) {
  const std::optional<float> u = finite(next_word(rest));
  const std::string_view second = next_word(rest);
  const std::optional<float> v = second.empty() ? 0.0F : finite(second);
  if (!u || !v) return refuse("not one or two finite numbers", again);
  if (++texture_coordinates_ > 3 * most_triangles_) return refuse("too many texture coordinates", "simplify the mesh");
  return spelled("vt", std::array{*u, *v});
}

std::string ObjText::face(std::string_view rest) {
  std::string line = "f";
  std::size_t corners = 0;
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest), ++corners) {
    const std::optional<std::string> plain_corner = corner(word);
    if (!plain_corner) {
      std::string what = "the face's corner \"";
      return refuse(what.append(word).append("\" names nothing read so far"), again);
    }
    line.append(" ").append(*plain_corner);
  }
  if (corners < 3) return refuse("a face of fewer than 3 corners", again);
  triangles_ += corners - 2;
  if (triangles_ > most_triangles_)
    return refuse("more than " + std::to_string(most_triangles_) + " triangles", "simplify the mesh");
  return line;
}

/// "v", "v/t", "v//n" or "v/t/n"; a negative index counts back from the last element so far.
std::optional<std::string> ObjText::corner(std::string_view word) const {
  std::string line;
  const std::array<std::size_t, 3> counts = {positions_, texture_coordinates_, normals_};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string_view field = word.substr(0, word.find('/'));
    const bool last = field.size() == word.size();
    if (const bool left_out = k == 1 && field.empty() && !last; !left_out) {
      const std::optional<int> index = number<int>(field);
      if (!index) return std::nullopt;
      const long long count = static_cast<long long>(counts[k]);
      const long long absolute = *index < 0 ? count + 1 + *index : *index;
      if (absolute < 1 || absolute > count) return std::nullopt;
      line.append(std::to_string(absolute));
    }
    if (last) return line;
    line.append("/");
    word.remove_prefix(field.size() + 1);
  }
  return std::nullopt;
}

std::string MtlText::plain(std::string_view keyword, std::string_view rest) {
  if (keyword == "newmtl") has_kd_ = false;
  if (keyword == "newmtl") return joined(keyword, rest);
  if (keyword == "Kd" || keyword == "Ks") return colour(keyword, rest);
  if (keyword == "Pr" || keyword == "Pm") return share(keyword, rest, 1);
  if (keyword == "Ns") return share(keyword, rest, static_cast<float>(largest_exponent));
  if (keyword != "map_Kd") return {};
  const std::string map = joined(keyword, rest);
  return has_kd_ || map.empty() ? map : "Kd 1 1 1\n" + map;
}

std::string MtlText::colour(std::string_view keyword, std::string_view rest) {
  const auto values = three_numbers(rest);
  if (!values || std::ranges::any_of(*values, [](float v) { return v < 0 || v > 1; }))
    return refuse(std::string(keyword).append(" is not three numbers from 0 to 1"),
                  "give the reflectance of red, green and blue");
  has_kd_ = has_kd_ || keyword == "Kd";
  return spelled(keyword, *values);
}

std::string MtlText::share(std::string_view keyword, std::string_view rest, float most) {
  const std::optional<float> value = finite(next_word(rest));
  if (!value || *value < 0 || *value > most) {
    const std::string range = most > 1 ? " from 0 to 100000" : " from 0 to 1";
    return refuse(std::string(keyword).append(" is not a number").append(range), "give a number" + range);
  }
  return spelled(keyword, std::array{keyword == "Pr" ? std::max(*value, least_pr) : *value});
}

}  // namespace lumifield
