#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace lumifield::virtual_bench {

/// resources/virtual-camera.xml for a sensor that delivers `pixel_format`, one of genicam_pixel_format. The features
/// `stuck` take what they are set to and keep their value.
std::string genicam_description(const std::string& pixel_format, const std::map<std::string, double>& stuck);

/// The same with all registers so much further.
std::string move_registers(std::string xml, std::uint32_t by);

}  // namespace lumifield::virtual_bench
