#include "acquisition/virtual/usb3_memory.h"

#include <algorithm>

#include "acquisition/virtual/genicam_description.h"
#include "acquisition/virtual/genicam_registers.h"

namespace lumifield::virtual_bench {
namespace {

// Where the camera has what the standard lets it choose.
constexpr std::uint32_t sbrm = 0x1000, sirm = 0x2000, manifest = 0x3000, bootstrap_bytes = 0x4000;
constexpr std::uint32_t registers_begin = 0x10000, registers_bytes = 0x3000, file_begin = 0x100000;

namespace abrm {
constexpr std::uint32_t gencp_version = 0, manufacturer = 0x4, model = 0x44, device_version = 0xc4, serial = 0x144;
constexpr std::uint32_t text_bytes = 64, capability = 0x1c4, response_time_ms = 0x1cc, manifest_address = 0x1d0;
constexpr std::uint32_t sbrm_address = 0x1d8;
}  // namespace abrm
constexpr std::uint32_t u3v_version = sbrm, most_command_bytes = sbrm + 0x14, most_answer_bytes = sbrm + 0x18;
constexpr std::uint32_t stream_channels = sbrm + 0x1c, sirm_address = sbrm + 0x20, sirm_length = sbrm + 0x28;
constexpr std::uint32_t speed = sbrm + 0x40, super_speed = 8;
constexpr std::uint32_t stream_info = sirm, stream_control = sirm + 0x4, payload_required = sirm + 0x8;
constexpr std::uint32_t leader_required = sirm + 0x10, trailer_required = sirm + 0x14, sizes_begin = sirm + 0x18;
constexpr std::uint32_t payload_size = sirm + 0x1c, payload_count = sirm + 0x20, transfer1 = sirm + 0x24;
constexpr std::uint32_t transfer2 = sirm + 0x28, sirm_end = sirm + 0x30;

constexpr std::uint32_t version_1_0 = 0x00010000, alignment_bits = 10;
constexpr std::size_t header_bytes = 12, address_bytes = 8, most_packet_bytes = 1024;

constexpr std::uint32_t command_prefix = 0x43563355;
constexpr std::uint16_t wants_answer = 0x4000, read_memory = 0x800, write_memory = 0x802;
constexpr std::uint16_t success = 0, not_implemented = 0x8001, invalid_parameter = 0x8002, invalid_address = 0x8003;
constexpr std::uint16_t write_protected = 0x8004;

std::uint64_t take_little(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
  return value;
}
void put_little(std::span<std::uint8_t> bytes, std::uint64_t value) {
  for (std::uint8_t& byte : bytes) byte = std::uint8_t(value), value >>= 8;
}

}  // namespace

Usb3Memory::Usb3Memory(const GenicamOptions& options)
    : serial_(options.serial),
      format_(genicam_pixel_format(options.pixel_format).value()),
      description_(move_registers(genicam_description(options), registers_begin)) {
  power_up();
}

void Usb3Memory::power_up() {
  const std::lock_guard lock(mutex_);
  bootstrap_.assign(bootstrap_bytes, 0), registers_.assign(registers_bytes, 0);
  file_.assign(description_.begin(), description_.end());
  const auto set_text = [&](std::uint32_t address, const std::string& text) {
    std::ranges::copy(text, bootstrap_.begin() + address);
  };
  set_text(abrm::manufacturer, "Lumifield"), set_text(abrm::model, "Virtual"), set_text(abrm::device_version, "1");
  set_text(abrm::serial, serial_);
  set_little(abrm::gencp_version, version_1_0, 4), set_little(abrm::response_time_ms, 100, 4);
  set_little(abrm::manifest_address, manifest, 8), set_little(abrm::sbrm_address, sbrm, 8);
  set_little(u3v_version, version_1_0, 4), set_little(stream_channels, 1, 4), set_little(speed, super_speed, 4);
  set_little(most_command_bytes, most_packet_bytes, 4), set_little(most_answer_bytes, most_packet_bytes, 4);
  set_little(sirm_address, sirm, 8), set_little(sirm_length, sirm_end - sirm, 4);
  set_little(stream_info, alignment_bits << 24, 4);
  set_little(leader_required, most_packet_bytes, 4), set_little(trailer_required, most_packet_bytes, 4);
  // One entry: a description of schema 1.1, not compressed.
  set_little(manifest, 1, 8);
  set_little(manifest + 0x8, 0x01000000, 4), set_little(manifest + 0xc, 0x01010000, 4);
  set_little(manifest + 0x10, file_begin, 8), set_little(manifest + 0x18, description_.size(), 8);
}

void Usb3Memory::set_little(std::uint32_t address, std::uint64_t value, int bytes) {
  put_little(std::span(bootstrap_).subspan(address, std::size_t(bytes)), value);
}
std::uint64_t Usb3Memory::little(std::uint32_t address, int bytes) const {
  return take_little(std::span(bootstrap_).subspan(address, std::size_t(bytes)));
}

void Usb3Memory::read(std::uint32_t address, std::span<std::uint8_t> bytes) const {
  const std::lock_guard lock(mutex_);
  std::ranges::copy(std::span(registers_).subspan(address, bytes.size()), bytes.begin());
}
void Usb3Memory::write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  std::ranges::copy(bytes, registers_.begin() + address);
}

/// What the host means by an address; empty: nothing is there.
std::span<std::uint8_t> Usb3Memory::find(std::uint64_t address, std::size_t count) {
  for (const auto& [begin, bytes] : {std::pair<std::uint64_t, std::vector<std::uint8_t>*>{0, &bootstrap_},
                                     {registers_begin, &registers_},
                                     {file_begin, &file_}})
    if (address >= begin && address - begin < bytes->size() && count <= bytes->size() - (address - begin))
      return std::span(*bytes).subspan(std::size_t(address - begin), count);
  return {};
}

std::uint16_t Usb3Memory::write_host(std::uint64_t address, std::span<const std::uint8_t> bytes) {
  const std::span<std::uint8_t> there = find(address, bytes.size());
  if (there.empty()) return invalid_address;
  const bool is_stream = address == stream_control || (address >= sizes_begin && address < sirm_end);
  if (!is_stream && (address < registers_begin || address >= file_begin)) return write_protected;
  const bool was_enabled = little(stream_control, 4) != 0;
  std::ranges::copy(bytes, there.begin());
  if (!was_enabled && little(stream_control, 4) != 0) ++streams_;
  return success;
}

bool Usb3Memory::writes(std::uint32_t address, std::span<const std::uint8_t> command) {
  return command.size() > header_bytes + address_bytes && take_little(command.subspan(6, 2)) == write_memory &&
         take_little(command.subspan(header_bytes, address_bytes)) == registers_begin + address;
}

std::vector<std::uint8_t> Usb3Memory::answer(std::span<const std::uint8_t> command) {
  const auto field = [&](std::size_t at, std::size_t count) { return take_little(command.subspan(at, count)); };
  if (command.size() < header_bytes || field(0, 4) != command_prefix || field(4, 2) != wants_answer) return {};
  const std::size_t frame_bytes =
      format_.bytes_of(std::size_t(get(registers::width)) * std::size_t(get(registers::height)));
  const std::lock_guard lock(mutex_);
  std::uint16_t status = not_implemented;
  std::vector<std::uint8_t> data;
  const std::uint64_t code = field(6, 2);
  const std::span<const std::uint8_t> content = command.subspan(header_bytes);
  if ((code == read_memory && content.size() != address_bytes + 4) ||
      (code == write_memory && content.size() <= address_bytes)) {
    status = invalid_parameter;
  } else if (code == read_memory) {
    set_little(payload_required, frame_bytes, 8);
    const std::span<std::uint8_t> there = find(field(header_bytes, 8), field(header_bytes + 10, 2));
    status = there.empty() ? invalid_address : success;
    data.assign(there.begin(), there.end());
  } else if (code == write_memory) {
    status = write_host(field(header_bytes, 8), content.subspan(address_bytes));
    data.assign(status == success ? 4 : 0, 0);
    if (status == success) put_little(std::span(data).subspan(2), content.size() - address_bytes);
  }
  std::vector<std::uint8_t> answer(header_bytes + data.size());
  const std::span<std::uint8_t> to(answer);
  put_little(to.first(4), command_prefix), put_little(to.subspan(4, 2), status);
  put_little(to.subspan(6, 2), code + 1), put_little(to.subspan(8, 2), data.size());
  put_little(to.subspan(10, 2), field(10, 2));
  std::ranges::copy(data, answer.begin() + header_bytes);
  return answer;
}

std::uint64_t Usb3Memory::streams() const {
  const std::lock_guard lock(mutex_);
  return streams_;
}
bool Usb3Memory::stream_enabled() const {
  const std::lock_guard lock(mutex_);
  return little(stream_control, 4) != 0;
}
std::vector<std::size_t> Usb3Memory::transfers(std::size_t frame_bytes) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> sizes;
  const auto cut = [&](std::size_t most) {
    if (const std::size_t bytes = std::min(most, frame_bytes); bytes > 0) sizes.push_back(bytes), frame_bytes -= bytes;
  };
  for (std::uint64_t i = little(payload_count, 4); i > 0 && frame_bytes > 0; --i) cut(little(payload_size, 4));
  cut(little(transfer1, 4)), cut(little(transfer2, 4));
  return sizes;
}

}  // namespace lumifield::virtual_bench
