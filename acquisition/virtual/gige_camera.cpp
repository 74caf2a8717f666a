#include "acquisition/virtual/gige_camera.h"

#include <arpa/inet.h>
#include <arv.h>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <sys/mman.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "acquisition/virtual/genicam_registers.h"

namespace lumifield::virtual_bench {

namespace {

constexpr guint16 gvcp_port = 3956;
constexpr guint32 stream_port = 0xd00, stream_packet_size = 0xd04;  // of GigE Vision's bootstrap area

static_assert(registers::width == ARV_FAKE_CAMERA_REGISTER_WIDTH &&
              registers::height == ARV_FAKE_CAMERA_REGISTER_HEIGHT &&
              registers::sensor_width == ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH &&
              registers::sensor_height == ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT &&
              registers::acquisition == ARV_FAKE_CAMERA_REGISTER_ACQUISITION &&
              registers::pixel_format == ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT &&
              registers::offset_x == ARV_FAKE_CAMERA_REGISTER_X_OFFSET &&
              registers::offset_y == ARV_FAKE_CAMERA_REGISTER_Y_OFFSET);

// The simulator says that it runs when its port is taken: this asks the kernel first.
Status check_address(const std::string& address) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(gvcp_port);
  if (inet_pton(AF_INET, address.c_str(), &name.sin_addr) != 1)
    return fail("not an IPv4 address", address, "give one such as 127.0.0.1");
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return fail(std::string("no socket: ") + std::strerror(errno), address);
  const int failed = bind(probe, reinterpret_cast<const sockaddr*>(&name), sizeof name) == 0 ? 0 : errno;
  close(probe);
  if (failed == EADDRINUSE)
    return fail("another virtual bench, or another GigE Vision program, holds UDP port 3956", address,
                "end it, or give another --address");
  if (failed == EADDRNOTAVAIL)
    return fail("no network interface of this machine has the address", address, "give one that `ip addr` lists");
  if (failed != 0) return fail(std::string("UDP port 3956: ") + std::strerror(failed), address);
  return {};
}

// The simulator reads its description from a file, once, while it starts: one that is in memory only. -1 on failure.
int open_description(const std::string& xml) {
  const int file = memfd_create("virtual-camera.xml", MFD_CLOEXEC);
  if (file >= 0 && write(file, xml.data(), xml.size()) == ssize_t(xml.size())) return file;
  if (file >= 0) close(file);
  return -1;
}

/// The simulator's memory.
class SimulatorMemory final : public RegisterMemory {
 public:
  void read(std::uint32_t address, std::span<std::uint8_t> bytes) const override {
    arv_fake_camera_read_memory(camera, address, guint32(bytes.size()), bytes.data());
  }
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes) override {
    arv_fake_camera_write_memory(camera, address, guint32(bytes.size()), bytes.data());
  }
  ArvFakeCamera* camera = nullptr;
};

}  // namespace

struct GigeCamera::Impl final : FrameLink {
  SimulatorMemory memory;
  GenicamSensor sensor;

  std::mutex mutex;
  std::condition_variable read_out;
  Exposure latched;      // guarded by mutex
  bool pending = false;  // guarded by mutex: released, not yet read out

  // The threads end first: the exposures, then the server, which asks for pixels.
  std::unique_ptr<ArvGvFakeCamera, void (*)(void*)> server{nullptr, &g_object_unref};
  std::jthread exposure_thread;

  Impl(const GenicamOptions& options, Sight sight) : sensor(options, std::move(sight), memory) {}

  bool acquiring() const override {
    return arv_fake_camera_get_acquisition_status(memory.camera) != 0 &&
           arv_fake_camera_get_control_channel_privilege(memory.camera) != 0;
  }
  std::uint64_t stream() const override { return memory.get(stream_port); }

  void power_up() {
    sensor.power_up();
    memory.set(stream_packet_size, 8192);
    // The simulator's own trigger: the exposure thread alone pulls it.
    memory.set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE, 1);
    memory.set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE, 1);
    arv_fake_camera_set_trigger_frequency(memory.camera, 1000);
  }

  // Server thread: the simulator wants pixels.
  void fill(ArvBuffer* buffer) {
    Exposure exposure;
    {
      const std::lock_guard lock(mutex);
      exposure = latched;
    }
    std::size_t size = 0;
    auto* bytes = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &size)));
    sensor.read_out(exposure, arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer), {bytes, size});
    const std::lock_guard lock(mutex);
    pending = false;
    read_out.notify_all();
  }

  void send(const Exposure& exposure, std::stop_token stop) override {
    std::unique_lock lock(mutex);
    latched = exposure;
    pending = true;
    memory.set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE, 1);
    while (pending && acquiring() && !stop.stop_requested()) read_out.wait_for(lock, std::chrono::milliseconds(10));
    if (pending) memory.set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE, 0);
    pending = false;
  }
};

Result<std::unique_ptr<GigeCamera>> GigeCamera::start(const GigeCameraOptions& options, Sight sight) {
  if (Status checked = check(options.genicam); !checked) return tl::unexpected(checked.error());
  if (auto free = check_address(options.address); !free) return tl::unexpected(free.error());
  const int description = open_description(genicam_description(options.genicam));
  if (description < 0) return fail(std::string("no memory for the camera's description: ") + std::strerror(errno), "");
  const std::string description_path = "/proc/self/fd/" + std::to_string(description);

  auto impl = std::make_unique<Impl>(options.genicam, std::move(sight));
  impl->server.reset(ARV_GV_FAKE_CAMERA(g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", options.address.c_str(),
                                                     "serial-number", options.genicam.serial.c_str(),
                                                     "genicam-filename", description_path.c_str(), "gvsp-lost-ratio",
                                                     options.lost_packet_ratio, nullptr)));
  close(description);
  if (!arv_gv_fake_camera_is_running(impl->server.get()))
    return fail("no network interface of this machine has the address", options.address,
                "give one that `ip addr` lists, or add it: ip addr add " + options.address + "/8 dev lo");
  impl->memory.camera = arv_gv_fake_camera_get_fake_camera(impl->server.get());
  impl->power_up();
  const auto fill = [](ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
    static_cast<Impl*>(self)->fill(buffer);
  };
  arv_fake_camera_set_fill_pattern(impl->memory.camera, fill, impl.get());
  impl->exposure_thread = std::jthread([self = impl.get()](std::stop_token stop) { self->sensor.run(*self, stop); });
  return std::unique_ptr<GigeCamera>(new GigeCamera(std::move(impl)));
}

GigeCamera::GigeCamera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GigeCamera::~GigeCamera() = default;

void GigeCamera::freeze(bool frozen) { impl_->sensor.freeze(frozen); }
std::uint64_t GigeCamera::frames_sent() const { return impl_->sensor.frames_read_out(); }

}  // namespace lumifield::virtual_bench
