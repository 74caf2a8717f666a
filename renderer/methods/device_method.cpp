#include "renderer/methods/device_method.h"

#include <cmath>

#include "renderer/methods/far_field_device.h"
#include "renderer/methods/host_evaluation.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/image_sampler_device.h"
#include "renderer/methods/precomputed_lights_device.h"

namespace lumifield {

namespace {

/// The closed form in the methods' role. It is additive, so that an evaluation adds all cells again.
class ClosedFormMethod final : public DeviceMethod {
 public:
  static Result<std::unique_ptr<DeviceMethod>> create(const LuminaireGeometry& geometry, double lod) {
    auto device = ClosedFormDevice::create(geometry);
    if (!device) return tl::unexpected(device.error());
    if (Status set = (*device)->set_lod(lod); !set) return tl::unexpected(set.error());
    return std::make_unique<ClosedFormMethod>(geometry, std::move(*device));
  }
  ClosedFormMethod(const LuminaireGeometry& geometry, std::unique_ptr<ClosedFormDevice> device)
      : light_field_(geometry), device_(std::move(device)) {}

  Status set_cells(const LightField& light_field) override {
    if (const Status same = check_same_luminaire(light_field.geometry(), light_field_.geometry()); !same) return same;
    light_field_ = light_field;
    return {};
  }
  Status set_receivers(std::span<const Receiver> receivers) override {
    receivers_.assign(receivers.begin(), receivers.end());
    const Status set = device_->set_receivers(receivers_);
    clear_ = set.has_value();
    return set;
  }
  Status set_samples(double, std::uint32_t) override { return {}; }

  Result<bool> evaluate(double) override {
    std::vector<CellIndex> cells;
    std::vector<std::shared_ptr<const CellImage>> images;
    std::vector<const CellImage*> pointers;
    const Sampling& sampling = light_field_.geometry().sampling;
    for (int flat = 0; flat < sampling.cells(); ++flat) {
      auto image = light_field_.cell(sampling.index(flat));
      if (!image) continue;
      cells.push_back(sampling.index(flat));
      pointers.push_back(image.get());
      images.push_back(std::move(image));
    }
    if (!clear_)
      if (Status cleared = device_->set_receivers(receivers_); !cleared) return tl::unexpected(cleared.error());
    clear_ = false;
    if (Status added = device_->add_cells(cells, pointers); !added) return tl::unexpected(added.error());
    return true;
  }
  Status read(std::vector<double>& irradiance) override { return device_->read(irradiance); }
  std::string device_name() const override { return device_->device_name(); }
  double kernel_s() const override { return device_->last_kernel_s(); }

 private:
  LightField light_field_;
  std::unique_ptr<ClosedFormDevice> device_;
  bool clear_ = false;  ///< the device has the receivers, and no cell in its sums
  std::vector<Receiver> receivers_;
};

template <class Device>
Result<std::unique_ptr<DeviceMethod>> as_method(Result<std::unique_ptr<Device>> device) {
  if (!device) return tl::unexpected(device.error());
  return std::move(*device);
}

}  // namespace

Result<std::unique_ptr<DeviceMethod>> make_device_method(const LuminaireGeometry& geometry,
                                                         const MethodSettings& settings) {
  if (const Status good = check_settings(settings); !good) return tl::unexpected(good.error());
  switch (settings.method) {
    case Method::closed_form:
      return ClosedFormMethod::create(geometry, settings.lod);
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
