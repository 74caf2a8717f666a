#include "renderer/methods/image_sampler_device.h"

#include <cmath>

#include "renderer/methods/position_dependent_printed.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

/// Numbers that a kernel reads at once; rows are padded so that it stays within the table.
constexpr std::size_t vector_width = 16;

std::size_t padded(std::size_t n) { return (n + 2 * vector_width - 1) / vector_width * vector_width; }

Status refused(const char* what) { return fail(what, "the luminaire", "use smaller images or fewer cells"); }

}  // namespace

Result<std::unique_ptr<ImageSamplerDevice>> ImageSamplerDevice::create(const LuminaireGeometry& geometry,
                                                                       const MethodSettings& settings,
                                                                       SamplingSteps steps, bool plain) {
  std::unique_ptr<ImageSamplerDevice> made(new ImageSamplerDevice(geometry, settings));
  // Rows of W + 1 and columns of H + 1 sums.
  const auto width = static_cast<std::size_t>(geometry.measurement.width_px);
  const auto height = static_cast<std::size_t>(geometry.measurement.height_px);
  const std::size_t stride = padded(width), column_stride = padded(height);
  if (stride * (height + 1) * geometry.channels.size() >= std::size_t(1) << 31 ||
      column_stride * width >= std::size_t(1) << 31)
    return tl::unexpected(refused("images of this size cannot be sampled").error());
  made->shared_.stride = static_cast<int>(stride);
  made->shared_.plane = static_cast<int>(stride * height);
  made->shared_.column_stride = static_cast<int>(column_stride);
  made->shared_.table = static_cast<int>(stride * (height + 1));
  made->shared_.columns = static_cast<int>(column_stride * width);

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

/// One buffer each; the tables are of no use to uniform samples.
Status ImageSamplerDevice::make_room(std::size_t cells) {
  struct Part {
    DeviceBuffer* buffer;
    std::size_t cell_bytes;
    const char* purpose;
  };
  const auto bytes = [](int numbers, std::size_t size) { return static_cast<std::size_t>(numbers) * size; };
  std::vector<Part> parts{{&images_, bytes(shared_.plane, channels() * sizeof(float)), "images"}};
  if (settings_.method != Method::uniform_box) {
    parts.push_back({&tables_, bytes(shared_.table, sizeof(double)), "summed-area tables"});
    parts.push_back({&columns_, bytes(shared_.columns, sizeof(double)), "column sums"});
  }
  if (settings_.method == Method::position_dependent_printed)
    parts.push_back({&marginals_, bytes(shared_.stride, sizeof(double)), "marginals"});

  double all = 0;
  for (const Part& part : parts) all += static_cast<double>(part.cell_bytes) * static_cast<double>(cells);
  if (const Status fits = check_table_memory(settings_, all, static_cast<double>(device_->memory_bytes())); !fits)
    return fits;
  for (const Part& part : parts)
    if (Status room = device_->make_room(*part.buffer, cells * part.cell_bytes, part.purpose); !room) return room;
  return {};
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
  const auto width = static_cast<std::size_t>(shared_.width), height = static_cast<std::size_t>(shared_.height);
  const auto stride = static_cast<std::size_t>(shared_.stride);
  const auto write = [&](const DeviceBuffer& buffer, const std::vector<double>& values) {
    return device_->write(buffer, m * values.size() * sizeof(double), std::as_bytes(std::span(values)));
  };
  std::vector<double> table(static_cast<std::size_t>(shared_.table), 0.0);
  for (std::size_t j = 0; j <= height; ++j)
    for (std::size_t i = 0; i <= width; ++i)
      table[j * stride + i] = importance.corner(static_cast<int>(i), static_cast<int>(j));
  if (Status done = write(tables_, table); !done) return done;

  const auto column_stride = static_cast<std::size_t>(shared_.column_stride);
  std::vector<double> columns(static_cast<std::size_t>(shared_.columns), 0.0), marginal(stride, 0.0);
  for (std::size_t i = 0; i < width; ++i) {
    double* sum = columns.data() + i * column_stride;
    for (std::size_t j = 0; j < height; ++j)
      sum[j + 1] = sum[j] + importance.value(static_cast<int>(i), static_cast<int>(j));
    marginal[i + 1] = marginal[i] + sum[height];
  }
  if (Status done = write(columns_, columns); !done) return done;
  if (settings_.method != Method::position_dependent_printed) return {};
  return write(marginals_, marginal);
}

/// The sequence, and each cell's rotation of it; as printed, one for all.
Status ImageSamplerDevice::make_points() {
  const PointSet set(settings_.sequence, settings_.samples, settings_.seed);
  shared_.points = static_cast<int>(set.points().size());
  std::vector<SamplingCell> cells;
  for (const int number : numbers_) {
    const Vec2 u = geometry_.sampling.cell_center_mm(geometry_.sampling.index(number));
    const bool printed = settings_.method == Method::position_dependent_printed;
    const UnitPoint shift = cell_shift(settings_.seed, printed ? 0 : static_cast<std::uint32_t>(number));
    cells.push_back({u.x(), u.y(), shift.x, shift.y, number, 0});
  }
  if (Status done = device_->fill(points_, set.points(), "points"); !done) return done;
  return device_->fill(cells_, cells, "cells");
}

unsigned ImageSamplerDevice::set_arguments(DeviceKernel& kernel) {
  unsigned number = 1;
  kernel.set(number++, receivers_);
  kernel.set(number++, cells_);
  kernel.set(number++, images_);
  if (settings_.method != Method::uniform_box) {
    kernel.set(number++, tables_);
    kernel.set(number++, columns_);
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
