#include "renderer/methods/image_sampler_device.h"

#include <cmath>

#include "renderer/methods/position_dependent_printed.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

Status refused(const char* what) { return fail(what, "the luminaire", "use smaller images or fewer cells"); }

}  // namespace

Result<std::unique_ptr<ImageSamplerDevice>> ImageSamplerDevice::create(const LuminaireGeometry& geometry,
                                                                       const MethodSettings& settings,
                                                                       SamplingSteps steps, bool plain) {
  std::unique_ptr<ImageSamplerDevice> made(new ImageSamplerDevice(geometry, settings));
  const auto width = static_cast<std::size_t>(geometry.measurement.width_px);
  const auto height = static_cast<std::size_t>(geometry.measurement.height_px);
  const std::size_t stride = LightTables::padded(width);
  made->tables_ = LightTables(geometry.measurement, stride);
  if (!made->tables_.fits() || stride * height * geometry.channels.size() >= std::size_t(1) << 31)
    return tl::unexpected(refused("images of this size cannot be sampled").error());
  made->tables_.describe(made->shared_);
  made->shared_.plane = static_cast<int>(stride * height);

  std::string source = "uniform_box", defines;
  if (settings.method == Method::position_dependent) {
    source = "position_dependent";
    defines = "-DSTEPS=" + std::to_string(static_cast<int>(steps)) + (plain ? " -DPLAIN=1" : "");
  } else if (settings.method == Method::position_dependent_printed) {
    source = "position_dependent_printed";
  }
  if (Status opened = made->open(source, source, defines); !opened) return tl::unexpected(opened.error());
  return made;
}

/// The tables are of no use to uniform samples.
Status ImageSamplerDevice::make_room(std::size_t cells) {
  const auto bytes = [&](int numbers, std::size_t size) { return cells * static_cast<std::size_t>(numbers) * size; };
  const bool drawn = settings_.method != Method::uniform_box;
  const bool printed = settings_.method == Method::position_dependent_printed;
  const std::size_t images = bytes(shared_.plane, channels() * sizeof(float));
  const std::size_t marginals = printed ? bytes(shared_.stride, sizeof(double)) : 0;
  const std::size_t all = images + marginals + (drawn ? cells * tables_.cell_bytes() : 0);
  if (const Status fits =
          check_table_memory(settings_, static_cast<double>(all), static_cast<double>(device_->memory_bytes()));
      !fits)
    return fits;
  if (Status room = device_->make_room(images_, images, "images"); !room) return room;
  if (printed)
    if (Status room = device_->make_room(marginals_, marginals, "marginals"); !room) return room;
  return drawn ? tables_.make_room(*device_, cells) : Status{};
}

Status ImageSamplerDevice::take_cells(const LightField& light_field) {
  const bool printed = settings_.method == Method::position_dependent_printed;
  if (printed)
    if (const Status good = check_printed_luminaire(light_field); !good) return good;
  const std::vector<MeasuredCell> cells = measured_cells(light_field);
  if (const Status room = make_room(cells.size()); !room) return room;
  numbers_.clear();
  for (const MeasuredCell& cell : cells) {
    const std::size_t m = numbers_.size();
    if (Status done = upload_image(m, *cell.image); !done) return done;
    if (settings_.method != Method::uniform_box)
      if (Status done = upload_tables(m, summed_area_table(cell, printed ? luminance_image : importance_image)); !done)
        return done;
    numbers_.push_back(static_cast<int>(cell.number));
  }
  shared_.cells = static_cast<int>(numbers_.size());
  return {};
}

Status ImageSamplerDevice::upload_image(std::size_t m, const CellImage& cell) {
  const auto width = static_cast<std::size_t>(shared_.width), height = static_cast<std::size_t>(shared_.height);
  const auto stride = static_cast<std::size_t>(shared_.stride), plane = static_cast<std::size_t>(shared_.plane);
  std::vector<float> image(plane * channels(), 0.0F);
  for (std::size_t c = 0; c < channels(); ++c)
    for (std::size_t j = 0; j < height; ++j)
      std::copy_n(cell.channel(static_cast<int>(c)) + j * width, width, image.data() + c * plane + j * stride);
  return device_->write(images_, m * image.size() * sizeof(float), std::as_bytes(std::span(image)));
}

Status ImageSamplerDevice::upload_tables(std::size_t m, const SummedAreaTable& importance) {
  if (Status done = tables_.upload(*device_, m, importance); !done) return done;
  if (settings_.method != Method::position_dependent_printed) return {};
  std::vector<double> marginal(static_cast<std::size_t>(shared_.stride), 0.0);
  for (int i = 0; i < shared_.width; ++i)
    marginal[static_cast<std::size_t>(i) + 1] = importance.corner(i + 1, shared_.height);
  return device_->write(marginals_, m * marginal.size() * sizeof(double), std::as_bytes(std::span(marginal)));
}

/// The sequence, and each cell's rotation of it; as printed, one for all.
Status ImageSamplerDevice::make_points() {
  const PointSet set(settings_.sequence, settings_.samples, settings_.seed);
  shared_.points = static_cast<int>(set.points().size());
  const std::vector<SamplingCell> cells = sampling_cells(geometry_.sampling, numbers_, settings_.seed,
                                                         settings_.method == Method::position_dependent_printed);
  if (Status done = device_->fill(points_, set.points(), "points"); !done) return done;
  return device_->fill(cells_, cells, "cells");
}

unsigned ImageSamplerDevice::set_arguments(DeviceKernel& kernel) {
  unsigned number = 1;
  kernel.set(number++, receivers_);
  kernel.set(number++, cells_);
  kernel.set(number++, images_);
  if (settings_.method != Method::uniform_box) {
    kernel.set(number++, tables_.tables());
    kernel.set(number++, tables_.columns());
  }
  if (settings_.method == Method::position_dependent_printed) kernel.set(number++, marginals_);
  kernel.set(number++, points_);
  kernel.set(number++, sums_);
  return number;
}

Status ImageSamplerDevice::check_receiver(const Receiver& receiver) const {
  if (settings_.method != Method::position_dependent_printed) return {};
  return check_printed_receiver(geometry_, receiver);
}

}  // namespace lumifield
