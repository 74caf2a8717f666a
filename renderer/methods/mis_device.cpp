#include "renderer/methods/mis_device.h"

#include <algorithm>

#include "renderer/methods/sampled_cell.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

Result<std::unique_ptr<MisDevice>> MisDevice::create(const LuminaireGeometry& geometry,
                                                     const MethodSettings& settings) {
  std::unique_ptr<MisDevice> made(new MisDevice(geometry, settings));
  if (Status opened = made->open("mis", "mis"); !opened) return tl::unexpected(opened.error());
  return made;
}

/// Beside the images of so many cells.
double MisDevice::further_bytes(std::size_t cells) const {
  return static_cast<double>(cells * tables_.cell_bytes()) + lobe_table_bytes(settings_);
}

/// Images and tables share their rows, so that a pixel has one place.
Status MisDevice::take_cells(const LightField& light_field) {
  tables_ = LightTables(geometry_.measurement, images_.stride());
  if (!tables_.fits())
    return fail("images of this size cannot be sampled", "the luminaire", "use smaller images or fewer cells");
  const std::vector<MeasuredCell> cells = measured_cells(light_field);
  if (Status done = images_.upload(*device_, light_field, settings_, further_bytes(cells.size())); !done) return done;
  tables_.describe(shared_);
  shared_.plane = images_.geometry().plane;
  if (Status room = tables_.make_room(*device_, cells.size()); !room) return room;
  numbers_.clear();
  for (const MeasuredCell& cell : cells) {
    if (Status done = tables_.upload(*device_, numbers_.size(), summed_area_table(cell, importance_image)); !done)
      return done;
    numbers_.push_back(static_cast<int>(cell.number));
  }
  shared_.cells = static_cast<int>(numbers_.size());
  return {};
}

Status MisDevice::make_points() {
  if (Status fits = images_.check_memory(*device_, settings_, further_bytes(numbers_.size())); !fits) return fits;
  const PointSet set(settings_.sequence, settings_.samples, settings_.seed);
  shared_.points = static_cast<int>(set.points().size());
  const MisCounts counts = mis_counts(settings_.samples);
  shares_ = {counts.light, counts.light_beside, counts.light_apart, counts.diffuse, counts.glossy, 0, 0};
  if (Status done = device_->fill(points_, set.points(), "points"); !done) return done;
  const auto fill = [&](DeviceBuffer& buffer, int n, LobeDraws kind, int& table) {
    const std::vector<LobePoint> points = lobe_points(settings_.sequence, n, settings_.seed, kind);
    table = static_cast<int>(points.size());
    return device_->fill(buffer, points, "points");
  };
  if (Status done = fill(diffuse_, counts.diffuse, LobeDraws::diffuse, shares_.diffuse_points); !done) return done;
  if (Status done = fill(glossy_, counts.glossy, LobeDraws::glossy, shares_.glossy_points); !done) return done;
  return device_->fill(cells_, sampling_cells(geometry_.sampling, numbers_, settings_.seed), "cells");
}

double MisDevice::rays_of_a_receiver() const {
  const MisCounts counts = mis_counts(settings_.samples);
  const double diffuse = counts.light + counts.diffuse;
  if (gloss_channels() == 0) return diffuse;
  return std::max(diffuse, counts.light_apart + counts.glossy);
}

unsigned MisDevice::set_arguments(DeviceKernel& kernel) {
  RayGeometry rays = images_.geometry();
  rays.filter = settings_.filter;
  unsigned number = 1;
  kernel.set(number++, rays);
  kernel.set(number++, shares_);
  for (const DeviceBuffer& buffer : {receivers_, cells_, images_.slots(), images_.levels(), images_.images(),
                                     tables_.tables(), tables_.columns(), points_, diffuse_, glossy_, sums_})
    kernel.set(number++, buffer);
  return number;
}

}  // namespace lumifield
