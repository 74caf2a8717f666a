#include "acquisition/scan/reference_drift.h"

#include <algorithm>
#include <cmath>

#include "acquisition/scan/wording.h"

namespace lumifield {

namespace {

constexpr double most_saturated_share = 0.001;
constexpr double same_exposure = 1e-3;  // cameras round to their line time

double saturated_share(const RawImage& image, double saturation_dn) {
  const auto count = std::count_if(image.dn.begin(), image.dn.end(), [&](auto dn) { return dn >= saturation_dn; });
  return static_cast<double>(count) / static_cast<double>(image.dn.size());
}

struct Signal {
  double dn = 0, standard_error_dn = 0;
};

Signal mean_difference(const RawImage& lit, const RawImage& dark) {
  double sum = 0, squares = 0;
  for (std::size_t p = 0; p < lit.dn.size(); ++p) {
    const double d = static_cast<double>(lit.dn[p]) - static_cast<double>(dark.dn[p]);
    sum += d;
    squares += d * d;
  }
  const auto n = static_cast<double>(lit.dn.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

}  // namespace

Result<ReferenceReading> ReferenceDrift::read(const Bracket& lit, const Bracket& dark, double saturation_dn,
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
    if (saturated_share(lit[e], saturation_dn) < most_saturated_share) exposure_ = e;
  if (!exposure_)
    return fail("every exposure saturates: " + say(100 * saturated_share(lit[0], saturation_dn)) +
                    " % of the pixels at " + say(lit[0].exposure_s) + " s, less than " +
                    say(100 * most_saturated_share) + " % are needed",
                "reference cell", "add a shorter exposure to the plan or name a darker reference cell");

  // Compare with the first visit.
  const RawImage& image = lit[*exposure_];
  const Signal signal = mean_difference(image, dark[*exposure_]);
  if (first && !(signal.dn > 5 * signal.standard_error_dn)) {
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
