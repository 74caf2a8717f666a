#include "renderer/methods/device_method.h"

#include "luminaire/dataset.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/far_field_device.h"
#include "renderer/methods/filtered_brdf_device.h"
#include "renderer/methods/host_evaluation.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/image_sampler_device.h"
#include "renderer/methods/mis_device.h"
#include "renderer/methods/precomputed_lights_device.h"
#include "renderer/methods/summed_evaluation.h"
#include "renderer/shift_invariant/shift_invariant_device.h"

namespace lumifield {

Status DeviceMethod::check_receiver(const Receiver&) const { return {}; }

Status DeviceMethod::set_cells(const LightField& light_field) {
  has_cells_ = begun_ = false;
  if (const auto difference = first_difference(light_field.geometry(), geometry_))
    return fail("the cells are of another luminaire: its " + *difference, "method", "make the method for it");
  forget();
  const Status taken = take_cells(light_field);
  has_cells_ = taken.has_value();
  return taken;
}

Status check_finite(std::span<const Receiver> receivers) {
  for (std::size_t k = 0; k < receivers.size(); ++k)
    if (!receivers[k].p_mm.allFinite() || !receivers[k].n.allFinite())
      return fail("has NaN or Inf", "receiver " + std::to_string(k), "give finite numbers");
  return {};
}

Status DeviceMethod::set_receivers(std::span<const Receiver> receivers, Appearance appearance) {
  if (receivers.size() > std::size_t(1) << 30) return fail("more than 2^30 receivers", "receivers", "render in parts");
  if (const Status finite = check_finite(receivers); !finite) return finite;
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    const Receiver& r = receivers[k];
    if (!(r.p_mm.z() > 0) || r.n == Vec3(0, 0, 0)) continue;
    if (const Status good = check_receiver(r); !good) {
      Error error = good.error();
      error.where += " " + std::to_string(k);
      return tl::unexpected(std::move(error));
    }
  }
  if (const Status good = check_appearance(appearance, TileGrid(geometry_.sampling), receivers.size()); !good)
    return good;
  has_receivers_ = begun_ = false;
  count_ = receivers.size();
  gloss_channels_ = appearance.gloss_channels(channels());
  appearance_ = std::move(appearance);
  const Status taken = take_receivers(receivers);
  has_receivers_ = taken.has_value();
  return taken;
}

Status DeviceMethod::set_samples(double samples, std::uint32_t seed) {
  MethodSettings settings = settings_;
  settings.samples = samples;
  settings.seed = seed;
  if (const Status good = check_settings(settings); !good) return good;
  settings_ = settings;
  begun_ = false;
  forget();
  return {};
}

Status DeviceMethod::check_set() const {
  if (!has_cells_) return fail("has no cells", std::string(to_string(settings_.method)), "set them first");
  if (!has_receivers_) return fail("has no receivers", std::string(to_string(settings_.method)), "set them first");
  return {};
}

Result<bool> DeviceMethod::evaluate(double seconds) {
  if (const Status set = check_set(); !set) return tl::unexpected(set.error());
  if (!begun_)
    if (const Status begins = begin(); !begins) return tl::unexpected(begins.error());
  begun_ = false;  // what is thrown leaves nothing under way
  const auto done = go_on(seconds);
  begun_ = done.has_value();
  return done;
}

Status DeviceMethod::read(std::vector<double>& irradiance) {
  if (const Status set = check_set(); !set) return set;
  irradiance.assign(count_ * channels(), 0.0);
  return begun_ ? read_computed(irradiance) : Status{};
}

Status DeviceMethod::read_gloss(std::vector<double>& radiance) {
  if (const Status set = check_set(); !set) return set;
  radiance.assign(count_ * gloss_channels_, 0.0);
  return begun_ && gloss_channels_ > 0 ? read_gloss_computed(radiance) : Status{};
}

namespace {

template <class Device>
Result<std::unique_ptr<DeviceMethod>> as_method(Result<std::unique_ptr<Device>> device) {
  if (!device) return tl::unexpected(device.error());
  return std::move(*device);
}

Result<std::unique_ptr<DeviceMethod>> closed_form(const LuminaireGeometry& geometry, const MethodSettings& settings) {
  auto sums = ClosedFormDevice::create(geometry);
  if (!sums) return tl::unexpected(sums.error());
  if (Status set = (*sums)->set_lod(settings.lod); !set) return tl::unexpected(set.error());
  return std::make_unique<SummedEvaluation>(geometry, settings, std::move(*sums));
}

Result<std::unique_ptr<DeviceMethod>> shift_invariant(const LuminaireGeometry& geometry,
                                                      const MethodSettings& settings) {
  auto sums = ShiftInvariantDevice::create(geometry, settings.spots);
  if (!sums) return tl::unexpected(sums.error());
  return std::make_unique<SummedEvaluation>(geometry, settings, std::move(*sums));
}

}  // namespace

Result<std::unique_ptr<DeviceMethod>> make_device_method(const LuminaireGeometry& geometry,
                                                         const MethodSettings& settings) {
  if (const Status good = check_settings(settings); !good) return tl::unexpected(good.error());
  switch (settings.method) {
    case Method::closed_form:
      return closed_form(geometry, settings);
    case Method::position_dependent:
    case Method::position_dependent_printed:
    case Method::uniform_box:
      return as_method(ImageSamplerDevice::create(geometry, settings));
    case Method::precomputed_lights:
      return as_method(PrecomputedLightsDevice::create(geometry, settings));
    case Method::filtered_brdf:
      return as_method(FilteredBrdfDevice::create(geometry, settings));
    case Method::mis:
      return as_method(MisDevice::create(geometry, settings));
    case Method::far_field:
      return as_method(FarFieldDevice::create(geometry, settings));
    case Method::shift_invariant:
      return shift_invariant(geometry, settings);
    case Method::reference:
      return std::make_unique<HostEvaluation>(geometry, settings);
  }
  return fail("is none that there is", "method", "choose another");
}

}  // namespace lumifield
