#pragma once

#include <deque>
#include <map>
#include <memory>

#include "acquisition/virtual/usb_device.h"

typedef struct _UMockdevIoctlClient UMockdevIoctlClient;
typedef struct _UMockdevIoctlData UMockdevIoctlData;
struct usbdevfs_urb;

namespace lumifield::virtual_bench {

struct UnrefIoctlData {
  void operator()(UMockdevIoctlData* data) const;
};
using IoctlData = std::unique_ptr<UMockdevIoctlData, UnrefIoctlData>;

/// The device file of one plugging in of a UsbDevice: who claims it, and what is asked of it. Guarded by the device.
class UsbNode {
 public:
  using Client = UMockdevIoctlClient;

  /// `fifo` is the device file, both ends of it, and closed with the node. Full: nothing to reap. The kernel's device
  /// file polls as writable when there is something.
  UsbNode(const UsbDescription& description, UsbFunction& function, int fifo);
  ~UsbNode();
  UsbNode(const UsbNode&) = delete;
  UsbNode& operator=(const UsbNode&) = delete;

  /// Answers a request with its argument, and what this points to: 0 or errno.
  int answer(Client* client, unsigned long request, UMockdevIoctlData* argument, IoctlData block);
  /// Fills what waits, each endpoint's in their order. True: something waits still.
  bool give();
  /// The device is unplugged.
  void end();
  bool has_ended() const { return ended_; }
  /// The program has closed the file, or died.
  void forget(const Client* client);

 private:
  struct Urb {
    Client* client;
    IoctlData block, buffer;
    UsbFunction::Clock::time_point asked;
    usbdevfs_urb& head() const;
    std::size_t length() const;
    std::uint8_t* bytes() const;
  };
  void show();
  void finish(Urb urb, std::size_t bytes, int status);
  bool owns(const Client* client, unsigned interface) const;
  int claim(Client* client, unsigned interface);
  int submit(Client* client, IoctlData block);
  int discard(const Client* client, unsigned long address);
  int reap(const Client* client, UMockdevIoctlData* pointer);

  const UsbDescription& description_;
  UsbFunction& function_;
  const int fifo_;
  bool full_ = false, ended_ = false, has_driver_;
  std::map<unsigned, Client*> owners_;  // of interfaces
  std::deque<Urb> reading_, done_;
};

}  // namespace lumifield::virtual_bench
