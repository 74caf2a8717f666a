#include "acquisition/virtual/usb_node.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>
#include <unistd.h>

namespace lumifield::virtual_bench {

void UnrefIoctlData::operator()(UMockdevIoctlData* data) const { g_object_unref(data); }

usbdevfs_urb& UsbNode::Urb::head() const { return *reinterpret_cast<usbdevfs_urb*>(block->data); }
std::size_t UsbNode::Urb::length() const { return static_cast<std::size_t>(head().buffer_length); }
std::uint8_t* UsbNode::Urb::bytes() const { return buffer ? buffer->data : nullptr; }

UsbNode::UsbNode(const UsbDescription& description, UsbFunction& function, int fifo)
    : description_(description), function_(function), fifo_(fifo), has_driver_(!description.kernel_driver.empty()) {
  fcntl(fifo_, F_SETPIPE_SZ, 4096);
  show();
}
UsbNode::~UsbNode() { close(fifo_); }

/// Whether there is something to reap, as the device file polls.
void UsbNode::show() {
  const bool full = done_.empty() && !ended_;
  char filling[4096] = {};
  if (full == full_) return;
  if (full)
    full_ = write(fifo_, filling, sizeof filling) > 0;
  else
    full_ = read(fifo_, filling, sizeof filling) <= 0;
}

void UsbNode::finish(Urb urb, std::size_t bytes, int status) {
  urb.head().status = status, urb.head().actual_length = static_cast<int>(bytes);
  done_.push_back(std::move(urb));
  show();
}

void UsbNode::end() {
  ended_ = true;
  for (Urb& urb : std::exchange(reading_, {})) finish(std::move(urb), 0, -ESHUTDOWN);
  show();
}

void UsbNode::forget(const Client* client) {
  std::erase_if(owners_, [client](const auto& owner) { return owner.second == client; });
  for (auto* queue : {&reading_, &done_})
    std::erase_if(*queue, [client](const Urb& urb) { return urb.client == client; });
  show();
}

bool UsbNode::give() {
  std::deque<Urb> waiting;
  for (Urb& urb : std::exchange(reading_, {})) {
    const std::uint8_t endpoint = urb.head().endpoint;
    const bool is_next = std::ranges::none_of(waiting, [&](const Urb& w) { return w.head().endpoint == endpoint; });
    const auto bytes = is_next ? function_.give(endpoint, {urb.bytes(), urb.length()}, urb.asked) : std::nullopt;
    bytes ? finish(std::move(urb), *bytes, 0) : waiting.push_back(std::move(urb));
  }
  reading_ = std::move(waiting);
  return !reading_.empty();
}

int UsbNode::answer(Client* client, unsigned long request, UMockdevIoctlData* argument, IoctlData block) {
  // What was under way can still be reaped.
  const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
  if (ended_ && !(reaps && !done_.empty())) return ENODEV;
  if (_IOC_SIZE(request) > 0 && !block) return EFAULT;  // the program died meanwhile
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      // A transfer is one request, however long: as with a USB 3 host.
      *reinterpret_cast<std::uint32_t*>(block->data) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                                       USBDEVFS_CAP_BULK_SCATTER_GATHER |
                                                       USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    case USBDEVFS_GETDRIVER:
      if (!has_driver_) return ENODATA;
      std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(block->data)->driver, description_.kernel_driver.c_str());
      return 0;
    case USBDEVFS_IOCTL:  // to detach the driver is all that it is used for
      return std::exchange(has_driver_, false) ? 0 : ENODATA;
    case USBDEVFS_CLAIMINTERFACE:
      return claim(client, *reinterpret_cast<unsigned*>(block->data));
    case USBDEVFS_RELEASEINTERFACE:
      if (owns(client, *reinterpret_cast<unsigned*>(block->data)))
        owners_.erase(*reinterpret_cast<unsigned*>(block->data));
      return 0;
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESET:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(client, std::move(block));
    case USBDEVFS_DISCARDURB:
      return discard(client, *reinterpret_cast<unsigned long*>(argument->data));
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(client, block.get());
    default:
      return ENOTTY;
  }
}

bool UsbNode::owns(const Client* client, unsigned interface) const {
  const auto at = owners_.find(interface);
  return at != owners_.end() && at->second == client;
}

int UsbNode::claim(Client* client, unsigned interface) {
  if (has_driver_ || (owners_.contains(interface) && !owns(client, interface))) return EBUSY;
  owners_[interface] = client;
  return 0;
}

int UsbNode::submit(Client* client, IoctlData block) {
  Urb urb{client, std::move(block), {}, UsbFunction::Clock::now()};
  usbdevfs_urb& head = urb.head();
  const auto at = reinterpret_cast<std::uint8_t*>(&head.buffer) - reinterpret_cast<std::uint8_t*>(&head);
  const std::size_t length = urb.length();
  urb.buffer.reset(umockdev_ioctl_data_resolve(urb.block.get(), static_cast<gsize>(at), length, nullptr));
  if (length > 0 && !urb.buffer) return EFAULT;
  const auto endpoint = description_.endpoints.find(head.endpoint);
  if (head.type == USBDEVFS_URB_TYPE_CONTROL) {
    const int count = function_.control(urb.bytes());
    finish(std::move(urb), static_cast<std::size_t>(std::max(0, count)), std::min(0, count));
  } else if (endpoint == description_.endpoints.end() || !owns(client, endpoint->second)) {
    return EINVAL;
  } else if ((head.endpoint & USB_DIR_IN) == 0) {
    function_.take(head.endpoint, {urb.bytes(), length});
    finish(std::move(urb), length, 0);
  } else {
    reading_.push_back(std::move(urb));
  }
  give();
  return 0;
}

int UsbNode::discard(const Client* client, unsigned long address) {
  const auto at = std::ranges::find_if(
      reading_, [&](const Urb& urb) { return urb.client == client && urb.block->client_addr == address; });
  if (at == reading_.end()) return EINVAL;
  Urb urb = std::move(*at);
  reading_.erase(at);
  finish(std::move(urb), 0, -ENOENT);
  return 0;
}

int UsbNode::reap(const Client* client, UMockdevIoctlData* pointer) {
  const auto at = std::ranges::find(done_, client, &Urb::client);
  if (at == done_.end()) return EAGAIN;
  umockdev_ioctl_data_set_ptr(pointer, 0, at->block.get());
  done_.erase(at);
  show();
  return 0;
}

}  // namespace lumifield::virtual_bench
