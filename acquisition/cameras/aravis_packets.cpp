#include "acquisition/cameras/aravis_packets.h"

#include <algorithm>
#include <arv.h>
#include <cmath>

#include "acquisition/cameras/aravis_stream.h"
#include "luminaire/wording.h"

namespace lumifield {
namespace {

constexpr double test_exposure_s = 1e-3, watchdog_s = 0.3, us_per_s = 1e6, ns_per_us = 1e3;
constexpr double delay_tolerance_us = 1;

tl::unexpected<Error> error(const CameraSettings& settings, std::string what, std::string remedy) {
  return fail(std::move(what), "camera " + settings.address, std::move(remedy));
}

struct SizeRange {
  int low = 0, high = 0, step = 1;
};

Result<SizeRange> size_range(ArvCamera* camera, const CameraSettings& settings) {
  GFault fault;
  gint64 low = 0, high = 0;
  arv_camera_get_integer_bounds(camera, "GevSCPSPacketSize", &low, &high, fault.out());
  const gint64 step = arv_camera_get_integer_increment(camera, "GevSCPSPacketSize", fault.out());
  if (fault) return refused(settings, "a question for its packet size", fault);
  constexpr gint64 largest = 65535;  // of a UDP datagram
  return SizeRange{static_cast<int>(std::clamp<gint64>(low, 0, largest)),
                   static_cast<int>(std::clamp<gint64>(high, 0, largest)),
                   static_cast<int>(std::clamp<gint64>(step, 1, largest))};
}

/// One that was set by another program is set back to 0.
Status set_delay(ArvCamera* camera, const CameraSettings& settings, double delay_us) {
  GFault fault;
  arv_camera_gv_set_packet_delay(camera, std::llround(delay_us * ns_per_us), fault.out());
  const double taken_us = static_cast<double>(arv_camera_gv_get_packet_delay(camera, fault.out())) / ns_per_us;
  if (fault && delay_us == 0) return {};  // it has none
  const std::string text = "a pause of " + say(delay_us) + " us between packets";
  if (fault) return refused(settings, text, fault);
  if (std::abs(taken_us - delay_us) <= delay_tolerance_us) return {};
  return error(settings, "took " + say(taken_us) + " us for " + text, "set packet_delay_us to what it takes");
}

Status set_packets(ArvCamera* camera, const CameraSettings& settings, const StreamPackets& packets) {
  GFault fault;
  arv_camera_gv_set_packet_size(camera, packets.bytes, fault.out());
  if (fault) return refused(settings, "packets of " + std::to_string(packets.bytes) + " bytes", fault);
  return set_delay(camera, settings, packets.delay_us);
}

/// How many test frames arrive complete. Error: what the camera refuses on the way.
Result<int> try_packets(ArvCamera* camera, const CameraSettings& settings, const AppliedSettings& applied,
                        const StreamPackets& packets) {
  if (Status set = set_packets(camera, settings, packets); !set) return tl::unexpected(set.error());
  GFault fault, stop_fault;
  const double exposure_s = std::clamp(test_exposure_s, applied.shortest_s, applied.longest_s);
  arv_camera_set_exposure_time(camera, exposure_s * us_per_s, fault.out());
  if (fault) return refused(settings, "an exposure of " + say(exposure_s) + " s", fault);
  Result<AravisStream> stream = AravisStream::start(camera, settings, applied);
  if (!stream) return tl::unexpected(stream.error());
  int complete = 0;
  for (int frame = 0; frame < frames_per_try; ++frame) {
    arv_camera_software_trigger(camera, fault.out());
    if (fault) break;
    const AravisStream::Arrival arrival = stream->next(exposure_s + settings.readout_s + watchdog_s);
    if (arrival.image) ++complete;
    if (!arrival.came || (frame > 0 && complete == 0)) break;
  }
  arv_camera_stop_acquisition(camera, stop_fault.out());
  if (fault) return refused(settings, "a software trigger", fault);
  if (stop_fault) return refused(settings, "a stop of the acquisition", stop_fault);
  return complete;
}

Result<StreamPackets> find(ArvCamera* camera, const CameraSettings& settings, const AppliedSettings& applied,
                           const SizeRange& range) {
  std::optional<Error> refusal;  // others may be taken
  const auto ask = [&](const StreamPackets& packets) {
    const Result<int> complete = try_packets(camera, settings, applied, packets);
    if (!complete) refusal = complete.error();
    return complete.value_or(0);
  };
  const std::optional<StreamPackets> found = find_packets(range.low, range.high, range.step, ask);
  if (found) return *found;
  if (refusal) return tl::unexpected(*refusal);
  return error(
      settings, "no frame arrives complete, whatever the size of its packets",
      "check cable, firewall and its exposure, raise net.core.rmem_max to 8 MiB, or set packet_bytes yourself");
}

}  // namespace

Result<StreamPackets> choose_packets(ArvCamera* camera, const CameraSettings& settings, const AppliedSettings& applied,
                                     const std::string& name) {
  const Result<SizeRange> range = size_range(camera, settings);
  if (!range) return tl::unexpected(range.error());
  if (settings.packet_bytes != 0 && settings.packet_bytes < range->low)
    return error(settings, "a packet of " + std::to_string(settings.packet_bytes) + " bytes is too small",
                 "set packet_bytes to " + std::to_string(range->low) + " or more");
  StreamPackets packets{0, settings.packet_delay_us};
  if (settings.packet_bytes != 0) {
    const int cut = std::min(settings.packet_bytes, range->high);
    packets.bytes = range->low + (cut - range->low) / range->step * range->step;
  }

  // Creating the stream sends a test packet where the camera can.
  const bool is_given = settings.packet_bytes != 0;
  arv_camera_gv_set_packet_size_adjustment(
      camera, is_given ? ARV_GV_PACKET_SIZE_ADJUSTMENT_ON_FAILURE : ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  if (!is_given) {
    const std::optional<StreamPackets> known = remembered_packets(name);
    const Result<StreamPackets> found = known ? *known : find(camera, settings, applied, *range);
    if (!found) return found;
    packets = *found;
    remember_packets(name, packets);
  }
  if (Status set = set_packets(camera, settings, packets); !set) return tl::unexpected(set.error());
  return packets;
}

}  // namespace lumifield
