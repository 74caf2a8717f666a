#pragma once

#include <QImage>
#include <QString>
#include <cstdint>
#include <memory>

#include "app/views/histogram_view.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// How the photosites are shown: each as it is, or blocks of 2 × 2 as one colour pixel without white balance.
enum class CameraColours { photosites, blocks };

/// One frame made ready to be shown.
struct CameraPicture {
  std::shared_ptr<const Bracket> bracket;  ///< keeps the frame alive
  std::size_t exposure = 0;                ///< which of the bracket
  int step = 1;                            ///< photosites per image pixel and axis
  QImage image;                            ///< DN 0 … full scale as linear light, in sRGB
  QImage mask;                             ///< opaque red where over-exposed; null when nothing is
  std::uint64_t saturated = 0;             ///< photosites at or above saturation
  double saturated_share = 0;              ///< of all photosites
  Histogram histogram;                     ///< of all photosites, DN

  const RawImage& raw() const { return (*bracket)[exposure]; }
};

/// `exposure` lies within the bracket. A mono frame is shown photosite by photosite. Reentrant.
CameraPicture make_camera_picture(std::shared_ptr<const Bracket> bracket, std::size_t exposure, double saturation_dn,
                                  CameraColours colours);

/// What stands at a pixel of the picture: "column 12, row 7: 1234 DN", with the photosite's colour, or the block's.
/// Empty outside.
QString pixel_text(const CameraPicture& picture, int column, int row);

/// "128 ms", "1.5 s".
QString exposure_text(double exposure_s);

}  // namespace lumifield
