#include "acquisition/virtual/truth_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace lumifield::virtual_bench {

namespace {

constexpr std::array<std::string_view, 6> kColumns{"x_mm", "y_mm", "z_mm", "nx", "ny", "nz"};
constexpr std::size_t kRowsMax = 1'000'000, kLineBytesMax = 65536;

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields{""};
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else if (c != ' ' && c != '\t')
      fields.back() += c;
  }
  return fields;
}

Result<TruthPoint> point_of(const std::string& line, const std::array<std::size_t, 6>& column, std::size_t width,
                            const std::string& where) {
  const std::vector<std::string> fields = fields_of(line);
  if (fields.size() != width)
    return fail(std::to_string(fields.size()) + " fields where the header has " + std::to_string(width), where);
  std::array<double, 6> value{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::string& field = fields[column[i]];
    const auto [rest, fault] = std::from_chars(field.data(), field.data() + field.size(), value[i]);
    if (fault != std::errc() || rest != field.data() + field.size() || !std::isfinite(value[i]))
      return fail("not a number: \"" + field + "\"", where + ", " + std::string(kColumns[i]));
  }
  const TruthPoint point{{value[0], value[1], value[2]}, {value[3], value[4], value[5]}};
  if (std::abs(point.n.norm() - 1) > 1e-6) return fail("the normal is not a unit vector", where);
  return point;
}

}  // namespace

Status write_truth(const WorldOptions& options, bool projected, const std::filesystem::path& points,
                   const std::filesystem::path& out) {
  std::ifstream in(points);
  std::string header;
  if (!in || !std::getline(in, header)) return fail("cannot be read, or is empty", points.string());
  if (!header.empty() && header.back() == '\r') header.pop_back();

  // Find the columns.
  const std::vector<std::string> names = fields_of(header);
  std::array<std::size_t, 6> column{};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto found = std::ranges::find(names, kColumns[i]);
    if (found == names.end())
      return fail("no column " + std::string(kColumns[i]), points.string() + ": line 1",
                  "the header must name x_mm,y_mm,z_mm,nx,ny,nz");
    column[i] = std::size_t(found - names.begin());
  }

  // Read the points, and keep the lines as they are.
  std::vector<std::string> lines;
  std::vector<TruthPoint> where;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty()) continue;
    const std::string place = points.string() + ": line " + std::to_string(lines.size() + 2);
    if (lines.size() >= kRowsMax || line.size() > kLineBytesMax) return fail("the table is too large", place);
    const auto point = point_of(line, column, names.size(), place);
    if (!point) return tl::unexpected(point.error());
    lines.push_back(line);
    where.push_back(*point);
  }

  std::ofstream file(out);
  file << header << ",E_Y,E_R,E_G,E_B\n";
  const std::vector<TruthValue> values = truth(options, projected, where);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    char text[128];
    const TruthValue& e = values[i];
    std::snprintf(text, sizeof text, ",%.9g,%.9g,%.9g,%.9g\n", e.y, e.r, e.g, e.b);
    file << lines[i] << text;
  }
  file.close();
  if (!file) return fail("cannot be written", out.string(), "check the folder and the space there");
  return {};
}

}  // namespace lumifield::virtual_bench
