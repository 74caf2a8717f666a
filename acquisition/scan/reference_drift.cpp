#include "acquisition/scan/reference_drift.h"

#include <cmath>

#include "acquisition/scan/frame_signal.h"
#include "luminaire/wording.h"

namespace lumifield {

namespace {

constexpr double most_saturated_share = 0.001;
constexpr double same_exposure = 1e-3;  // cameras round to their line time

}  // namespace

Result<ReferenceReading> ReferenceDrift::read(const Bracket& lit, std::span<const RawImage> dark, double saturation_dn,
                                              int cells_done) {
  // Check that every frame has its dark frame.
  bool fits = !lit.empty() && lit.size() == dark.size();
  for (std::size_t e = 0; fits && e < lit.size(); ++e)
    fits = !lit[e].dn.empty() && lit[e].dn.size() == dark[e].dn.size() && lit[e].exposure_s > 0;
  if (!fits)
    return fail("its frames do not fit the dark set's", "reference cell", "close other programs that set the camera");

  // Take the exposure that the earlier scan chose.
  for (std::size_t e = 0; !exposure_ && earlier_exposure_s_ && e < lit.size(); ++e)
    if (std::abs(lit[e].exposure_s / *earlier_exposure_s_ - 1) < same_exposure) exposure_ = e;
  if (!exposure_ && earlier_exposure_s_)
    return fail("no exposure of " + say(*earlier_exposure_s_) + " s, at which the dataset's first reading was taken",
                "reference cell", "resume with the exposures it was begun with");

  // Choose the longest exposure that does not saturate, once.
  const bool first = !exposure_;
  for (std::size_t e = 0; first && e < lit.size(); ++e)
    if (share_from(lit[e], saturation_dn) < most_saturated_share) exposure_ = e;
  if (!exposure_)
    return fail("every exposure saturates: " + say(100 * share_from(lit[0], saturation_dn)) + " % of the pixels at " +
                    say(lit[0].exposure_s) + " s, less than " + say(100 * most_saturated_share) + " % are needed",
                "reference cell", "add a shorter exposure to the plan or name a darker reference cell");

  // Compare with the first visit.
  const RawImage& image = lit[*exposure_];
  const FrameSignal signal = mean_difference(image, dark[*exposure_]);
  if (first && !is_light(signal)) {
    exposure_.reset();
    return fail("no light above the dark set: " + say(signal.dn) + " DN on average at " + say(image.exposure_s) + " s",
                "reference cell", "check that the lamp is on and the lens open, or name a brighter reference cell");
  }
  const double dn_per_s = signal.dn / image.exposure_s;
  if (first) first_dn_per_s_ = dn_per_s;
  drift_ = dn_per_s / first_dn_per_s_ - 1;
  return ReferenceReading{cells_done, dn_per_s, drift_, image.exposure_s};
}

}  // namespace lumifield
