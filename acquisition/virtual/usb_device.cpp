#include "acquisition/virtual/usb_device.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <linux/usb/ch9.h>
#include <linux/usbdevice_fs.h>
#include <mutex>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

namespace lumifield::virtual_bench {
namespace {

using Clock = UsbFunction::Clock;

/// As umockdev reads it: path, device file, properties, attributes.
std::string describe(const UsbDescription& device, const std::string& syspath, int number) {
  char text[2048];
  std::snprintf(text, sizeof text,
                "P: %s\nN: bus/usb/001/%03d\nE: BUSNUM=001\nE: DEVNUM=%03d\nE: DEVNAME=/dev/bus/usb/001/%03d\n"
                "E: DEVTYPE=usb_device\nE: DRIVER=usb\nE: PRODUCT=%x/%x/%x\nE: SUBSYSTEM=usb\nE: MAJOR=189\n"
                "E: MINOR=%d\nE: TYPE=0/0/0\nA: busnum=1\\n\nA: devnum=%d\\n\nA: bConfigurationValue=1\\n\n"
                "A: speed=%d\\n\nA: idVendor=%04x\\n\nA: idProduct=%04x\\n\nA: serial=%s\\n\nH: descriptors=%s\n\n",
                syspath.c_str(), number, number, number, device.vendor, device.product, device.release, number - 1,
                number, device.speed_mbit_s, device.vendor, device.product, device.serial.c_str(),
                device.descriptors.c_str());
  return text;
}

struct Unref {
  void operator()(UMockdevIoctlData* data) const { g_object_unref(data); }
};
using Data = std::unique_ptr<UMockdevIoctlData, Unref>;

struct Urb {
  UMockdevIoctlClient* client;
  Data block, buffer;
  Clock::time_point asked;
  usbdevfs_urb& head() const { return *reinterpret_cast<usbdevfs_urb*>(block->data); }
};

}  // namespace

struct UsbDevice::Impl {
  UsbBus& bus;
  const UsbDescription description;
  UsbFunction& function;

  std::mutex mutex;  // guards all below

  /// The device of one plugging in. Those of earlier ones stay, to answer ENODEV.
  struct Node {
    Impl* device;
    UMockdevIoctlBase* io;
    std::string path, syspath;
    int fifo = -1;  // full: nothing to reap. The kernel's device file polls as writable when there is something.
    bool full = false, gone = false, has_driver = false;
    std::map<unsigned, UMockdevIoctlClient*> owners;  // of interfaces
    std::deque<Urb> reading, done;
  };
  std::vector<std::unique_ptr<Node>> nodes;

  Impl(UsbBus& usb, UsbDescription told, UsbFunction& behind)
      : bus(usb), description(std::move(told)), function(behind) {}

  ~Impl() {
    unplug();
    for (const auto& node : nodes) {
      umockdev_testbed_detach_ioctl(bus.testbed(), node->path.c_str(), nullptr);
      g_signal_handlers_disconnect_by_data(node->io, node.get());
      g_object_unref(node->io);
      close(node->fifo);
    }
  }

  Node* plugged() const { return nodes.empty() || nodes.back()->gone ? nullptr : nodes.back().get(); }

  Status plug() {
    const int number = bus.next_number();
    const std::string syspath = "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
    char path[64];
    std::snprintf(path, sizeof path, "/dev/bus/usb/001/%03d", number);
    auto node = std::make_unique<Node>();
    node->device = this, node->path = path, node->syspath = "/sys" + syspath;
    node->has_driver = !description.kernel_driver.empty();
    node->io = umockdev_ioctl_base_new();
    g_signal_connect(node->io, "handle-ioctl", G_CALLBACK(on_ioctl), node.get());
    g_signal_connect(node->io, "client-vanished", G_CALLBACK(on_vanished), node.get());
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(bus.testbed(), describe(description, syspath, number).c_str(), &error) == 0 ||
        umockdev_testbed_attach_ioctl(bus.testbed(), node->path.c_str(), node->io, &error) == 0)
      return fail(error->message, "virtual USB device " + description.serial, "check umockdev");
    const std::filesystem::path file = bus.root() / node->path.substr(1);
    std::filesystem::remove(file);
    node->fifo = mkfifo(file.c_str(), 0666) == 0 ? open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
    if (node->fifo < 0) return fail(std::strerror(errno), file.string(), "check TMPDIR");
    fcntl(node->fifo, F_SETPIPE_SZ, 4096);
    show(*node);
    function.power_up();
    nodes.push_back(std::move(node));
    return {};
  }

  void unplug() {
    Node* const node = plugged();
    if (node == nullptr) return;
    node->gone = true;
    while (!node->reading.empty()) finish(*node, node->reading, 0, -ESHUTDOWN);
    show(*node);
    umockdev_testbed_uevent(bus.testbed(), node->syspath.c_str(), "remove");
    umockdev_testbed_remove_device(bus.testbed(), node->syspath.c_str());
  }

  /// Whether there is something to reap, as the device file polls.
  static void show(Node& node) {
    const bool full = node.done.empty() && !node.gone;
    char filling[4096] = {};
    if (full == node.full) return;
    if (full)
      node.full = write(node.fifo, filling, sizeof filling) > 0;
    else
      node.full = read(node.fifo, filling, sizeof filling) <= 0;
  }

  static void finish(Node& node, std::deque<Urb>& from, std::size_t bytes, int status) {
    Urb urb = std::move(from.front());
    from.pop_front();
    urb.head().status = status, urb.head().actual_length = static_cast<int>(bytes);
    node.done.push_back(std::move(urb));
    show(node);
  }
  static void finish(Node& node, Urb urb, std::size_t bytes, int status) {
    std::deque<Urb> now;
    now.push_back(std::move(urb));
    finish(node, now, bytes, status);
  }

  /// Fills what waits, each endpoint's in their order.
  bool give() {
    Node* const node = plugged();
    if (node == nullptr) return false;
    std::deque<Urb> waiting;
    while (!node->reading.empty()) {
      const Urb& urb = node->reading.front();
      const std::uint8_t endpoint = urb.head().endpoint;
      const bool is_next = std::ranges::none_of(waiting, [&](const Urb& w) { return w.head().endpoint == endpoint; });
      const auto room = std::span(urb.buffer ? urb.buffer->data : nullptr, std::size_t(urb.head().buffer_length));
      const auto bytes = is_next ? function.give(endpoint, room, urb.asked) : std::nullopt;
      if (bytes) {
        finish(*node, node->reading, *bytes, 0);
      } else {
        waiting.push_back(std::move(node->reading.front()));
        node->reading.pop_front();
      }
    }
    node->reading = std::move(waiting);
    return !node->reading.empty();
  }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
    Node& node = *static_cast<Node*>(data);
    const std::lock_guard lock(node.device->mutex);
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
    Data block(umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), nullptr));
    // What was under way can still be reaped.
    const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
    const int error = node.gone && !(reaps && !node.done.empty())
                          ? ENODEV
                          : node.device->answer(node, client, request, argument, std::move(block));
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return TRUE;
  }

  /// 0 or errno.
  int answer(Node& node, UMockdevIoctlClient* client, unsigned long request, UMockdevIoctlData* argument, Data block) {
    switch (request) {
      case USBDEVFS_GET_CAPABILITIES:
        // A transfer is one request, however long: as with a USB 3 host.
        *reinterpret_cast<std::uint32_t*>(block->data) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                                         USBDEVFS_CAP_BULK_SCATTER_GATHER |
                                                         USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
        return 0;
      case USBDEVFS_GETDRIVER:
        if (!node.has_driver) return ENODATA;
        std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(block->data)->driver, description.kernel_driver.c_str());
        return 0;
      case USBDEVFS_IOCTL:  // to detach the driver is all that it is used for
        return std::exchange(node.has_driver, false) ? 0 : ENODATA;
      case USBDEVFS_CLAIMINTERFACE:
        return claim(node, client, *reinterpret_cast<unsigned*>(block->data));
      case USBDEVFS_RELEASEINTERFACE:
        if (owns(node, client, *reinterpret_cast<unsigned*>(block->data)))
          node.owners.erase(*reinterpret_cast<unsigned*>(block->data));
        return 0;
      case USBDEVFS_CLEAR_HALT:
      case USBDEVFS_RESET:
      case USBDEVFS_SETCONFIGURATION:
      case USBDEVFS_SETINTERFACE:
        return 0;
      case USBDEVFS_SUBMITURB:
        return submit(node, client, std::move(block));
      case USBDEVFS_DISCARDURB:
        return discard(node, client, *reinterpret_cast<unsigned long*>(argument->data));
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY:
        return reap(node, client, block.get());
      default:
        return ENOTTY;
    }
  }

  static bool owns(const Node& node, UMockdevIoctlClient* client, unsigned interface) {
    const auto at = node.owners.find(interface);
    return at != node.owners.end() && at->second == client;
  }

  static int claim(Node& node, UMockdevIoctlClient* client, unsigned interface) {
    if (node.has_driver || (node.owners.contains(interface) && !owns(node, client, interface))) return EBUSY;
    node.owners[interface] = client;
    return 0;
  }

  int submit(Node& node, UMockdevIoctlClient* client, Data block) {
    Urb urb{client, std::move(block), {}, Clock::now()};
    usbdevfs_urb& head = urb.head();
    const auto at = reinterpret_cast<std::uint8_t*>(&head.buffer) - reinterpret_cast<std::uint8_t*>(&head);
    const auto length = static_cast<gsize>(head.buffer_length);
    urb.buffer.reset(umockdev_ioctl_data_resolve(urb.block.get(), static_cast<gsize>(at), length, nullptr));
    std::uint8_t* const bytes = urb.buffer ? urb.buffer->data : nullptr;
    const auto endpoint = description.endpoints.find(head.endpoint);
    if (head.type == USBDEVFS_URB_TYPE_CONTROL) {
      const int count = function.control(bytes);
      finish(node, std::move(urb), static_cast<std::size_t>(std::max(0, count)), std::min(0, count));
    } else if (endpoint == description.endpoints.end() || !owns(node, client, endpoint->second)) {
      return EINVAL;
    } else if ((head.endpoint & USB_DIR_IN) == 0) {
      function.take(head.endpoint, {bytes, length});
      finish(node, std::move(urb), length, 0);
    } else {
      node.reading.push_back(std::move(urb));
    }
    give();
    return 0;
  }

  static int discard(Node& node, UMockdevIoctlClient* client, unsigned long address) {
    const auto at = std::ranges::find_if(
        node.reading, [&](const Urb& urb) { return urb.client == client && urb.block->client_addr == address; });
    if (at == node.reading.end()) return EINVAL;
    Urb urb = std::move(*at);
    node.reading.erase(at);
    finish(node, std::move(urb), 0, -ENOENT);
    return 0;
  }

  static int reap(Node& node, UMockdevIoctlClient* client, UMockdevIoctlData* pointer) {
    const auto at = std::ranges::find(node.done, client, &Urb::client);
    if (at == node.done.end()) return EAGAIN;
    umockdev_ioctl_data_set_ptr(pointer, 0, at->block.get());
    node.done.erase(at);
    show(node);
    return 0;
  }

  static void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
    Node& node = *static_cast<Node*>(data);
    const std::lock_guard lock(node.device->mutex);
    std::erase_if(node.owners, [client](const auto& owner) { return owner.second == client; });
    for (auto* queue : {&node.reading, &node.done})
      std::erase_if(*queue, [client](const Urb& urb) { return urb.client == client; });
    show(node);
  }
};

UsbDevice::UsbDevice(UsbBus& bus, UsbDescription description, UsbFunction& function)
    : impl_(std::make_unique<Impl>(bus, std::move(description), function)) {}
UsbDevice::~UsbDevice() = default;

Status UsbDevice::plug() {
  const std::lock_guard lock(impl_->mutex);
  return impl_->plugged() != nullptr ? Status() : impl_->plug();
}
void UsbDevice::unplug() {
  const std::lock_guard lock(impl_->mutex);
  impl_->unplug();
}
bool UsbDevice::is_plugged() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->plugged() != nullptr;
}
bool UsbDevice::give() {
  const std::lock_guard lock(impl_->mutex);
  return impl_->give();
}

}  // namespace lumifield::virtual_bench
