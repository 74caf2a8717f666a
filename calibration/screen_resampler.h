#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/bracket_merge.h"
#include "calibration/lens_model.h"
#include "luminaire/light_field.h"

namespace lumifield {

/// Which photosites carry a channel, and how large a footprint each stands for. In a mono image a photosite stands for
/// its own pixel. In a Bayer image it stands for the 2×2 pixels around its centre: the footprints of R and of B then
/// tile the image, those of G twice, so that every colour covers S completely.
struct PhotositeSet {
  SensorPattern pattern = SensorPattern::mono;
  int channel = 0;                                                              ///< 0 for mono; R, G, B = 0, 1, 2
  int reach() const { return pattern == SensorPattern::mono ? 1 : 2; }          ///< width of a footprint, px
  double multiplicity() const { return reach() == 2 && channel == 1 ? 2 : 1; }  ///< how often the footprints cover
};
/// Channel of the photosite in a column and row of the sensor.
int photosite_channel(SensorPattern pattern, int column, int row);

/// The corners of all footprints on the plane S: the image points first_px + (i, j), undistorted and met with z = S, in
/// mm of the bench frame. NaN where the camera does not see that plane. Computed once per camera model.
struct ScreenLattice {
  double first_px = 0;
  int columns = 0, rows = 0;
  std::vector<double> x_mm, y_mm;  ///< row-major
};
ScreenLattice trace_lattice(const LensModel& lens, const CameraModel& camera, SensorPattern pattern, double z_mm);

/// Sparse weights of one channel: photosites whose footprint overlaps a pixel of S, by pixel of S, with the overlapped
/// area in pixels of S.
struct OverlapWeights {
  std::vector<std::uint32_t> first;  ///< pixels of S + 1
  std::vector<std::uint32_t> photosite;
  std::vector<float> area;
  double smallest_coverage = 0;  ///< least share of a pixel of S that footprints cover
};

/// Clips every footprint against the pixels of S, exactly. `displacement_mm`: where the luminaire frame stands in the
/// bench frame, s = s_bench − displacement. Deterministic.
OverlapWeights overlap_weights(const ScreenLattice& lattice, const PhotositeSet& set, const Measurement& screen,
                               const Vec2& displacement_mm);

/// The photosites of each sensor row that any of the weights refer to.
std::vector<RowSpan> photosite_rows(std::span<const OverlapWeights> weights, int width_px, int height_px);

/// One channel on S. value = Σ w E/Σ w over the valid photosites, variance = Σ w² var/(Σ w)². Where less than half of
/// what covers a pixel is valid, all photosites count instead: the value is then the best estimate there is,
/// understated (see PhotositeSignal), and its variance takes their standard deviations as fully correlated.
struct ScreenChannel {
  std::vector<float> value, variance;
  std::vector<float> valid_share;  ///< Σ w of valid photosites / Σ w
  std::vector<float> electrons;    ///< mean signal of the longest exposure
};
ScreenChannel resample(const OverlapWeights& weights, std::span<const PhotositeSignal> photosites);

}  // namespace lumifield
