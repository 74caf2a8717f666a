#pragma once

#include <cstdint>

namespace lumifield::virtual_bench {

/// Registers of resources/virtual-camera.xml. Those below 0x400 are where Aravis' simulator has them. What a selector
/// selects lies behind each other.
namespace registers {
inline constexpr std::uint32_t width = 0x100, height = 0x104, sensor_height = 0x118, sensor_width = 0x11c;
inline constexpr std::uint32_t acquisition = 0x124, pixel_format = 0x128, offset_x = 0x130, offset_y = 0x134;
inline constexpr std::uint32_t vendor = 0x48, model = 0x68, serial = 0xd8, name_bytes = 32, serial_bytes = 16;
inline constexpr std::uint32_t trigger_mode = 0x2000, trigger_source = 0x2004, trigger_software = 0x2008;
inline constexpr std::uint32_t exposure_time = 0x2010, gain = 0x2018, digital_gain = 0x2020;
inline constexpr std::uint32_t binning_horizontal = 0x2030, binning_vertical = 0x2034;
inline constexpr std::uint32_t exposure_auto = 0x2040, black_level_auto = 0x2048, balance_white_auto = 0x204c;
inline constexpr std::uint32_t gamma_enable = 0x2050, gamma = 0x2058, lut_enable = 0x2060;
inline constexpr std::uint32_t gain_selector = 0x2064, balance_ratio_selector = 0x2068, exposure_mode = 0x206c;
inline constexpr std::uint32_t gain_auto = 0x2070, digital_gain_auto = 0x2074, reverse_x = 0x2078, reverse_y = 0x207c;
inline constexpr std::uint32_t red_ratio = 0x2080, blue_ratio = 0x2088;
}  // namespace registers

/// A setting that spoils what is measured: its value when it does not, and as factories and other programs leave it.
struct GenicamLeftover {
  const char* feature;
  std::uint32_t address;
  double harmless, left;
  bool is_float = false;
};
inline constexpr std::uint32_t timed = 1, trigger_width = 2;
inline constexpr GenicamLeftover leftovers[] = {{"ExposureMode", registers::exposure_mode, timed, trigger_width},
                                                {"ExposureAuto", registers::exposure_auto, 0, 2},
                                                {"GainSelector", registers::gain_selector, 0, 1},
                                                {"GainAuto", registers::gain_auto, 0, 2},
                                                {"GainAuto", registers::digital_gain_auto, 0, 2},
                                                {"Gain", registers::digital_gain, 0, 3, true},
                                                {"BlackLevelAuto", registers::black_level_auto, 0, 2},
                                                {"BalanceWhiteAuto", registers::balance_white_auto, 0, 2},
                                                {"BalanceRatio", registers::red_ratio, 1, 1.5, true},
                                                {"BalanceRatio", registers::blue_ratio, 1, 1.5, true},
                                                {"GammaEnable", registers::gamma_enable, 0, 1},
                                                {"Gamma", registers::gamma, 1, 0.45, true},
                                                {"LUTEnable", registers::lut_enable, 0, 1},
                                                {"ReverseX", registers::reverse_x, 0, 1},
                                                {"ReverseY", registers::reverse_y, 0, 1}};

}  // namespace lumifield::virtual_bench
