#include "acquisition/virtual/usb_device.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <mutex>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>

#include "acquisition/virtual/usb_node.h"

namespace lumifield::virtual_bench {
namespace {

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

}  // namespace

struct UsbDevice::Impl {
  UsbBus& bus;
  const UsbDescription description;
  UsbFunction& function;

  std::mutex mutex;  // guards all below

  /// One plugging in. Those of earlier ones stay, to answer ENODEV.
  struct Plugged {
    Impl* device;
    int number;
    std::string path, syspath;
    UMockdevIoctlBase* io = umockdev_ioctl_base_new();
    std::unique_ptr<UsbNode> node = {};

    ~Plugged() {
      umockdev_testbed_detach_ioctl(device->bus.testbed(), path.c_str(), nullptr);
      g_signal_handlers_disconnect_by_data(io, GINT_TO_POINTER(number));
      g_object_unref(io);
    }
  };
  std::vector<std::unique_ptr<Plugged>> all;

  /// Those that can still be asked, by their number: umockdev's thread may come late.
  struct Live {
    inline static std::mutex mutex;  // taken before the device's
    inline static std::map<int, Plugged*> all;
  };
  /// Nothing is done when the device is no more.
  template <class F>
  static void with_node(gpointer number, F act) {
    std::unique_lock live(Live::mutex);
    const auto at = Live::all.find(GPOINTER_TO_INT(number));
    if (at == Live::all.end()) return;
    const Plugged& plugged = *at->second;
    const std::lock_guard lock(plugged.device->mutex);
    live.unlock();
    act(*plugged.node);
  }

  Impl(UsbBus& usb, UsbDescription told, UsbFunction& behind)
      : bus(usb), description(std::move(told)), function(behind) {}

  ~Impl() {
    unplug();
    {
      const std::lock_guard lock(Live::mutex);
      for (const auto& plugged : all) Live::all.erase(plugged->number);
    }
    const std::lock_guard answered(mutex);
    all.clear();
  }

  Plugged* plugged() const { return all.empty() || all.back()->node->has_ended() ? nullptr : all.back().get(); }

  /// With both locks.
  Status plug() {
    const int number = bus.next_number();
    char path[64];
    std::snprintf(path, sizeof path, "/dev/bus/usb/001/%03d", number);
    const std::string syspath = "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(number);
    std::unique_ptr<Plugged> now(new Plugged{this, number, path, "/sys" + syspath});
    g_signal_connect(now->io, "handle-ioctl", G_CALLBACK(on_ioctl), GINT_TO_POINTER(number));
    g_signal_connect(now->io, "client-connected", G_CALLBACK(on_connected), GINT_TO_POINTER(number));
    GError* error = nullptr;
    if (umockdev_testbed_add_from_string(bus.testbed(), describe(description, syspath, number).c_str(), &error) == 0 ||
        umockdev_testbed_attach_ioctl(bus.testbed(), path, now->io, &error) == 0)
      return fail(error->message, "virtual USB device " + description.serial, "check umockdev");
    const std::filesystem::path file = bus.root() / now->path.substr(1);
    std::filesystem::remove(file);
    const int fifo = mkfifo(file.c_str(), 0666) == 0 ? open(file.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC) : -1;
    if (fifo < 0) return fail(std::strerror(errno), file.string(), "check TMPDIR");
    now->node = std::make_unique<UsbNode>(description, function, fifo);
    function.power_up();
    Live::all[number] = now.get();
    all.push_back(std::move(now));
    return {};
  }

  void unplug() {
    const Plugged* const now = plugged();
    if (now == nullptr) return;
    now->node->end();
    umockdev_testbed_uevent(bus.testbed(), now->syspath.c_str(), "remove");
    umockdev_testbed_remove_device(bus.testbed(), now->syspath.c_str());
  }

  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer number) {
    int error = ENODEV;
    with_node(number, [&](UsbNode& node) {
      const unsigned long request = umockdev_ioctl_client_get_request(client);
      UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
      IoctlData block(umockdev_ioctl_data_resolve(argument, 0, _IOC_SIZE(request), nullptr));
      error = node.answer(client, request, argument, std::move(block));
    });
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return TRUE;
  }

  /// umockdev tells of no client's end, however it came: the end of what stands for it tells.
  static void on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer number) {
    g_object_weak_ref(G_OBJECT(client), on_vanished, number);
  }
  static void on_vanished(gpointer number, GObject* what_it_was) {
    with_node(number, [&](UsbNode& node) { node.forget(reinterpret_cast<UMockdevIoctlClient*>(what_it_was)); });
  }
};

UsbDevice::UsbDevice(UsbBus& bus, UsbDescription description, UsbFunction& function)
    : impl_(std::make_unique<Impl>(bus, std::move(description), function)) {}
UsbDevice::~UsbDevice() = default;

Status UsbDevice::plug() {
  const std::scoped_lock lock(Impl::Live::mutex, impl_->mutex);
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
  const Impl::Plugged* const now = impl_->plugged();
  return now != nullptr && now->node->give();
}

}  // namespace lumifield::virtual_bench
