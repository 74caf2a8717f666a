#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// A folder of frames: `frames.csv`, and one picture for each of its lines, in the order in which they were taken.
///
///     file,exposure_s,asked_s,gain_db,pattern,stage_x_mm,stage_y_mm
///     000001.pgm,0.00799987,0.008,0,mono,-22.5,90
///
/// The first line names the columns, in any order; all but the first two may be missing. `exposure_s` is what the
/// camera reports, `asked_s` what it was asked for (absent: the same), the pattern that of SensorPattern (absent:
/// mono), the place the stage's reading. Pictures are binary PGM (P5): DN as they are, the bits of the frame are those
/// of its largest value, 4095 for 12; above 255 two bytes, the higher first. All functions are reentrant.
/// Source: Netpbm, PGM format specification.

struct ListedFrame {
  std::string file;  ///< below the folder
  double exposure_s = 0, asked_s = 0;
  double gain_db = 0;
  SensorPattern pattern = SensorPattern::mono;
  std::optional<Vec2> stage_mm;
};

inline constexpr const char* frame_list_name = "frames.csv";
inline constexpr std::uintmax_t most_frame_list_bytes = std::uintmax_t{256} << 20;
inline constexpr std::uintmax_t most_picture_bytes = std::uintmax_t{1} << 30;

/// Frames have all a place or none. `where` is the list's name. Errors: the line and column that cannot be read.
Result<std::vector<ListedFrame>> parse_frame_list(std::string_view csv, std::string_view where);
Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& folder);
/// The first line of a list with places, and the line of a frame.
std::string frame_list_header();
std::string frame_list_line(const ListedFrame& frame);

struct PgmHeader {
  int width_px = 0, height_px = 0, bits = 0;
  std::size_t bytes = 0;  ///< of the header itself
  std::uintmax_t file_bytes() const;
};
/// `begin` may be the file's first bytes alone.
Result<PgmHeader> parse_pgm_header(std::string_view begin, std::string_view where);

/// Size, bits and DN. Errors: another format, fewer or more pixels than the header says, DN above its largest value.
Result<RawImage> decode_pgm(std::string_view bytes, std::string_view where);
std::string encode_pgm(const RawImage& image);

}  // namespace lumifield
