#pragma once

#include <memory>

#include "luminaire/bench.h"
#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "luminaire/plan.h"
#include "luminaire/raw_image.h"

namespace lumifield {

/// Geometry of the luminaire that a bench and a plan make: channels Y, or R G B for a Bayer pixel format; radiance when
/// the responsivity is on record (value, date and source), else relative.
LuminaireGeometry luminaire_geometry(const Bench& bench, const Plan& plan);

/// Makes RawImages metric: from the brackets of one cell to its C_m on S, in L-units per mm², with variance.
///
/// dark set subtracted per exposure and pixel → saturated pixels dropped → bracket merged by noise-weighted mean in
/// absolute units → divided by responsivity, relative illumination and exposure: irradiance E on the screen, W/m² →
/// resampled onto the pixels of S by area overlap, each colour from its own photosites → passes combined,
/// C = Σ scale·E/(a_x a_y). A pass with a dark set of its own has that subtracted. Nothing is normalised per image.
/// Where the stage carries the lamp, S moves with it.
///
/// Values are finite and may be negative. A pixel of S of which less than half is seen by photosites with an
/// unsaturated exposure takes what the shortest exposure says, a lower bound, with that exposure's full scale (about
/// the value itself) as its standard deviation, and counts in saturated_share. Without a dark set the black level is
/// subtracted, and a warning says so. Neighbouring pixels that share photosites have correlated noise; the variance is
/// that of each alone.
///
/// Pure but for its cached resampling weights. Thread-bound (the develop thread).
class Developer {
 public:
  /// Refuses: a camera that does not see all of S, carrying the lamp from every planned position; a responsivity count
  /// that does not fit the channels; numbers that are not finite or of the wrong sign; sensors above 32 Mpx, images
  /// above 16 Mpx.
  static Result<Developer> create(const Bench& bench, const Plan& plan);
  ~Developer();
  Developer(Developer&&) noexcept;
  Developer& operator=(Developer&&) noexcept;

  const LuminaireGeometry& geometry() const;

  /// Refuses a frame of another size or pattern than the camera model's, or without its dark exposures; passes other
  /// than the bench's, in its order; a stage reading from which the camera does not see all of S.
  Result<CellImage> develop(const RawCell& raw);

 private:
  struct Impl;
  explicit Developer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
