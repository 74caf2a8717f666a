#include "app/cli/points_csv.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <limits>
#include <string_view>

#include "luminaire/csv.h"
#include "luminaire/file_io.h"

namespace lumifield {

namespace {

constexpr std::size_t most_points = 10'000'000;
constexpr std::array<std::string_view, 6> column_names{"x_mm", "y_mm", "z_mm", "nx", "ny", "nz"};
constexpr std::size_t any_number_of_columns = std::numeric_limits<std::size_t>::max();  // others are passed over
constexpr const char* columns_remedy = "the first line is to name the columns x_mm,y_mm,z_mm,nx,ny,nz";

/// Position in column_names of each column of the file; past its end: passed over.
Result<std::vector<std::size_t>> read_header(std::string_view line, const std::string& where,
                                             std::vector<std::string>& notes) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
  std::vector<std::size_t> order;
  for (std::string_view field : csv_fields(line, any_number_of_columns)) {
    const auto found = std::find(column_names.begin(), column_names.end(), field);
    const auto column = static_cast<std::size_t>(found - column_names.begin());
    if (found == column_names.end())
      notes.push_back(where + ": column '" + std::string(field) + "' is passed over");
    else if (std::find(order.begin(), order.end(), column) != order.end())
      return fail("column '" + std::string(field) + "' is there twice", where, columns_remedy);
    order.push_back(column);
  }
  for (std::size_t k = 0; k < column_names.size(); ++k)
    if (std::find(order.begin(), order.end(), k) == order.end())
      return fail("column '" + std::string(column_names[k]) + "' is missing", where, columns_remedy);
  return order;
}

Result<Receiver> read_point(std::string_view line, const std::vector<std::size_t>& order, const std::string& where) {
  const std::vector<std::string_view> fields = csv_fields(line, any_number_of_columns);
  if (fields.size() != order.size())
    return fail("has " + std::to_string(fields.size()) + " columns, the first line " + std::to_string(order.size()),
                where, "mend the line");
  std::array<double, 6> value{};
  for (std::size_t k = 0; k < fields.size(); ++k) {
    if (order[k] == column_names.size()) continue;
    double& v = value[order[k]];
    const auto [end, wrong] = std::from_chars(fields[k].data(), fields[k].data() + fields[k].size(), v);
    if (wrong != std::errc() || end != fields[k].data() + fields[k].size() || !std::isfinite(v))
      return fail("'" + std::string(fields[k]) + "' is not a finite number",
                  where + ", column " + std::string(column_names[order[k]]), "mend it");
  }
  Receiver receiver{{value[0], value[1], value[2]}, {value[3], value[4], value[5]}};
  const double length = receiver.n.norm();
  if (std::abs(length - 1) > 1e-3)
    return fail("the normal has length " + std::to_string(length), where, "give it unit length");
  receiver.n /= length;
  return receiver;
}

}  // namespace

Result<std::vector<Receiver>> read_points_csv(const std::filesystem::path& file, std::vector<std::string>& notes) {
  std::ifstream stream(file);
  if (!stream) return fail(std::string("cannot be read: ") + std::strerror(errno), file.string(), "check the path");
  std::string line;
  if (!std::getline(stream, line)) return fail("is empty", file.string(), columns_remedy);
  Result<std::vector<std::size_t>> order = read_header(line, file.string() + ", line 1", notes);
  if (!order) return tl::unexpected(order.error());

  std::vector<Receiver> points;
  for (int number = 2; std::getline(stream, line); ++number) {
    if (trimmed(line).empty()) continue;
    if (points.size() == most_points) return fail("holds more than ten million points", file.string(), "split it");
    Result<Receiver> point = read_point(line, *order, file.string() + ", line " + std::to_string(number));
    if (!point) return tl::unexpected(point.error());
    points.push_back(*point);
  }
  if (stream.bad()) return fail("could not be read to its end", file.string(), "check the disk");
  if (points.empty()) return fail("holds no points", file.string(), "add one line per receiver");
  return points;
}

Status write_points_csv(const std::filesystem::path& file, const std::vector<Receiver>& points,
                        const std::vector<std::string>& channels, const std::vector<double>& irradiance,
                        const std::vector<double>& stated_error) {
  std::string text = "x_mm,y_mm,z_mm,nx,ny,nz";
  for (const std::string& channel : channels) text += ",E_" + channel;
  if (!stated_error.empty())
    for (const std::string& channel : channels) text += ",stated_error_" + channel;
  text += '\n';
  char number[40];
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& [p, n] = points[k];
    for (double v : {p.x(), p.y(), p.z(), n.x(), n.y(), n.z()}) {
      text.append(number, std::to_chars(number, number + sizeof number, v).ptr);
      text += ',';
    }
    for (const std::vector<double>* values : {&irradiance, &stated_error})
      for (std::size_t c = 0; c < channels.size() && !values->empty(); ++c) {
        std::snprintf(number, sizeof number, "%.9g,", (*values)[k * channels.size() + c]);
        text += number;
      }
    text.back() = '\n';
  }
  return write_file_durably(file, text);
}

}  // namespace lumifield
