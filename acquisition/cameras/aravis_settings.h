#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/cameras/pixel_layout.h"
#include "luminaire/bench.h"
#include "luminaire/error.h"

typedef struct _ArvCamera ArvCamera;
typedef struct _GError GError;

namespace lumifield {

/// The GError of the calls that it is handed to; the first one stays. Thread-bound.
class GFault {
 public:
  GFault() = default;
  ~GFault();
  GFault(const GFault&) = delete;
  GFault& operator=(const GFault&) = delete;

  GError** out() { return error_ == nullptr ? &error_ : nullptr; }
  explicit operator bool() const { return error_ != nullptr; }
  std::string text() const;

 private:
  GError* error_ = nullptr;
};

/// Names that Aravis hands over to be freed; null: none.
std::vector<std::string> take_names(const char** names, unsigned count);

/// What a camera took, read back from it. Value type.
struct AppliedSettings {
  PixelLayout layout;
  std::uint32_t format = 0;  ///< PFNC code of the pixel format
  int width_px = 0, height_px = 0;
  double gain_db = 0;                    ///< of frames: set_aravis_gain
  double shortest_s = 0, longest_s = 0;  ///< exposure range

  std::size_t frame_bytes() const {
    return layout.frame_bytes(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px));
  }
};

/// Those of its pixel formats that can be measured with, in its order.
Result<std::vector<std::string>> usable_pixel_formats(ArvCamera* camera, const CameraSettings& settings);

/// That the camera offers the pixel format and the binning, as far as can be told without setting anything.
Status check_offered(ArvCamera* camera, const CameraSettings& settings);

/// Sets mirrors off, pixel format, binning, full region, automatics off (aravis_automatics.h), gain (aravis_gain.h) and
/// software trigger, and reads them back. Errors: a value that the camera does not offer, with those it does; one that
/// it took otherwise.
Result<AppliedSettings> apply_settings(ArvCamera* camera, const CameraSettings& settings);

/// "camera does not take WHAT (its own words)".
tl::unexpected<Error> refused(const CameraSettings& settings, const std::string& what, const GFault& fault);

std::string text_or_empty(const char* text);

}  // namespace lumifield
