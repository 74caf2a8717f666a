#include "acquisition/virtual/gige_camera.h"

#include <algorithm>
#include <arpa/inet.h>
#include <arv.h>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <sys/mman.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "acquisition/virtual/genicam_description.h"
#include "acquisition/virtual/genicam_pixels.h"
#include "acquisition/virtual/genicam_processing.h"
#include "acquisition/virtual/genicam_registers.h"

namespace lumifield::virtual_bench {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr guint32 name_bytes = 32, serial_bytes = 16;
constexpr guint16 gvcp_port = 3956;
constexpr double shortest_exposure_us = 10, longest_exposure_us = 1e7;

constexpr double automatic_exposure_us = 20000, automatic_gain_db = 6;

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

double at_start(const GenicamLeftover& setting, const GigeCameraOptions& options) {
  return options.automatics ? setting.left : setting.harmless;
}

std::map<std::string, double> stuck_values(const GigeCameraOptions& options) {
  std::map<std::string, double> values;
  for (const GenicamLeftover& each : leftovers)
    if (std::ranges::find(options.stuck, each.feature) != options.stuck.end())
      values[each.feature] = at_start(each, options);
  return values;
}

}  // namespace

struct GigeCamera::Impl {
  GigeCameraOptions options;
  GenicamPixelFormat format;
  Sight sight;
  std::atomic<bool> frozen = false;
  std::atomic<std::uint64_t> sent = 0;

  std::mutex mutex;
  std::condition_variable read_out;
  Exposure latched;      // guarded by mutex
  bool pending = false;  // guarded by mutex: released, not yet read out

  // The threads end first: the exposures, then the server, which asks for pixels.
  std::unique_ptr<ArvGvFakeCamera, void (*)(void*)> server{nullptr, &g_object_unref};
  ArvFakeCamera* camera = nullptr;
  std::jthread exposure_thread;

  guint32 get(guint32 address) const {
    guint32 value = 0;
    arv_fake_camera_read_register(camera, address, &value);
    return value;
  }
  void set(guint32 address, guint32 value) { arv_fake_camera_write_register(camera, address, value); }

  double get_double(guint32 address) const {
    guint64 bytes = 0;
    arv_fake_camera_read_memory(camera, address, sizeof bytes, &bytes);
    return std::bit_cast<double>(GUINT64_FROM_BE(bytes));
  }
  void set_double(guint32 address, double value) {
    const guint64 bytes = GUINT64_TO_BE(std::bit_cast<guint64>(value));
    arv_fake_camera_write_memory(camera, address, sizeof bytes, &bytes);
  }
  void set_text(guint32 address, guint32 size, const std::string& text) {
    std::string field(size, '\0');
    text.copy(field.data(), size - 1);
    arv_fake_camera_write_memory(camera, address, size, field.data());
  }

  bool acquiring() const {
    return arv_fake_camera_get_acquisition_status(camera) != 0 &&
           arv_fake_camera_get_control_channel_privilege(camera) != 0;
  }

  void set_registers() {
    set_text(registers::vendor, name_bytes, "Lumifield");
    set_text(registers::model, name_bytes, "Virtual");
    const guint32 width = guint32(options.width_px), height = guint32(options.height_px);
    const std::pair<guint32, guint32> values[] = {{ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH, width},
                                                  {ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT, height},
                                                  {ARV_FAKE_CAMERA_REGISTER_WIDTH, width},
                                                  {ARV_FAKE_CAMERA_REGISTER_HEIGHT, height},
                                                  {ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, format.code},
                                                  {registers::binning_horizontal, 1},
                                                  {registers::binning_vertical, 1},
                                                  {registers::trigger_mode, 0},
                                                  {registers::trigger_source, 1},
                                                  {registers::stream_packet_size, 8192},
                                                  // The simulator's own: triggered by the exposure thread only.
                                                  {ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE, 1},
                                                  {ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE, 1}};
    for (const auto& [address, value] : values) set(address, value);
    set_double(registers::exposure_time, 10000);
    set_double(registers::gain, 0);
    for (const GenicamLeftover& each : leftovers) {
      const double value = at_start(each, options);
      each.is_float ? set_double(each.address, value) : set(each.address, guint32(value));
    }
    arv_fake_camera_set_trigger_frequency(camera, 1000);
  }

  GenicamProcessing processing() const {
    const double gain_db =
        get(registers::digital_gain_auto) != 0 ? automatic_gain_db : get_double(registers::digital_gain);
    return {.mirrored_x = get(registers::reverse_x) != 0,
            .mirrored_y = get(registers::reverse_y) != 0,
            .gain_db = gain_db,
            .red = get_double(registers::red_ratio),
            .blue = get_double(registers::blue_ratio),
            .gamma = get(registers::gamma_enable) != 0 ? get_double(registers::gamma) : 1,
            .table = get(registers::lut_enable) != 0,
            .white_balance = get(registers::balance_white_auto) != 0,
            .black_level = get(registers::black_level_auto) != 0};
  }

  // The region, binned.
  std::vector<std::uint16_t> photosites(Exposure exposure, int width, int height) const {
    const int columns = int(get(registers::binning_horizontal)), rows = int(get(registers::binning_vertical));
    exposure.width_px = width * columns, exposure.height_px = height * rows;
    exposure.offset_x_px = int(get(ARV_FAKE_CAMERA_REGISTER_X_OFFSET)) * columns;
    exposure.offset_y_px = int(get(ARV_FAKE_CAMERA_REGISTER_Y_OFFSET)) * rows;
    std::vector<std::uint16_t> dn(std::size_t(exposure.width_px) * std::size_t(exposure.height_px));
    sight.expose(exposure, dn);
    if (columns * rows == 1) return dn;
    std::vector<std::uint16_t> binned(std::size_t(width) * std::size_t(height));
    bin(dn, columns, rows, width, binned);
    return binned;
  }

  // Server thread: the simulator wants pixels.
  void fill(ArvBuffer* buffer) {
    Exposure exposure;
    {
      const std::lock_guard lock(mutex);
      exposure = latched;
    }
    std::size_t bytes = 0;
    auto* data = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, &bytes)));
    const int width = arv_buffer_get_image_width(buffer), height = arv_buffer_get_image_height(buffer);
    std::vector<std::uint16_t> dn = photosites(exposure, width, height);
    const std::uint64_t frame = ++sent;
    if (const GenicamProcessing now = processing(); now.changes()) now.apply(dn, width, format.bits, frame);
    pack(dn, format, {data, (dn.size() * std::size_t(format.bits_per_pixel()) + 7) / 8});
    const std::lock_guard lock(mutex);
    pending = false;
    read_out.notify_all();
  }

  // Exposure thread.
  void watch(std::stop_token stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(std::chrono::microseconds(500));
      const bool triggered = get(registers::trigger_mode) == 0 || get(registers::trigger_software) != 0;
      if (!triggered) continue;
      set(registers::trigger_software, 0);
      if (acquiring() && !frozen) expose(stop);
    }
  }

  void expose(std::stop_token stop) {
    const bool is_told = get(registers::exposure_auto) == 0 && get(registers::exposure_mode) == timed;
    const double exposure_us = is_told ? get_double(registers::exposure_time) : automatic_exposure_us;
    if (!(exposure_us >= shortest_exposure_us && exposure_us <= longest_exposure_us)) return;
    const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double, std::micro>(exposure_us));
    const Exposure exposure{
        .stage_mm = sight.stage_mm(),
        .exposure_s = exposure_us * 1e-6,
        .gain_db = get(registers::gain_auto) != 0 ? automatic_gain_db : get_double(registers::gain)};
    const guint32 port = get(registers::stream_port);
    sight.wait_ready(exposure.stage_mm);
    if (get(registers::stream_port) != port) return;
    while (Clock::now() < end) {
      if (stop.stop_requested() || !acquiring()) return;
      std::this_thread::sleep_until(std::min(end, Clock::now() + milliseconds(10)));
    }
    release(exposure, stop);
  }

  void release(const Exposure& exposure, std::stop_token stop) {
    std::unique_lock lock(mutex);
    latched = exposure;
    pending = true;
    set(registers::trigger_software, 0);
    set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE, 1);
    while (pending && acquiring() && !stop.stop_requested()) read_out.wait_for(lock, milliseconds(10));
    if (pending) set(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE, 0);
    pending = false;
  }
};

Result<std::unique_ptr<GigeCamera>> GigeCamera::start(const GigeCameraOptions& options, Sight sight) {
  const auto format = genicam_pixel_format(options.pixel_format);
  if (!format) return fail("pixel format unknown", options.pixel_format, "give one such as Mono12 or BayerRG12p");
  if (options.serial.empty() || options.serial.size() >= serial_bytes)
    return fail("the serial number must have 1 to 15 characters", options.serial);
  if (auto free = check_address(options.address); !free) return tl::unexpected(free.error());
  const int description = open_description(genicam_description(options.pixel_format, stuck_values(options)));
  if (description < 0) return fail(std::string("no memory for the camera's description: ") + std::strerror(errno), "");
  const std::string description_path = "/proc/self/fd/" + std::to_string(description);

  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->format = *format;
  impl->sight = std::move(sight);
  impl->server.reset(ARV_GV_FAKE_CAMERA(g_object_new(
      ARV_TYPE_GV_FAKE_CAMERA, "interface-name", options.address.c_str(), "serial-number", options.serial.c_str(),
      "genicam-filename", description_path.c_str(), "gvsp-lost-ratio", options.lost_packet_ratio, nullptr)));
  close(description);
  if (!arv_gv_fake_camera_is_running(impl->server.get()))
    return fail("no network interface of this machine has the address", options.address,
                "give one that `ip addr` lists, or add it: ip addr add " + options.address + "/8 dev lo");
  impl->camera = arv_gv_fake_camera_get_fake_camera(impl->server.get());
  impl->set_registers();
  const auto fill = [](ArvBuffer* buffer, void* self, guint32, guint32, ArvPixelFormat) {
    static_cast<Impl*>(self)->fill(buffer);
  };
  arv_fake_camera_set_fill_pattern(impl->camera, fill, impl.get());
  impl->exposure_thread = std::jthread([self = impl.get()](std::stop_token stop) { self->watch(stop); });
  return std::unique_ptr<GigeCamera>(new GigeCamera(std::move(impl)));
}

GigeCamera::GigeCamera(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
GigeCamera::~GigeCamera() = default;

void GigeCamera::freeze(bool frozen) { impl_->frozen = frozen; }
std::uint64_t GigeCamera::frames_sent() const { return impl_->sent; }

}  // namespace lumifield::virtual_bench
