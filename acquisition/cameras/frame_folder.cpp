#include "acquisition/cameras/frame_folder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "luminaire/csv.h"
#include "luminaire/file_io.h"
#include "luminaire/json_geometry.h"

namespace lumifield {
namespace {

constexpr std::string_view patterns[] = {"mono", "rggb", "grbg", "gbrg", "bggr"};
constexpr std::string_view columns[] = {"file",    "exposure_s", "asked_s",   "gain_db",
                                        "pattern", "stage_x_mm", "stage_y_mm"};
enum Column : std::size_t { file, exposure, asked, gain, pattern, stage_x, stage_y };
constexpr std::size_t column_count = std::size(columns);
constexpr const char* columns_remedy =
    "name the columns in the first line: file,exposure_s and, as there are, asked_s,gain_db,pattern,stage_x_mm,"
    "stage_y_mm";
constexpr std::size_t most_frames = 1'000'000;
constexpr double longest_exposure_s = 3600, largest_gain_db = 200, farthest_mm = 1e6;
constexpr std::size_t header_bytes_most = 1024;

/// Takes the next line off the text.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// Where each column of a line is; absent ones past its end.
using Order = std::array<std::size_t, column_count>;
constexpr std::size_t absent = static_cast<std::size_t>(-1);

Result<Order> parse_header(std::string_view line, const std::string& where) {
  Order order;
  order.fill(absent);
  const std::vector<std::string_view> fields = csv_fields(line, column_count);
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const auto found = std::ranges::find(columns, fields[k]);
    if (found == std::end(columns))
      return fail("column \"" + std::string(fields[k]) + "\" is not known", where, columns_remedy);
    std::size_t& at = order[static_cast<std::size_t>(found - std::begin(columns))];
    if (at != absent) return fail("column \"" + std::string(fields[k]) + "\" is there twice", where, columns_remedy);
    at = k;
  }
  for (const Column needed : {file, exposure})
    if (order[needed] == absent)
      return fail("column \"" + std::string(columns[needed]) + "\" is missing", where, columns_remedy);
  if ((order[stage_x] == absent) != (order[stage_y] == absent))
    return fail("has one of stage_x_mm and stage_y_mm", where, "give both, or neither");
  return order;
}

/// One line; remembers the first thing found wrong.
struct Line {
  const std::vector<std::string_view>& fields;
  const Order& order;
  const std::string& where;
  std::optional<Error> error = {};

  bool has(Column column) const { return order[column] != absent; }
  std::string_view text(Column column) const { return fields[order[column]]; }
  void refuse(Column column, const std::string& what, std::string remedy) {
    if (!error)
      error = Error{"\"" + std::string(text(column)) + "\" " + what, where + ", " + std::string(columns[column]),
                    std::move(remedy)};
  }
  double number(Column column, double low, double high) {
    const std::string_view digits = text(column);
    double value = 0;
    const auto [end, wrong] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (wrong != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
      refuse(column, "is no number", "give a finite number");
    else if (!(value >= low && value <= high))
      refuse(column, "is out of range", "correct it");
    return value;
  }
};

Result<ListedFrame> parse_line(std::string_view text, const Order& order, const std::string& where) {
  const std::vector<std::string_view> fields = csv_fields(text, column_count);
  const auto named = static_cast<std::size_t>(std::ranges::count_if(order, [](std::size_t k) { return k != absent; }));
  if (fields.size() != named)
    return fail("has " + std::to_string(fields.size()) + " columns, the first line " + std::to_string(named), where,
                "mend the line");
  Line line{fields, order, where};
  ListedFrame frame;
  frame.file = line.text(file);
  if (Status inside = check_relative_path(frame.file, where + ", file"); !inside) return tl::unexpected(inside.error());
  constexpr double shortest_s = 1e-9;
  frame.exposure_s = line.number(exposure, shortest_s, longest_exposure_s);
  frame.asked_s = line.has(asked) ? line.number(asked, shortest_s, longest_exposure_s) : frame.exposure_s;
  if (line.has(gain)) frame.gain_db = line.number(gain, -largest_gain_db, largest_gain_db);
  if (line.has(pattern)) {
    const auto found = std::ranges::find(patterns, line.text(pattern));
    if (found == std::end(patterns)) line.refuse(pattern, "is no pattern", "give mono, rggb, grbg, gbrg or bggr");
    frame.pattern = static_cast<SensorPattern>(found - std::begin(patterns));
  }
  if (line.has(stage_x)) {
    const double x = line.number(stage_x, -farthest_mm, farthest_mm);
    frame.stage_mm = Vec2(x, line.number(stage_y, -farthest_mm, farthest_mm));
  }
  if (line.error) return tl::unexpected(*line.error);
  return frame;
}

std::string shortest(double value) {
  std::array<char, 40> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace

Result<std::vector<ListedFrame>> parse_frame_list(std::string_view csv, std::string_view where) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (csv.starts_with(byte_order_mark)) csv.remove_prefix(byte_order_mark.size());
  const auto at = [&](std::size_t number) { return std::string(where) + ", line " + std::to_string(number); };
  const Result<Order> order = parse_header(next_line(csv), at(1));
  if (!order) return tl::unexpected(order.error());
  std::vector<ListedFrame> frames;
  for (std::size_t number = 2; !csv.empty(); ++number) {
    const std::string_view line = next_line(csv);
    if (trimmed(line).empty()) continue;
    if (frames.size() == most_frames) return fail("lists more than a million frames", std::string(where), "split it");
    Result<ListedFrame> frame = parse_line(line, *order, at(number));
    if (!frame) return tl::unexpected(frame.error());
    frames.push_back(std::move(*frame));
  }
  if (frames.empty()) return fail("lists no frames", std::string(where), "give a line for each frame");
  return frames;
}

Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& folder) {
  const std::filesystem::path list = folder / frame_list_name;
  const Result<std::string> csv = read_file(list, most_frame_list_bytes);
  if (!csv)
    return fail("holds no frames that can be played back: " + csv.error().what, list.string(),
                "name a folder that `lumifield scan --record` made, or one with a list of frames");
  return parse_frame_list(*csv, list.string());
}

std::string frame_list_header() {
  std::string line;
  for (const std::string_view column : columns) line.append(line.empty() ? "" : ",").append(column);
  return line + "\n";
}

std::string frame_list_line(const ListedFrame& frame) {
  const Vec2 at = frame.stage_mm.value_or(Vec2(0, 0));
  std::string line = frame.file;
  for (const double value : {frame.exposure_s, frame.asked_s, frame.gain_db}) line += "," + shortest(value);
  line.append(",").append(patterns[static_cast<std::size_t>(frame.pattern)]);
  for (const double value : {at.x(), at.y()}) line += "," + shortest(value);
  return line + "\n";
}

std::uintmax_t PgmHeader::file_bytes() const {
  return bytes +
         std::uintmax_t{bits > 8 ? 2u : 1u} * static_cast<unsigned>(width_px) * static_cast<unsigned>(height_px);
}

Result<PgmHeader> parse_pgm_header(std::string_view begin, std::string_view where) {
  const auto refuse = [&](std::string what) {
    return fail(std::move(what), std::string(where), "give a binary PGM (P5) with one value per photosite");
  };
  if (!begin.starts_with("P5")) return refuse("is no binary PGM");
  begin = begin.substr(0, header_bytes_most);
  std::size_t at = 2;
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  const auto number = [&]() -> int {
    while (at < begin.size() && (is_space(begin[at]) || begin[at] == '#'))
      at = begin[at] == '#' ? std::min(begin.find('\n', at), begin.size()) : at + 1;
    int value = 0;
    const auto [end, wrong] = std::from_chars(begin.data() + at, begin.data() + begin.size(), value);
    at = static_cast<std::size_t>(end - begin.data());
    return wrong == std::errc() ? value : -1;
  };
  PgmHeader header;
  header.width_px = number();
  header.height_px = number();
  const int largest = number();
  if (at >= begin.size() || !is_space(begin[at])) return refuse("has a header that ends early or is none");
  for (const int size : {header.width_px, header.height_px})
    if (size < 1 || size > most_pixels_per_axis) return refuse("is of a size that no camera has");
  if (largest < 1 || largest > 65535) return refuse("has a largest value that is not 1 to 65535");
  header.bits = std::bit_width(static_cast<unsigned>(largest));
  header.bytes = at + 1;
  return header;
}

Result<RawImage> decode_pgm(std::string_view bytes, std::string_view where) {
  const Result<PgmHeader> header = parse_pgm_header(bytes, where);
  if (!header) return tl::unexpected(header.error());
  if (bytes.size() != header->file_bytes())
    return fail(
        "holds " + std::to_string(bytes.size()) + " bytes, its header says " + std::to_string(header->file_bytes()),
        std::string(where), "it was cut off or is damaged: record it again");
  RawImage image;
  image.width_px = header->width_px, image.height_px = header->height_px;
  image.bits = header->bits;
  image.dn.resize(static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px));
  const auto* pixels = reinterpret_cast<const unsigned char*>(bytes.data()) + header->bytes;
  const bool wide = image.bits > 8;
  for (std::size_t i = 0; i < image.dn.size(); ++i)
    image.dn[i] = static_cast<std::uint16_t>(wide ? pixels[2 * i] << 8 | pixels[2 * i + 1] : pixels[i]);
  if (*std::ranges::max_element(image.dn) >> image.bits != 0)
    return fail("holds a value of more than " + std::to_string(image.bits) + " bits, which its header allows",
                std::string(where), "it is damaged, or its header is wrong");
  return image;
}

std::string encode_pgm(const RawImage& image) {
  std::string bytes = "P5\n" + std::to_string(image.width_px) + " " + std::to_string(image.height_px) + "\n" +
                      std::to_string((1 << image.bits) - 1) + "\n";
  const bool wide = image.bits > 8;
  std::size_t at = bytes.size();
  bytes.resize(at + image.dn.size() * (wide ? 2 : 1));
  for (const std::uint16_t dn : image.dn) {
    if (wide) bytes[at++] = static_cast<char>(dn >> 8);
    bytes[at++] = static_cast<char>(dn & 0xff);
  }
  return bytes;
}

}  // namespace lumifield
