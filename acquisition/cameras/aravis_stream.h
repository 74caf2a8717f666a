#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "acquisition/cameras/aravis_settings.h"
#include "luminaire/raw_image.h"

typedef struct _ArvBuffer ArvBuffer;
typedef struct _ArvStream ArvStream;

namespace lumifield {

/// The frames that a camera sends, each handed out once. A frame counts when it is complete and of the format and size
/// that the camera took. Thread-bound; the camera outlives it.
class AravisStream {
 public:
  /// What came within a wait.
  struct Arrival {
    bool came = false;              ///< a frame, complete or not
    std::optional<RawImage> image;  ///< when complete; without its exposure time, which the camera knows
  };

  /// Makes the stream and starts the acquisition. Errors: frames of another size than the settings', no stream.
  static Result<AravisStream> start(ArvCamera* camera, const CameraSettings& settings, const AppliedSettings& applied);

  /// A trigger was sent, or may have been carried out once more: one more frame is due.
  void expect_frame() { ++frames_due_; }
  /// Triggered, and not come yet. One of them may come at any time, as the answer to a later trigger: only another
  /// stream, begun after the acquisition stood still, is safe from it.
  int frames_due() const { return frames_due_; }
  /// The next new frame, waited for `wait_s`.
  Arrival next(double wait_s);
  /// Passes over all frames so far.
  void drop_arrived();

 private:
  struct Unref {
    void operator()(ArvStream* stream) const;
  };
  explicit AravisStream(const AppliedSettings& applied) : applied_(applied) {}
  ArvBuffer* next_buffer(double wait_s);
  std::optional<RawImage> image_of(ArvBuffer* buffer) const;

  std::unique_ptr<ArvStream, Unref> stream_;
  AppliedSettings applied_;
  int frames_due_ = 0;
  std::optional<std::uint64_t> last_frame_id_;
};

}  // namespace lumifield
