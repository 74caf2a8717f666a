#include "renderer/methods/host_method.h"

#include <cmath>
#include <mutex>

#include "renderer/methods/closed_form_tiles.h"
#include "renderer/methods/far_field.h"
#include "renderer/methods/filtered_brdf.h"
#include "renderer/methods/mis.h"
#include "renderer/methods/position_dependent.h"
#include "renderer/methods/position_dependent_printed.h"
#include "renderer/methods/precomputed_lights.h"
#include "renderer/methods/table_memory.h"
#include "renderer/methods/uniform_box.h"
#include "renderer/shift_invariant/shift_invariant.h"

namespace lumifield {

namespace {

/// |C| in place of C: what rounding errors are measured against.
LightField absolute(const LightField& light_field) {
  LightField result(light_field.geometry());
  const Sampling& sampling = light_field.geometry().sampling;
  for (int flat = 0; flat < sampling.cells(); ++flat) {
    const auto image = light_field.cell(sampling.index(flat));
    if (!image) continue;
    CellImage positive{image->width_px, image->height_px, image->channels, image->value, {}, {}};
    for (float& v : positive.value) v = std::abs(v);
    // What was taken once is taken again.
    (void)result.add(sampling.index(flat), std::move(positive));
  }
  return result;
}

/// The closed form in the methods' role; the reference is that without a level of detail.
class ClosedFormOnHost final : public HostMethod {
 public:
  /// finest: looks are divided as finely as can be; else as their lobe asks for.
  ClosedFormOnHost(const LightField& light_field, double lod, bool finest)
      : light_field_(light_field), lod_(lod), finest_(finest), form_(light_field, lod) {}

  using HostMethod::estimate;

  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t, const Look& look) const override {
    if (look.plain()) return form_.irradiance(receiver);
    return form_.light(receiver, look, division(receiver, look));
  }

  /// Rounding, the bound of the level of detail, and what a division in four makes of lobe and shadow, doubled.
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t, const Look& look) const override {
    constexpr double rounding = 1e-10;
    std::call_once(once_, [this] { magnitude_ = std::make_unique<ClosedForm>(absolute(light_field_)); });
    if (look.plain()) {
      Estimate result{form_.irradiance(receiver), magnitude_->irradiance(receiver)};
      const std::vector<double> bound = form_.detail_error_bound(receiver);
      for (std::size_t c = 0; c < bound.size(); ++c)
        result.stated_error[c] = rounding * result.stated_error[c] + bound[c];
      return result;
    }
    const int division = this->division(receiver, look);
    Estimate result{form_.light(receiver, look, division), magnitude_->light(receiver, look, division)};
    const std::vector<double> bound = form_.light_detail_error_bound(receiver, look, division),
                              finer = form_.light(receiver, look, std::max(2 * division, 1));
    for (std::size_t c = 0; c < bound.size(); ++c)
      result.stated_error[c] =
          rounding * result.stated_error[c] + bound[c] + 2 * std::abs(finer[c] - result.irradiance[c]);
    return result;
  }

 private:
  /// Subtiles of a tile: as many as kernels have, or the most.
  int division(const Receiver& receiver, const Look& look) const {
    if (finest_) return most_division;
    return gloss_division(TileGrid(light_field_.geometry().sampling), receiver, look.lobe, light_is_even(look),
                          gloss_tolerance(lod_));
  }

  LightField light_field_;
  double lod_;
  bool finest_;
  ClosedForm form_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<ClosedForm> magnitude_;  ///< of |C|, made when an error is first asked for
};

}  // namespace

namespace {

Status check_spots(const MethodSettings& s) {
  if (s.method != Method::shift_invariant)
    return s.spots == SpotSettings{} ? Status{}
                                     : fail(std::string(to_string(s.method)) + " has none", "spotlights",
                                            "leave them as they are, or use shift-invariant");
  const auto outside = [](int value, int most) { return value < 1 || value > most; };
  if (outside(s.spots.cells_per_pass, most_cells_per_pass))
    return fail("is not between 1 and " + std::to_string(most_cells_per_pass), "cells per pass", "give another");
  if (outside(s.spots.shadow_texels, most_shadow_texels))
    return fail("is not between 1 and " + std::to_string(most_shadow_texels), "texels of a shadow test",
                "give another");
  if (outside(s.spots.shadow_map_px, most_shadow_map_px))
    return fail("is not between 1 and " + std::to_string(most_shadow_map_px), "texels of a shadow map", "give another");
  return {};
}

}  // namespace

Status check_settings(const MethodSettings& s) {
  // What that many lights or points of light samples take is some hundred megabytes; directions, which take more, are
  // counted with the tables (table_memory.h).
  if (s.method == Method::precomputed_lights && !(s.samples >= 1 && s.samples <= most_lights))
    return fail("is not between 1 and 4 million", "number of lights", "give another");
  if (!(s.samples >= 1 && s.samples <= most_samples))
    return fail("is not between 1 and 10 million", "number of samples", "give another");
  if (!(s.k_max >= 0 && std::isfinite(s.k_max))) return fail("is negative or not finite", "k_max", "give 0 for none");
  if (!(s.lod == 0 || (s.lod >= least_lod && std::isfinite(s.lod))))
    return fail("is neither 0 nor at least 1", "level of detail", "give the pixels per support, or 0 for all");
  if (s.depth < 1) return fail("is less than 1", "depth of the search", "give more");
  if (!(s.memory_bytes >= 0))
    return fail("is negative or NaN", "memory for tables", "give 0 for half of what there is");
  if (const Status good = check_spots(s); !good) return good;
  // Of a method that has no use for them they are refused, not ignored.
  if (!s.filter && !averages_light(s.method))
    return fail(std::string(to_string(s.method)) + " averages no light", "filter", "leave it, or use filtered-brdf");
  if (s.method == Method::position_dependent || s.method == Method::position_dependent_printed) return {};
  const std::string has_none = std::string(to_string(s.method)) + " has none";
  const std::string remedy = "leave it as it is, or use position-dependent";
  if (s.k_max > 0) return fail(has_none + ": its cells get no samples by their light", "k_max", remedy);
  if (s.inversion != Inversion::secant) return fail(has_none + ": it searches no cdf", "inversion", remedy);
  if (s.depth != whole_depth) return fail(has_none + ": it searches no cdf", "depth of the search", remedy);
  return {};
}

Result<std::unique_ptr<HostMethod>> make_host_method(const LightField& light_field, const MethodSettings& settings) {
  if (const Status good = check_settings(settings); !good) return tl::unexpected(good.error());
  const double bytes = host_table_bytes(light_field.geometry(), settings, light_field.coverage().measured);
  if (const Status fits = check_table_memory(settings, bytes, host_memory_bytes()); !fits)
    return tl::unexpected(fits.error());
  switch (settings.method) {
    case Method::closed_form:
      return std::make_unique<ClosedFormOnHost>(light_field, settings.lod, false);
    case Method::reference:
      return std::make_unique<ClosedFormOnHost>(light_field, 0, true);
    case Method::position_dependent:
      return std::make_unique<PositionDependent>(light_field, settings);
    case Method::position_dependent_printed:
      return PositionDependentPrinted::create(light_field, settings);
    case Method::uniform_box:
      return std::make_unique<UniformBox>(light_field, settings);
    case Method::precomputed_lights:
      return std::make_unique<PrecomputedLights>(light_field, settings);
    case Method::filtered_brdf:
      return std::make_unique<FilteredBrdf>(light_field, settings);
    case Method::mis:
      return std::make_unique<Mis>(light_field, settings);
    case Method::far_field:
      return FarField::create(light_field, settings);
    case Method::shift_invariant:
      return std::make_unique<ShiftInvariant>(light_field, settings.spots);
  }
  return fail("is none that there is", "method", "choose another");
}

}  // namespace lumifield
