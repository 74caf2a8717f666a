#include "acquisition/cameras/aravis_stream.h"

#include <algorithm>
#include <arv.h>
#include <chrono>

namespace lumifield {
namespace {

constexpr int buffers = 4;
constexpr int socket_bytes = 8 << 20;  // the kernel cuts it to net.core.rmem_max
constexpr double us_per_s = 1e6;

}  // namespace

void AravisStream::Unref::operator()(ArvStream* stream) const { g_object_unref(stream); }

Result<AravisStream> AravisStream::start(ArvCamera* camera, const CameraSettings& settings,
                                         const AppliedSettings& applied) {
  GFault fault;
  const guint payload = arv_camera_get_payload(camera, fault.out());
  if (fault) return refused(settings, "a question for its frame size", fault);
  if (payload < applied.frame_bytes() || payload > 2 * applied.frame_bytes() + (1 << 20))
    return fail("announces frames of " + std::to_string(payload) + " bytes", "camera " + settings.address,
                "switch chunk data off in the camera");

  AravisStream stream(applied);
  stream.stream_.reset(arv_camera_create_stream(camera, nullptr, nullptr, fault.out()));
  if (!stream.stream_) return refused(settings, "a stream", fault);
  if (ARV_IS_GV_STREAM(stream.stream_.get()))
    g_object_set(stream.stream_.get(), "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 socket_bytes, nullptr);
  for (int i = 0; i < buffers; ++i) arv_stream_push_buffer(stream.stream_.get(), arv_buffer_new(payload, nullptr));
  arv_camera_start_acquisition(camera, fault.out());
  if (fault) return refused(settings, "a start of the acquisition", fault);
  return stream;
}

AravisStream::Arrival AravisStream::next(double wait_s) {
  ArvBuffer* const buffer = next_buffer(wait_s);
  if (buffer == nullptr) return {};
  Arrival arrival{true, image_of(buffer)};
  arv_stream_push_buffer(stream_.get(), buffer);
  return arrival;
}

void AravisStream::drop_arrived() {
  while (ArvBuffer* const buffer = next_buffer(0)) arv_stream_push_buffer(stream_.get(), buffer);
}

/// The next new buffer, complete or not; null when none comes in `wait_s`.
ArvBuffer* AravisStream::next_buffer(double wait_s) {
  using Seconds = std::chrono::duration<double>;
  const auto deadline = std::chrono::steady_clock::now() + Seconds(wait_s);
  while (true) {
    const double left_s = Seconds(deadline - std::chrono::steady_clock::now()).count();
    ArvBuffer* const buffer =
        left_s > 0 ? arv_stream_timeout_pop_buffer(stream_.get(), static_cast<guint64>(left_s * us_per_s))
                   : arv_stream_try_pop_buffer(stream_.get());
    if (buffer == nullptr) return nullptr;
    const std::uint64_t id = arv_buffer_get_frame_id(buffer);
    if (id != last_frame_id_) {
      last_frame_id_ = id;
      frames_due_ = std::max(0, frames_due_ - 1);
      return buffer;
    }
    arv_stream_push_buffer(stream_.get(), buffer);  // sent twice
  }
}

std::optional<RawImage> AravisStream::image_of(ArvBuffer* buffer) const {
  if (arv_buffer_get_status(buffer) != ARV_BUFFER_STATUS_SUCCESS) return std::nullopt;
  if (arv_buffer_get_payload_type(buffer) != ARV_BUFFER_PAYLOAD_TYPE_IMAGE ||
      arv_buffer_get_image_pixel_format(buffer) != applied_.format ||
      arv_buffer_get_image_width(buffer) != applied_.width_px ||
      arv_buffer_get_image_height(buffer) != applied_.height_px)
    return std::nullopt;
  std::size_t size = 0;
  const auto* bytes = static_cast<const std::uint8_t*>(arv_buffer_get_data(buffer, &size));
  if (size < applied_.frame_bytes()) return std::nullopt;

  RawImage image;
  image.width_px = applied_.width_px;
  image.height_px = applied_.height_px;
  image.bits = applied_.layout.bits;
  image.pattern = applied_.layout.pattern;
  image.dn = unpack({bytes, size}, applied_.width_px, applied_.height_px, applied_.layout);
  image.gain = applied_.gain_db;
  image.frame_id = arv_buffer_get_frame_id(buffer);
  return image;
}

}  // namespace lumifield
