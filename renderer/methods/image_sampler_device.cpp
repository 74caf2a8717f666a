#include "renderer/methods/image_sampler_device.h"

#include <cmath>

#include "renderer/methods/position_dependent_printed.h"
#include "renderer/methods/receiver_view.h"

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

Status ImageSamplerDevice::take_cells(const LightField& light_field) {
  const bool printed = settings_.method == Method::position_dependent_printed;
  if (printed)
    if (const Status good = check_printed_luminaire(light_field); !good) return good;

  // One buffer each; the tables are of no use to uniform samples.
  const auto count = static_cast<std::size_t>(light_field.coverage().measured);
  const bool tabled = settings_.method != Method::uniform_box;
  struct Part {
    DeviceBuffer* buffer;
    std::size_t bytes;
    const char* purpose;
  };
  const std::size_t plane = static_cast<std::size_t>(shared_.plane) * geometry_.channels.size();
  for (const Part& part :
       {Part{&images_, count * plane * sizeof(float), "images"},
        Part{&tables_, count * tabled * static_cast<std::size_t>(shared_.table) * sizeof(double), "summed-area tables"},
        Part{&columns_, count * tabled * static_cast<std::size_t>(shared_.columns) * sizeof(double), "column sums"},
        Part{&marginals_, count * printed * static_cast<std::size_t>(shared_.stride) * sizeof(double), "marginals"}}) {
    if (part.buffer->bytes() >= part.bytes && part.buffer->bytes() > 0) continue;
    *part.buffer = {};
    auto room = device_->allocate(part.bytes, part.purpose);
    if (!room) return tl::unexpected(room.error());
    *part.buffer = *room;
  }

  numbers_.clear();
  for (int flat = 0; flat < geometry_.sampling.cells(); ++flat) {
    const auto cell = sampled_cell(light_field, flat, printed ? luminance_image : importance_image);
    if (!cell) continue;
    if (Status done = upload_cell(numbers_.size(), *cell); !done) return done;
    numbers_.push_back(flat);
  }
  shared_.cells = static_cast<int>(numbers_.size());
  return {};
}

Status ImageSamplerDevice::upload_cell(std::size_t m, const SampledCell& cell) {
  const auto width = static_cast<std::size_t>(shared_.width), height = static_cast<std::size_t>(shared_.height);
  const auto stride = static_cast<std::size_t>(shared_.stride);
  const auto channels = geometry_.channels.size();
  std::vector<float> image(static_cast<std::size_t>(shared_.plane) * channels, 0.0F);
  for (std::size_t c = 0; c < channels; ++c)
    for (std::size_t j = 0; j < height; ++j)
      std::copy_n(cell.image->channel(static_cast<int>(c)) + j * width, width,
                  image.data() + c * static_cast<std::size_t>(shared_.plane) + j * stride);
  if (Status done = device_->write(images_, m * image.size() * sizeof(float), std::as_bytes(std::span(image))); !done)
    return done;
  if (settings_.method == Method::uniform_box) return {};

  std::vector<double> table(static_cast<std::size_t>(shared_.table), 0.0);
  for (std::size_t j = 0; j <= height; ++j)
    for (std::size_t i = 0; i <= width; ++i)
      table[j * stride + i] = cell.importance.corner(static_cast<int>(i), static_cast<int>(j));
  if (Status done = device_->write(tables_, m * table.size() * sizeof(double), std::as_bytes(std::span(table))); !done)
    return done;

  const auto column_stride = static_cast<std::size_t>(shared_.column_stride);
  std::vector<double> columns(static_cast<std::size_t>(shared_.columns), 0.0), marginal(stride, 0.0);
  for (std::size_t i = 0; i < width; ++i) {
    double* sum = columns.data() + i * column_stride;
    for (std::size_t j = 0; j < height; ++j)
      sum[j + 1] = sum[j] + cell.importance.value(static_cast<int>(i), static_cast<int>(j));
    marginal[i + 1] = marginal[i] + sum[height];
  }
  if (Status done = device_->write(columns_, m * columns.size() * sizeof(double), std::as_bytes(std::span(columns)));
      !done)
    return done;
  if (settings_.method != Method::position_dependent_printed) return {};
  return device_->write(marginals_, m * marginal.size() * sizeof(double), std::as_bytes(std::span(marginal)));
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
  if (Status done = upload(points_, set.points(), "points"); !done) return done;
  return upload(cells_, cells, "cells");
}

void ImageSamplerDevice::set_arguments(DeviceKernel& kernel) {
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
}

Status ImageSamplerDevice::check_receiver(const Receiver& receiver) const {
  if (settings_.method != Method::position_dependent_printed) return {};
  return check_printed_receiver(geometry_, receiver);
}

}  // namespace lumifield
