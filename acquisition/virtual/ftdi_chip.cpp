#include "acquisition/virtual/ftdi_chip.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <mutex>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include "acquisition/virtual/ftdi_line.h"

namespace lumifield::virtual_bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int packet_bytes = 64;
constexpr std::uint8_t in_endpoint = 0x81, out_endpoint = 0x02;

// Device 0403:faf0, full speed, one interface with one bulk endpoint each way.
constexpr const char* descriptors =
    "12010002000000080304F0FA000601020301"
    "09022000010100A02D0904000002FFFFFF02"
    "07058102400000"
    "07050202400000";

/// As umockdev reads it: path, device file, properties, attributes.
std::string describe(const std::string& syspath, int number, const std::string& serial) {
  char text[1024];
  std::snprintf(text, sizeof text,
                "P: %s\nN: bus/usb/001/%03d\nE: BUSNUM=001\nE: DEVNUM=%03d\nE: DEVNAME=/dev/bus/usb/001/%03d\n"
                "E: DEVTYPE=usb_device\nE: DRIVER=usb\nE: PRODUCT=403/faf0/600\nE: SUBSYSTEM=usb\nE: MAJOR=189\n"
                "E: MINOR=%d\nE: TYPE=0/0/0\nA: busnum=1\\n\nA: devnum=%d\\n\nA: bConfigurationValue=1\\n\n"
                "A: speed=12\\n\nA: idVendor=0403\\n\nA: idProduct=faf0\\n\nA: serial=%s\\n\nH: descriptors=%s\n\n",
                syspath.c_str(), number, number, number, number - 1, number, serial.c_str(), descriptors);
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

struct FtdiChip::Impl {
  UsbBus& bus;
  std::function<void()> wake;

  std::mutex mutex;  // guards all below

  /// The device of one plugging in. Those of earlier ones stay, to answer ENODEV.
  struct Node {
    Impl* chip;
    UMockdevIoctlBase* io;
    std::string path, syspath;
    int fifo = -1;  // full: nothing to reap. The kernel's device file polls as writable when there is something.
    bool full = false, gone = false, has_driver = true;
    UMockdevIoctlClient* owner = nullptr;
    std::deque<Urb> reading, done;
  };
  std::vector<std::unique_ptr<Node>> nodes;
  FtdiLine line;

  Impl(UsbBus& usb, std::string name, std::string number, std::function<void()> on_bytes)
      : bus(usb), wake(std::move(on_bytes)), line{std::move(name), std::move(number), {}, {}} {}

  ~Impl() {
    unplug();
    for (const auto& node : nodes) {
      umockdev_testbed_detach_ioctl(bus.testbed(), node->path.c_str(), nullptr);
      g_signal_handlers_disconnect_by_data(node->io, node.get());
      g_object_unref(node->io);
      close(node->fifo);
    }
  }

  Node* plugged() { return nodes.empty() || nodes.back()->gone ? nullptr : nodes.back().get(); }

  Status plug() {
    const int number = bus.next_number();
    const std::string syspath = "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
    char path[64];
    std::snprintf(path, sizeof path, "/dev/bus/usb/001/%03d", number);
    auto node = std::make_unique<Node>();
    node->chip = this, node->path = path, node->syspath = "/sys" + syspath;
    node->io = umockdev_ioctl_base_new();
    g_signal_connect(node->io, "handle-ioctl", G_CALLBACK(on_ioctl), node.get());
    g_signal_connect(node->io, "client-vanished", G_CALLBACK(on_vanished), node.get());
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(bus.testbed(), describe(syspath, number, line.serial).c_str(), &error) == 0 ||
        umockdev_testbed_attach_ioctl(bus.testbed(), node->path.c_str(), node->io, &error) == 0)
      return fail(error->message, "virtual USB device " + line.serial, "check umockdev");
    const std::filesystem::path file = bus.root() / node->path.substr(1);
    std::filesystem::remove(file);
    node->fifo = mkfifo(file.c_str(), 0666) == 0 ? open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
    if (node->fifo < 0) return fail(std::strerror(errno), file.string(), "check TMPDIR");
    fcntl(node->fifo, F_SETPIPE_SZ, 4096);
    show(*node);
    line = {line.product, line.serial, {}, {}};
    nodes.push_back(std::move(node));
    return {};
  }

  void unplug() {
    Node* const node = plugged();
    if (node == nullptr) return;
    node->gone = true;
    while (!node->reading.empty()) finish(*node, node->reading, 0, -ESHUTDOWN);
    show(*node);
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

  static void finish(Node& node, std::deque<Urb>& from, int bytes, int status) {
    Urb urb = std::move(from.front());
    from.pop_front();
    urb.head().status = status, urb.head().actual_length = bytes;
    node.done.push_back(std::move(urb));
    show(node);
  }

  /// Packets of what is to be sent, or one empty packet when the latency time is over.
  bool give() {
    Node* const node = plugged();
    if (node == nullptr) return false;
    while (!node->reading.empty()) {
      Urb& urb = node->reading.front();
      if (line.to_send.empty() && Clock::now() < urb.asked + std::chrono::milliseconds(line.latency_ms)) break;
      const int room = urb.head().buffer_length;
      int filled = 0;
      do {
        const int count = std::min({packet_bytes - 2, static_cast<int>(line.to_send.size()), room - filled - 2});
        std::copy_n(ftdi_status, 2, urb.buffer->data + filled);
        std::copy_n(line.to_send.begin(), count, urb.buffer->data + filled + 2);
        line.to_send.erase(line.to_send.begin(), line.to_send.begin() + count);
        filled += count + 2;
      } while (!line.to_send.empty() && filled % packet_bytes == 0 && filled + packet_bytes <= room);
      finish(*node, node->reading, filled, 0);
    }
    return !node->reading.empty();
  }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer data) {
    Node& node = *static_cast<Node*>(data);
    const std::lock_guard lock(node.chip->mutex);
    const unsigned long request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
    Data block(umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), nullptr));
    // What was under way can still be reaped.
    const bool reaps = request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY;
    const int error = node.gone && !(reaps && !node.done.empty())
                          ? ENODEV
                          : node.chip->answer(node, client, request, argument, std::move(block));
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return TRUE;
  }

  /// 0 or errno.
  int answer(Node& node, UMockdevIoctlClient* client, unsigned long request, UMockdevIoctlData* argument, Data block) {
    switch (request) {
      case USBDEVFS_GET_CAPABILITIES:
        *reinterpret_cast<std::uint32_t*>(block->data) = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION |
                                                         USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                                         USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
        return 0;
      case USBDEVFS_GETDRIVER:
        if (!node.has_driver) return ENODATA;
        std::strcpy(reinterpret_cast<usbdevfs_getdriver*>(block->data)->driver, "ftdi_sio");
        return 0;
      case USBDEVFS_IOCTL:  // to detach the driver is all that it is used for
        return std::exchange(node.has_driver, false) ? 0 : ENODATA;
      case USBDEVFS_CLAIMINTERFACE:
        if (node.has_driver || (node.owner != nullptr && node.owner != client)) return EBUSY;
        node.owner = client;
        return 0;
      case USBDEVFS_RELEASEINTERFACE:
        if (node.owner == client) node.owner = nullptr;
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

  int submit(Node& node, UMockdevIoctlClient* client, Data block) {
    Urb urb{client, std::move(block), {}, Clock::now()};
    usbdevfs_urb& head = urb.head();
    const auto at = reinterpret_cast<std::uint8_t*>(&head.buffer) - reinterpret_cast<std::uint8_t*>(&head);
    const int length = head.buffer_length;
    urb.buffer.reset(
        umockdev_ioctl_data_resolve(urb.block.get(), static_cast<gsize>(at), static_cast<gsize>(length), nullptr));
    std::uint8_t* const bytes = urb.buffer->data;
    std::deque<Urb> now;
    if (head.type == USBDEVFS_URB_TYPE_CONTROL) {
      now.push_back(std::move(urb));
      const int count = answer_control(line, bytes);
      finish(node, now, std::max(0, count), std::min(0, count));
    } else if (head.endpoint == out_endpoint && node.owner == client) {
      line.received.insert(line.received.end(), bytes, bytes + length);
      now.push_back(std::move(urb));
      finish(node, now, length, 0);
      wake();
    } else if (head.endpoint == in_endpoint && node.owner == client) {
      node.reading.push_back(std::move(urb));
      give();
    } else {
      return EINVAL;
    }
    return 0;
  }

  static int discard(Node& node, UMockdevIoctlClient* client, unsigned long address) {
    const auto at = std::ranges::find_if(
        node.reading, [&](const Urb& urb) { return urb.client == client && urb.block->client_addr == address; });
    if (at == node.reading.end()) return EINVAL;
    std::deque<Urb> now;
    now.push_back(std::move(*at));
    node.reading.erase(at);
    finish(node, now, 0, -ENOENT);
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
    const std::lock_guard lock(node.chip->mutex);
    if (node.owner == client) node.owner = nullptr;
    for (auto* queue : {&node.reading, &node.done})
      std::erase_if(*queue, [client](const Urb& urb) { return urb.client == client; });
    show(node);
  }
};

Result<std::unique_ptr<FtdiChip>> FtdiChip::plug(UsbBus& bus, std::string product, std::string serial,
                                                 std::function<void()> wake) {
  auto impl = std::make_unique<Impl>(bus, std::move(product), std::move(serial), std::move(wake));
  std::unique_ptr<FtdiChip> chip(new FtdiChip(std::move(impl)));
  if (Status plugged = chip->plug(); !plugged) return tl::unexpected(plugged.error());
  return chip;
}

FtdiChip::FtdiChip(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FtdiChip::~FtdiChip() = default;

Status FtdiChip::plug() {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->plugged() != nullptr) return {};
  return impl_->plug();
}
void FtdiChip::unplug() {
  const std::lock_guard lock(impl_->mutex);
  impl_->unplug();
}
FtdiChip::Bytes FtdiChip::take() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->line.received, {});
}
void FtdiChip::send(const Bytes& bytes) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->plugged() == nullptr) return;
  impl_->line.to_send.insert(impl_->line.to_send.end(), bytes.begin(), bytes.end());
  impl_->give();
}
bool FtdiChip::tick() {
  const std::lock_guard lock(impl_->mutex);
  return impl_->give();
}

}  // namespace lumifield::virtual_bench
