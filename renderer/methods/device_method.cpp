#include "renderer/methods/device_method.h"

#include "renderer/methods/closed_form_evaluation.h"
#include "renderer/methods/far_field_device.h"
#include "renderer/methods/host_evaluation.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/image_sampler_device.h"
#include "renderer/methods/precomputed_lights_device.h"

namespace lumifield {

namespace {

template <class Device>
Result<std::unique_ptr<DeviceMethod>> as_method(Result<std::unique_ptr<Device>> device) {
  if (!device) return tl::unexpected(device.error());
  return std::move(*device);
}

}  // namespace

tl::unexpected<Error> no_cells() { return fail("there are none", "cells", "set the luminaire's cells first"); }

Result<std::unique_ptr<DeviceMethod>> make_device_method(const LuminaireGeometry& geometry,
                                                         const MethodSettings& settings) {
  if (const Status good = check_settings(settings); !good) return tl::unexpected(good.error());
  const bool on_host = settings.method == Method::reference;
  if (!on_host && (settings.inversion != Inversion::secant || settings.depth != whole_depth))
    return fail("the kernels search by secant, to the end", "inversion and depth", "take the method's host form");
  switch (settings.method) {
    case Method::closed_form:
      return as_method(ClosedFormEvaluation::create(geometry, settings));
    case Method::position_dependent:
    case Method::position_dependent_printed:
    case Method::uniform_box:
      return as_method(ImageSamplerDevice::create(geometry, settings));
    case Method::precomputed_lights:
      return as_method(PrecomputedLightsDevice::create(geometry, settings));
    case Method::far_field:
      return as_method(FarFieldDevice::create(geometry, settings));
    case Method::reference:
      return std::make_unique<HostEvaluation>(geometry, settings);
  }
  return fail("is none that there is", "method", "choose another");
}

}  // namespace lumifield
