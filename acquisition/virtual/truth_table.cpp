#include "acquisition/virtual/truth_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace lumifield::virtual_bench {

namespace {

constexpr std::string_view column_names = "x_mm,y_mm,z_mm,nx,ny,nz";
constexpr std::size_t most_rows = 1'000'000, most_line_bytes = 4096;

Result<TruthPoint> point_of(std::string_view line, const std::string& where) {
  double value[6];
  for (int i = 0; i < 6; ++i) {
    const std::string_view field = line.substr(0, line.find(','));
    const char* end = field.data() + field.size();
    const auto [rest, fault] = std::from_chars(field.data(), end, value[i]);
    if (fault != std::errc() || rest != end || !std::isfinite(value[i]))
      return fail("field " + std::to_string(i + 1) + " is not a number: \"" + std::string(field) + "\"", where);
    line.remove_prefix(std::min(line.size(), field.size() + 1));
  }
  const TruthPoint point{{value[0], value[1], value[2]}, {value[3], value[4], value[5]}};
  if (std::abs(point.n.norm() - 1) > 1e-6) return fail("the normal is not a unit vector", where);
  return point;
}

}  // namespace

Status write_truth(const WorldOptions& options, bool projected, const std::filesystem::path& points,
                   const std::filesystem::path& out, const TruthGrid& grid) {
  if (Status possible = check(options); !possible) return possible;
  std::ifstream in(points);
  std::vector<std::string> lines;
  std::vector<TruthPoint> receivers;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string where = points.string() + ": line " + std::to_string(lines.size() + 1);
    if (lines.size() > most_rows || line.size() > most_line_bytes) return fail("the table is too large", where);
    if (lines.empty() && !(line + ",").starts_with(std::string(column_names) + ","))
      return fail("the columns are not the ones expected", where, "begin with " + std::string(column_names));
    if (!lines.empty()) {
      const auto point = point_of(line, where);
      if (!point) return tl::unexpected(point.error());
      receivers.push_back(*point);
    }
    lines.push_back(std::move(line));
  }
  if (lines.empty()) return fail("cannot be read, or is empty", points.string());

  std::ofstream file(out);
  file << lines[0] << ",E_Y,E_R,E_G,E_B\n";
  const std::vector<TruthValue> values = truth(options, projected, receivers, grid);
  for (std::size_t i = 0; i < values.size(); ++i) {
    char text[128];
    std::snprintf(text, sizeof text, ",%.9g,%.9g,%.9g,%.9g\n", values[i].y, values[i].r, values[i].g, values[i].b);
    file << lines[i + 1] << text;
  }
  file.close();
  if (!file) return fail("cannot be written", out.string(), "check the folder and the space there");
  return {};
}

}  // namespace lumifield::virtual_bench
