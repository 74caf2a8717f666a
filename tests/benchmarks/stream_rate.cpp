// Frames that a camera sends by itself, one after the other, through the program's own stream: how many arrive whole,
// by rate and packet size. Not a test: run it alone on the machine, as root and as an ordinary user (who has no packet
// socket):
//
//   stream_rate [FRAMES [RATE_HZ...]]                                       default 1000 frames at 60/s
//   setpriv --reuid 65534 --clear-groups --bounding-set -all stream_rate 1000 10 20 30 40 60
//
// LUMIFIELD_PACKET (bytes, 8192) and LUMIFIELD_LOSS (share of packets not sent, 0) tell the rest. Frames of 2048×1536
// Mono12; each is compared pixel by pixel with what its number says.

#include <algorithm>
#include <arv.h>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "acquisition/cameras/aravis_settings.h"
#include "acquisition/cameras/aravis_stream.h"
#include "acquisition/virtual/gige_camera.h"

namespace lumifield {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int width_px = 2048, height_px = 1536;
constexpr double readout_s = 1.5e-3;  ///< of the virtual camera: an exposure begins so long after the one before

double from_environment(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : otherwise;
}

/// Pixel i of frame n is pattern[(i + 97 n) mod its size]: no two frames alike, none made anew.
std::vector<std::uint16_t> pattern() {
  std::vector<std::uint16_t> dn(std::size_t(width_px) * height_px);
  for (std::size_t i = 0; i < dn.size(); ++i) dn[i] = static_cast<std::uint16_t>((i * 2654435761U >> 7) & 4095);
  return dn;
}
void frame_of(const std::vector<std::uint16_t>& dn, std::size_t number, std::span<std::uint16_t> out) {
  const auto middle = dn.begin() + static_cast<std::ptrdiff_t>(97 * number % dn.size());
  std::copy(dn.begin(), middle, std::copy(middle, dn.end(), out.begin()));
  out[0] = static_cast<std::uint16_t>(number & 4095);
  out[1] = static_cast<std::uint16_t>(number >> 12);
}

/// The camera, in a process of its own.
int serve(int ready) {
  std::atomic<std::size_t> number = 0;
  const std::vector<std::uint16_t> dn = pattern();
  virtual_bench::GigeCameraOptions options;
  options.genicam.width_px = width_px, options.genicam.height_px = height_px;
  options.lost_packet_ratio = from_environment("LUMIFIELD_LOSS", 0);
  auto camera = virtual_bench::GigeCamera::start(
      options,
      {.stage_mm = [] { return Vec2(0, 0); },
       .wait_ready = [](const Vec2&) {},
       .expose = [&](const virtual_bench::Exposure&, std::span<std::uint16_t> out) { frame_of(dn, number++, out); }});
  if (!camera) return std::fprintf(stderr, "%s\n", camera.error().message().c_str()), 1;
  if (write(ready, "", 1) != 1) return 1;
  pause();
  return 0;
}

struct Tally {
  int complete = 0, incomplete = 0, wrong = 0;
  double seconds = 0, cpu_s = 0;
};

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

Result<Tally> receive(ArvCamera* camera, int frames, double rate_hz) {
  CameraSettings settings;
  settings.address = "127.0.0.1";
  settings.pixel_format = "Mono12";
  settings.packet_bytes = static_cast<int>(from_environment("LUMIFIELD_PACKET", 8192));
  const Result<AppliedSettings> applied = apply_settings(camera, settings);
  if (!applied) return tl::unexpected(applied.error());
  GFault fault;
  arv_camera_clear_triggers(camera, fault.out());
  arv_camera_set_exposure_time(camera, 1e6 * std::max(1 / rate_hz - readout_s, 1e-5), fault.out());
  if (fault) return refused(settings, "free running", fault);
  auto stream = AravisStream::start(camera, settings, *applied);
  if (!stream) return tl::unexpected(stream.error());
  for (int k = 0; k < 5; ++k) stream->next(1);  // the camera's first

  const std::vector<std::uint16_t> dn = pattern();
  std::vector<std::uint16_t> expected(dn.size());
  Tally tally;
  const double cpu_before_s = cpu_s();
  const auto start = Clock::now();
  for (int k = 0; k < frames; ++k) {
    const AravisStream::Arrival arrival = stream->next(1);
    if (!arrival.came) break;
    if (!arrival.image) {
      ++tally.incomplete;
      continue;
    }
    ++tally.complete;
    const std::vector<std::uint16_t>& got = arrival.image->dn;
    frame_of(dn, got[0] + (std::size_t(got[1]) << 12), expected);
    tally.wrong += got != expected;
  }
  tally.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  tally.cpu_s = cpu_s() - cpu_before_s;
  arv_camera_stop_acquisition(camera, fault.out());
  return tally;
}

int measure(int frames, const std::vector<double>& rates_hz) {
  GFault fault;
  ArvCamera* camera = arv_camera_new("127.0.0.1", fault.out());
  if (fault) return std::fprintf(stderr, "the camera cannot be opened: %s\n", fault.text().c_str()), 1;
  std::printf("%dx%d Mono12, %.0f-byte packets, uid %u\n asked/s  got/s  whole  broken  wrong  CPU s\n", width_px,
              height_px, from_environment("LUMIFIELD_PACKET", 8192), getuid());
  int code = 0;
  for (const double rate_hz : rates_hz) {
    const Result<Tally> tally = receive(camera, frames, rate_hz);
    if (!tally) {
      std::fprintf(stderr, "%s\n", tally.error().message().c_str());
      code = 1;
      break;
    }
    std::printf("%8.1f %6.1f %6d %7d %6d %6.1f\n", rate_hz, (tally->complete + tally->incomplete) / tally->seconds,
                tally->complete, tally->incomplete, tally->wrong, tally->cpu_s);
    std::fflush(stdout);
  }
  g_object_unref(camera);
  return code;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 1000;
  std::vector<double> rates_hz;
  for (int k = 2; k < argc; ++k) rates_hz.push_back(std::atof(argv[k]));
  if (rates_hz.empty()) rates_hz = {60};
  int ready[2];
  if (frames < 1 || pipe(ready) != 0) return 2;
  const pid_t server = fork();
  if (server == 0) return lumifield::serve(ready[1]);
  close(ready[1]);
  char byte = 0;
  const int code = read(ready[0], &byte, 1) == 1 ? lumifield::measure(frames, rates_hz) : 1;
  kill(server, SIGKILL);
  waitpid(server, nullptr, 0);
  return code;
}
