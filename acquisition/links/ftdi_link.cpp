#include "acquisition/links/ftdi_link.h"

#include <cstdio>
#include <ftdi.h>
#include <libusb.h>
#include <thread>

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr unsigned char latency_ms = 4;  // the chip keeps what does not fill a packet for so long
constexpr milliseconds dwell(50);        // before and after the purge, as Thorlabs asks
constexpr int transfer_ms = 1000;
constexpr int usb_open_failed = -4, usb_claim_failed = -5;  // of ftdi_usb_open_dev

struct FreeContext {
  void operator()(ftdi_context* chip) const { ftdi_free(chip); }
};
using Context = std::unique_ptr<ftdi_context, FreeContext>;

struct FreeList {
  void operator()(ftdi_device_list* list) const { ftdi_list_free2(list); }
};
using List = std::unique_ptr<ftdi_device_list, FreeList>;

List list_devices(ftdi_context* chip, UsbId id) {
  ftdi_device_list* list = nullptr;
  return List(ftdi_usb_find_all(chip, &list, id.vendor, id.product) > 0 ? list : nullptr);
}

constexpr const char* rules_remedy =
    "install the rules for devices on USB with `scripts/setup --udev`, add yourself to the group plugdev, and plug it "
    "in "
    "again";

Error open_error(int code, const std::string& where) {
  switch (code) {
    case LIBUSB_ERROR_ACCESS:
      return {"no permission to open it", where, rules_remedy};
    case LIBUSB_ERROR_BUSY:
      return {"in use by another program", where, "close the other program"};
    case LIBUSB_ERROR_NO_DEVICE:
      return {"unplugged", where, "check its cable and power, then plug it in again"};
    default:
      return {libusb_strerror(code), where, "plug it in again"};
  }
}

/// Its names, which only an open device tells.
FtdiDevice describe(libusb_device* device) {
  libusb_device_handle* handle = nullptr;
  char place[32];
  std::snprintf(place, sizeof place, "USB %03d/%03d", libusb_get_bus_number(device), libusb_get_device_address(device));
  if (const int code = libusb_open(device, &handle); code != 0) return {{}, {}, open_error(code, place)};
  const auto text = [handle](std::uint8_t index) {
    unsigned char bytes[128];
    const int count = libusb_get_string_descriptor_ascii(handle, index, bytes, sizeof bytes);
    return std::string(reinterpret_cast<char*>(bytes), count > 0 ? static_cast<std::size_t>(count) : 0);
  };
  libusb_device_descriptor told{};
  libusb_get_device_descriptor(device, &told);
  FtdiDevice known{text(told.iSerialNumber), text(told.iProduct), {}};
  libusb_close(handle);
  if (known.serial.empty()) known.closed = Error{"does not tell its serial number", place, "plug it in again"};
  return known;
}

}  // namespace

std::vector<FtdiDevice> FtdiLink::find(UsbId id) {
  std::vector<FtdiDevice> found;
  const Context chip(ftdi_new());
  if (!chip) return found;
  const List list = list_devices(chip.get(), id);
  for (const ftdi_device_list* each = list.get(); each != nullptr; each = each->next)
    found.push_back(describe(each->dev));
  return found;
}

Result<std::unique_ptr<FtdiLink>> FtdiLink::open(UsbId id, const std::string& serial, int baud) {
  Context chip(ftdi_new());
  if (!chip) return fail("USB cannot be used here", serial, "check that the system has USB");
  List list = list_devices(chip.get(), id);
  std::optional<Error> closed;
  for (const ftdi_device_list* each = list.get(); each != nullptr; each = each->next) {
    const FtdiDevice device = describe(each->dev);
    if (device.closed) closed = device.closed;
    if (device.serial != serial) continue;

    ftdi_set_interface(chip.get(), INTERFACE_A);
    if (const int code = ftdi_usb_open_dev(chip.get(), each->dev); code != 0) {
      if (code == usb_claim_failed) return tl::unexpected(open_error(LIBUSB_ERROR_BUSY, serial));
      if (code == usb_open_failed) return tl::unexpected(open_error(LIBUSB_ERROR_NO_DEVICE, serial));
      return fail(ftdi_get_error_string(chip.get()), serial, "plug it in again");
    }
    list.reset();  // of the chip's context, which a link that fails takes with it
    std::unique_ptr<FtdiLink> link(new FtdiLink(chip.release(), serial));
    if (Status ready = link->configure(baud); !ready) return tl::unexpected(ready.error());
    return link;
  }
  if (closed)
    return fail("not found among those that can be opened (" + closed->where + ": " + closed->what + ")", serial,
                closed->remedy);
  return fail("there is no USB device with this serial number", serial,
              "check its cable and power, or correct the number");
}

Status FtdiLink::configure(int baud) {
  const bool taken = ftdi_set_baudrate(chip_, baud) == 0 &&
                     ftdi_set_line_property(chip_, BITS_8, STOP_BIT_1, NONE) == 0 &&
                     ftdi_set_latency_timer(chip_, latency_ms) == 0;
  std::this_thread::sleep_for(dwell);
  const bool purged = taken && ftdi_tcioflush(chip_) == 0;
  std::this_thread::sleep_for(dwell);
  if (!purged || ftdi_usb_reset(chip_) != 0 || ftdi_setflowctrl(chip_, SIO_RTS_CTS_HS) != 0 ||
      ftdi_setrts(chip_, 1) != 0)
    return fail("does not take " + std::to_string(baud) + " baud, 8N1, RTS/CTS: " + ftdi_get_error_string(chip_),
                serial_, "plug it in again");
  chip_->usb_read_timeout = chip_->usb_write_timeout = transfer_ms;
  return {};
}

FtdiLink::~FtdiLink() {
  ftdi_usb_close(chip_);
  ftdi_free(chip_);
}

LinkResult<void> FtdiLink::write(std::span<const std::uint8_t> bytes) {
  const std::scoped_lock alone(writing_);
  const int count = ftdi_write_data(chip_, bytes.data(), static_cast<int>(bytes.size()));
  if (count == static_cast<int>(bytes.size())) return {};
  // The library tells every transfer that fails alike: one that answers is only busy.
  unsigned short lines = 0;
  return tl::unexpected(count >= 0 || ftdi_poll_modem_status(chip_, &lines) == 0 ? LinkFault::timeout
                                                                                 : LinkFault::hang_up);
}

LinkResult<std::vector<std::uint8_t>> FtdiLink::read(Milliseconds timeout) {
  const Clock::time_point deadline = Clock::now() + timeout;
  do {
    // One byte: asked for more, the library waits for a packet that brings nothing.
    std::vector<std::uint8_t> bytes(1);
    const int count = ftdi_read_data(chip_, bytes.data(), 1);
    if (count < 0 && count != LIBUSB_ERROR_TIMEOUT) return tl::unexpected(LinkFault::hang_up);
    if (count <= 0) continue;
    const unsigned rest = chip_->readbuffer_remaining;
    bytes.resize(1 + rest);
    if (rest > 0) ftdi_read_data(chip_, bytes.data() + 1, static_cast<int>(rest));
    return bytes;
  } while (Clock::now() < deadline);
  return tl::unexpected(LinkFault::timeout);
}

}  // namespace lumifield
