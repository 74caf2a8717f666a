#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumifield::virtual_bench {

/// Bytes of a row of pixels in a V4L2 format of v4l2_sensor_formats.
std::size_t packed_row_bytes(std::uint32_t fourcc, int width_px);

/// Right-aligned DN of `bits` as that format has them; where it has fewer, the lowest are left out.
void pack(std::span<const std::uint16_t> dn, int bits, std::uint32_t fourcc, int width_px, std::span<std::uint8_t> out);

}  // namespace lumifield::virtual_bench
