#include "renderer/methods/filtered_brdf_device.h"

#include "renderer/methods/lobe_sampling.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

Result<std::unique_ptr<FilteredBrdfDevice>> FilteredBrdfDevice::create(const LuminaireGeometry& geometry,
                                                                       const MethodSettings& settings) {
  std::unique_ptr<FilteredBrdfDevice> made(new FilteredBrdfDevice(geometry, settings));
  if (Status opened = made->open("filtered_brdf", "filtered_brdf"); !opened) return tl::unexpected(opened.error());
  return made;
}

Status FilteredBrdfDevice::take_cells(const LightField& light_field) {
  return images_.upload(*device_, light_field, settings_, lobe_table_bytes(settings_));
}

Status FilteredBrdfDevice::make_points() {
  if (Status fits = images_.check_memory(*device_, settings_, lobe_table_bytes(settings_)); !fits) return fits;
  const int n = whole_samples(settings_.samples);
  for (const auto& [kind, buffer] : {std::pair(LobeDraws::diffuse, &diffuse_), {LobeDraws::glossy, &glossy_}}) {
    const std::vector<LobePoint> points = lobe_points(settings_.sequence, n, settings_.seed, kind);
    points_ = points.size();
    if (Status done = device_->fill(*buffer, points, "points"); !done) return done;
  }
  return {};
}

/// Of the diffuse part, and of the lobe where there are any.
double FilteredBrdfDevice::rays_of_a_receiver() const {
  return (gloss_channels() > 0 ? 2.0 : 1.0) * whole_samples(settings_.samples);
}

unsigned FilteredBrdfDevice::set_arguments(DeviceKernel& kernel) {
  RayGeometry rays = images_.geometry();
  rays.samples = whole_samples(settings_.samples);
  rays.points = static_cast<int>(points_);
  rays.filter = settings_.filter;
  unsigned number = 1;
  kernel.set(number++, rays);
  for (const DeviceBuffer& buffer :
       {receivers_, images_.slots(), images_.levels(), images_.images(), diffuse_, glossy_, sums_})
    kernel.set(number++, buffer);
  return number;
}

}  // namespace lumifield
