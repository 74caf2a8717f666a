#pragma once

#include <string>
#include <string_view>

#include "luminaire/half_cells.h"

namespace lumifield {

/// The files of half_cells.h as bytes, internal to this room.

/// A file's largest size: 64 exposures of 32 Mpx and their header.
inline constexpr std::uintmax_t most_half_cell_bytes = (std::uintmax_t{64} << 26) + (std::uintmax_t{1} << 20);

/// `dark`: the name of its dark set's file.
std::string encode_half_cell(const HalfCell& half, const std::string& dark);
std::string encode_dark_set(const DarkSet& dark);

struct HalfCellFile {
  HalfCell half;     ///< without its dark set,
  std::string dark;  ///< which is in this file
};
/// Refuse, naming `where`: another checksum, a header that is none, and DN that are not as many as it says.
Result<HalfCellFile> decode_half_cell(std::string_view bytes, std::string_view where);
Result<DarkSet> decode_dark_set(std::string_view bytes, std::string_view where);

}  // namespace lumifield
