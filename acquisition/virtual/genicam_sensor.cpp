#include "acquisition/virtual/genicam_sensor.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <map>
#include <thread>

#include "acquisition/virtual/genicam_description.h"
#include "acquisition/virtual/genicam_registers.h"

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double shortest_exposure_us = 10, longest_exposure_us = 1e7;
constexpr double automatic_exposure_us = 20000, automatic_gain_db = 6;

double at_start(const GenicamLeftover& setting, const GenicamOptions& options) {
  return options.automatics ? setting.left : setting.harmless;
}

}  // namespace

Status check(const GenicamOptions& options) {
  if (!genicam_pixel_format(options.pixel_format))
    return fail("pixel format unknown", options.pixel_format, "give one such as Mono12 or BayerRG12p");
  if (options.serial.empty() || options.serial.size() >= registers::serial_bytes)
    return fail("the serial number must have 1 to 15 characters", options.serial);
  return {};
}

std::string genicam_description(const GenicamOptions& options) {
  std::map<std::string, double> stuck;
  for (const GenicamLeftover& each : leftovers)
    if (std::ranges::find(options.stuck, each.feature) != options.stuck.end())
      stuck[each.feature] = at_start(each, options);
  return genicam_description(options.pixel_format, stuck);
}

std::uint32_t RegisterMemory::get(std::uint32_t address) const {
  std::uint8_t bytes[4];
  read(address, bytes);
  return std::uint32_t(bytes[0]) << 24 | std::uint32_t(bytes[1]) << 16 | std::uint32_t(bytes[2]) << 8 | bytes[3];
}
void RegisterMemory::set(std::uint32_t address, std::uint32_t value) {
  const std::uint8_t bytes[] = {std::uint8_t(value >> 24), std::uint8_t(value >> 16), std::uint8_t(value >> 8),
                                std::uint8_t(value)};
  write(address, bytes);
}
double RegisterMemory::get_double(std::uint32_t address) const {
  std::uint8_t bytes[8];
  read(address, bytes);
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return std::bit_cast<double>(value);
}
void RegisterMemory::set_double(std::uint32_t address, double value) {
  std::uint8_t bytes[8];
  for (int i = 0; i < 8; ++i) bytes[i] = std::uint8_t(std::bit_cast<std::uint64_t>(value) >> (56 - 8 * i));
  write(address, bytes);
}
void RegisterMemory::set_text(std::uint32_t address, std::uint32_t size, const std::string& text) {
  std::vector<std::uint8_t> field(size, 0);
  std::copy_n(text.begin(), std::min<std::size_t>(text.size(), size - 1), field.begin());
  write(address, field);
}

GenicamSensor::GenicamSensor(const GenicamOptions& options, Sight sight, RegisterMemory& memory)
    : options_(options),
      format_(genicam_pixel_format(options.pixel_format).value()),
      sight_(std::move(sight)),
      memory_(memory) {}

void GenicamSensor::power_up() {
  memory_.set_text(registers::vendor, registers::name_bytes, "Lumifield");
  memory_.set_text(registers::model, registers::name_bytes, "Virtual");
  memory_.set_text(registers::serial, registers::serial_bytes, options_.serial);
  const auto width = std::uint32_t(options_.width_px), height = std::uint32_t(options_.height_px);
  const std::pair<std::uint32_t, std::uint32_t> values[] = {{registers::sensor_width, width},
                                                            {registers::sensor_height, height},
                                                            {registers::width, width},
                                                            {registers::height, height},
                                                            {registers::pixel_format, format_.code},
                                                            {registers::binning_horizontal, 1},
                                                            {registers::binning_vertical, 1},
                                                            {registers::trigger_mode, 0},
                                                            {registers::trigger_source, 1}};
  for (const auto& [address, value] : values) memory_.set(address, value);
  memory_.set_double(registers::exposure_time, 10000);
  memory_.set_double(registers::gain, 0);
  for (const GenicamLeftover& each : leftovers) {
    const double value = at_start(each, options_);
    each.is_float ? memory_.set_double(each.address, value) : memory_.set(each.address, std::uint32_t(value));
  }
}

void GenicamSensor::run(FrameLink& link, std::stop_token stop) {
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(std::chrono::microseconds(500));
    if (memory_.get(registers::trigger_mode) != 0 && memory_.get(registers::trigger_software) == 0) continue;
    memory_.set(registers::trigger_software, 0);
    if (!link.acquiring() || frozen_) continue;
    expose(link, stop);
    if (options_.repeated_every > 0 && ++triggers_ % options_.repeated_every == 0) expose(link, stop);
  }
}

void GenicamSensor::expose(FrameLink& link, std::stop_token stop) {
  const bool is_told = memory_.get(registers::exposure_auto) == 0 && memory_.get(registers::exposure_mode) == timed;
  const double exposure_us = is_told ? memory_.get_double(registers::exposure_time) : automatic_exposure_us;
  if (!(exposure_us >= shortest_exposure_us && exposure_us <= longest_exposure_us)) return;
  const auto end = Clock::now() +
                   std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::micro>(exposure_us));
  const Exposure exposure{
      .stage_mm = sight_.stage_mm(),
      .exposure_s = exposure_us * 1e-6,
      .gain_db = memory_.get(registers::gain_auto) != 0 ? automatic_gain_db : memory_.get_double(registers::gain)};
  const std::uint64_t stream = link.stream();
  sight_.wait_ready(exposure.stage_mm);
  if (link.stream() != stream) return;
  while (Clock::now() < end) {
    if (stop.stop_requested() || !link.acquiring()) return;
    std::this_thread::sleep_until(std::min(end, Clock::now() + std::chrono::milliseconds(10)));
  }
  memory_.set(registers::trigger_software, 0);
  link.send(exposure, stop);
}

GenicamProcessing GenicamSensor::processing() const {
  const auto on = [this](std::uint32_t address) { return memory_.get(address) != 0; };
  return {.mirrored_x = on(registers::reverse_x),
          .mirrored_y = on(registers::reverse_y),
          .gain_db = on(registers::digital_gain_auto) ? automatic_gain_db : memory_.get_double(registers::digital_gain),
          .red = memory_.get_double(registers::red_ratio),
          .blue = memory_.get_double(registers::blue_ratio),
          .gamma = on(registers::gamma_enable) ? memory_.get_double(registers::gamma) : 1,
          .table = on(registers::lut_enable),
          .white_balance = on(registers::balance_white_auto),
          .black_level = on(registers::black_level_auto)};
}

// The region, binned.
std::vector<std::uint16_t> GenicamSensor::photosites(Exposure exposure, int width, int height) const {
  const int columns = int(memory_.get(registers::binning_horizontal));
  const int rows = int(memory_.get(registers::binning_vertical));
  exposure.width_px = width * columns, exposure.height_px = height * rows;
  exposure.offset_x_px = int(memory_.get(registers::offset_x)) * columns;
  exposure.offset_y_px = int(memory_.get(registers::offset_y)) * rows;
  std::vector<std::uint16_t> dn(std::size_t(exposure.width_px) * std::size_t(exposure.height_px));
  sight_.expose(exposure, dn);
  if (columns * rows == 1) return dn;
  std::vector<std::uint16_t> binned(std::size_t(width) * std::size_t(height));
  bin(dn, columns, rows, width, binned);
  return binned;
}

void GenicamSensor::read_out(Exposure exposure, int width, int height, std::span<std::uint8_t> bytes) {
  std::vector<std::uint16_t> dn = photosites(exposure, width, height);
  const std::uint64_t frame = ++frames_;
  if (const GenicamProcessing now = processing(); now.changes()) now.apply(dn, width, format_.bits, frame);
  pack(dn, width, format_, bytes.first(format_.bytes_of(dn.size())));
}

}  // namespace lumifield::virtual_bench
