#include <algorithm>
#include <cmath>
#include <optional>

#include "renderer/bands.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/closed_form_tile.h"
#include "renderer/methods/closed_form_tiles_device.h"
#include "renderer/methods/device_images.h"
#include "renderer/opencl/device.h"

namespace lumifield {

namespace {

constexpr std::size_t work_group = 64;
/// Receivers of a work-item of the grid's kernel: on a processor as many as share its nearest cache.
constexpr std::size_t bunch_on_cpu = 16;
/// Images held on the device at a time.
constexpr std::size_t batch_bytes = std::size_t(256) << 20;

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

/// A product with 0 is 0 unless a factor is NaN or Inf.
bool is_not_finite(const ClosedFormReceiver& r) {
  return (r.p_x * 0 + r.p_y * 0 + r.p_z * 0) + (r.n_x * 0 + r.n_y * 0 + r.n_z * 0) != 0;
}

}  // namespace

struct ClosedFormDevice::Impl {
  LuminaireGeometry geometry;
  std::unique_ptr<OpenClDevice> device;
  DeviceKernel kernel, grid_kernel;
  std::optional<ClosedFormTilesDevice> tiles;  ///< of receivers in half-shadow, or that shine
  std::size_t bunch = 1;                       ///< receivers of a work-item of grid_kernel
  ClosedFormGeometry shared{};
  DeviceImages layout;
  DeviceBuffer receivers, levels, sums;
  DeviceBuffer cells, images, centers, row_begins;
  std::span<const std::shared_ptr<const CellImage>> offered;  ///< of the call under way, to be held
  std::vector<std::shared_ptr<const CellImage>> held;         ///< so that those on the device stay what they are
  std::vector<const CellImage*> on_device;                    ///< of `held`, as `images` has them in this layout
  std::vector<ClosedFormReceiver> of_picture;                 ///< kept for its memory
  double next_lod = 0;                                        ///< of the next receivers
  double last_kernel_s = 0;

  std::size_t channels() const { return geometry.channels.size(); }
  std::size_t cell_bytes() const { return layout.image_floats() * sizeof(float); }
  Status take_receivers(std::vector<ClosedFormReceiver>& all, const Appearance& appearance);
  Status add(std::span<const BatchCell> all);
  Status upload(std::span<const BatchCell> batch);
  Status run(const Tile& tile, std::size_t first_image);
  Status prepare_grid(const Tile& tile);
};

ClosedFormDevice::ClosedFormDevice(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ClosedFormDevice::~ClosedFormDevice() = default;
std::string ClosedFormDevice::device_name() const { return impl_->device->name(); }
double ClosedFormDevice::last_kernel_s() const { return impl_->last_kernel_s; }

Result<std::unique_ptr<ClosedFormDevice>> ClosedFormDevice::create(const LuminaireGeometry& geometry) {
  // The geometry as the kernel sees it.
  const Measurement& m = geometry.measurement;
  const Sampling& s = geometry.sampling;
  if (geometry.channels.size() != 1 && geometry.channels.size() != 3)
    return fail("a luminaire of " + std::to_string(geometry.channels.size()) + " channels cannot be rendered",
                "channels", "give it the channel Y, or R, G, B");
  if (!DeviceImages(geometry, true).fits())
    return fail(
        "images of " + std::to_string(m.width_px) + "x" + std::to_string(m.height_px) + " pixels cannot be rendered",
        "measurement", "give at least 1 pixel, and fewer than these");
  auto impl = std::make_unique<Impl>();
  impl->geometry = geometry;
  impl->shared = {geometry.planes.separation_mm,
                  s.spacing_mm.x(),
                  s.spacing_mm.y(),
                  m.corner_mm().x(),
                  m.corner_mm().y(),
                  m.pixel_mm.x(),
                  m.pixel_mm.y(),
                  1 / m.pixel_mm.x(),
                  1 / m.pixel_mm.y(),
                  0,
                  0,
                  0,
                  0,
                  0};

  // The device and its kernel.
  auto device = OpenClDevice::create();
  if (!device) return tl::unexpected(device.error());
  impl->device = std::move(*device);
  if (impl->device->is_cpu()) impl->bunch = bunch_on_cpu;
  const std::string options = "-DBASIS=" + std::to_string(static_cast<int>(s.basis)) +
                              " -DCHANNELS=" + std::to_string(geometry.channels.size()) +
                              " -DBUNCH=" + std::to_string(impl->bunch);
  auto kernel = impl->device->build("closed_form", options, "closed_form_add");
  if (!kernel) return tl::unexpected(kernel.error());
  auto grid_kernel = impl->device->another(*kernel, "closed_form_add_grid");
  if (!grid_kernel) return tl::unexpected(grid_kernel.error());
  impl->kernel = *kernel;
  impl->grid_kernel = *grid_kernel;
  impl->tiles.emplace(*impl->device, impl->geometry);
  return std::unique_ptr<ClosedFormDevice>(new ClosedFormDevice(std::move(impl)));
}

Status ClosedFormDevice::set_lod(double pixels_per_support) {
  if (!std::isfinite(pixels_per_support) || pixels_per_support < 0)
    return fail("is negative or not finite", "level of detail", "give the pixels per support, or 0 for all");
  impl_->next_lod = pixels_per_support;
  return {};
}

Status ClosedFormDevice::Impl::take_receivers(std::vector<ClosedFormReceiver>& all, const Appearance& appearance) {
  if (const auto bad = first_where(all.size(), [&](std::size_t k) { return is_not_finite(all[k]); }))
    return fail("has NaN or Inf", "receiver " + std::to_string(*bad), "give finite numbers");
  if (all.size() > std::size_t(1) << 30) return fail("more than 2^30 receivers", "receivers", "render in parts");
  shared.receivers = 0;  // until these are there
  if (const Status taken = tiles->take(all, appearance, next_lod); !taken) return taken;
  const std::size_t image_floats_before = layout.image_floats();
  layout = DeviceImages(geometry, next_lod > 0);
  if (layout.image_floats() != image_floats_before) on_device.clear();
  shared.lod = next_lod;
  shared.levels = static_cast<int>(layout.levels().size());
  shared.plane = static_cast<int>(layout.plane_floats());
  if (auto room = device->make_room(levels, layout.levels().size_bytes(), "levels of detail"); !room) return room;
  if (auto room = device->make_room(sums, all.size() * channels() * sizeof(double), "sums of irradiance"); !room)
    return room;
  if (auto written = device->fill(receivers, all, "receivers"); !written) return written;
  if (auto written = device->write(levels, 0, std::as_bytes(layout.levels())); !written) return written;
  if (auto cleared = device->zero(sums); !cleared) return cleared;
  shared.receivers = static_cast<int>(all.size());
  return {};
}

Status ClosedFormDevice::set_receivers(std::span<const Receiver> receivers, const Appearance& appearance) {
  std::vector<ClosedFormReceiver> all;
  all.reserve(receivers.size());
  for (const Receiver& r : receivers)
    all.push_back({r.p_mm.x(), r.p_mm.y(), lit_height_mm(r.p_mm.z()), r.n.x(), r.n.y(), r.n.z()});
  return impl_->take_receivers(all, appearance);
}

Status ClosedFormDevice::set_receivers(std::span<const float> p_xyzw, std::span<const float> n_xyzw,
                                       const Appearance& appearance) {
  if (p_xyzw.size() != n_xyzw.size() || p_xyzw.size() % 4 != 0)
    return fail("positions and normals are not 4 floats each", "receivers", "give as many of both");
  std::vector<ClosedFormReceiver>& all = impl_->of_picture;
  all.resize(p_xyzw.size() / 4);
  in_bands(all.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      all[k] = {p_xyzw[4 * k], p_xyzw[4 * k + 1], lit_height_mm(p_xyzw[4 * k + 2]),
                n_xyzw[4 * k], n_xyzw[4 * k + 1], n_xyzw[4 * k + 2]};
  });
  return impl_->take_receivers(all, appearance);
}

Status ClosedFormDevice::Impl::upload(std::span<const BatchCell> batch) {
  std::vector<const CellImage*> wanted;
  for (const BatchCell& each : batch) wanted.push_back(each.image);
  if (wanted == on_device) return {};
  on_device.clear();
  held.assign(offered.begin(), offered.end());
  if (auto room = device->make_room(images, batch.size() * cell_bytes(), "cell images"); !room) return room;
  std::vector<float> packed;
  for (std::size_t k = 0; k < batch.size(); ++k) {
    layout.pack(*batch[k].image, packed);
    if (auto written = device->write(images, k * cell_bytes(), bytes_of(packed)); !written) return written;
  }
  if (!held.empty()) on_device = std::move(wanted);
  return {};
}

/// The arguments that the grid's kernel takes besides.
Status ClosedFormDevice::Impl::prepare_grid(const Tile& tile) {
  std::vector<double> u;
  std::vector<int> row_begin;
  for (int k = 0; k < tile.columns; ++k)
    u.push_back(geometry.sampling.cell_center_mm({tile.first.row, tile.first.column + k}).x());
  for (int k = 0; k <= tile.rows; ++k) {
    const CellIndex row{tile.first.row + k, 0};
    if (k < tile.rows) u.push_back(geometry.sampling.cell_center_mm(row).y());
    const auto begin =
        std::find_if(tile.cells.begin(), tile.cells.end(), [&](auto& each) { return each.index >= row; });
    row_begin.push_back(static_cast<int>(begin - tile.cells.begin()));
  }
  if (auto filled = device->fill(centers, u, "rows and columns"); !filled) return filled;
  if (auto filled = device->fill(row_begins, row_begin, "rows of cells"); !filled) return filled;
  grid_kernel.set(6, ClosedFormGrid{tile.columns, tile.rows});
  grid_kernel.set(7, centers);
  grid_kernel.set(8, row_begins);
  return {};
}

Status ClosedFormDevice::Impl::run(const Tile& tile, std::size_t first_image) {
  std::vector<ClosedFormCell> table;
  for (const BatchCell& each : tile.cells) {
    const Vec2 u = geometry.sampling.cell_center_mm(each.index);
    table.push_back({u.x(), u.y(), each.sign, static_cast<int>((first_image + table.size()) * channels()),
                     each.index.column - tile.first.column});
  }
  if (auto filled = device->fill(cells, table, "cells"); !filled) return filled;
  const bool dense = tile.is_dense();
  if (dense || !tiles->empty())
    if (auto prepared = prepare_grid(tile); !prepared) return prepared;
  DeviceKernel& runs = dense ? grid_kernel : kernel;
  shared.cells = static_cast<int>(table.size());
  runs.set(0, shared);
  runs.set(1, receivers);
  runs.set(2, cells);
  runs.set(3, images);
  runs.set(4, levels);
  runs.set(5, sums);
  const std::size_t each = dense ? bunch : 1;
  const auto seconds =
      device->run(runs, (static_cast<std::size_t>(shared.receivers) + each - 1) / each, each > 1 ? 1 : work_group);
  if (!seconds) return tl::unexpected(seconds.error());
  last_kernel_s += *seconds;
  if (tiles->empty()) return {};
  const auto more =
      tiles->run({shared, {tile.columns, tile.rows}, tile.first, cells, images, levels, sums, centers, row_begins});
  if (!more) return tl::unexpected(more.error());
  last_kernel_s += *more;
  return {};
}

Status ClosedFormDevice::Impl::add(std::span<const BatchCell> all) {
  for (const BatchCell& each : all)
    if (auto good = check_cell(geometry, each.index, *each.image); !good) return good;
  last_kernel_s = 0;
  if (shared.receivers == 0) return {};

  // As many images at a time as the device takes in one buffer.
  const std::size_t fit = std::max<std::size_t>(std::min(batch_bytes, device->max_buffer_bytes()) / cell_bytes(), 1);
  for (std::size_t begin = 0; begin < all.size(); begin += fit) {
    const auto batch = all.subspan(begin, std::min(fit, all.size() - begin));
    if (auto uploaded = upload(batch); !uploaded) return uploaded;
    for (std::size_t done = 0; done < batch.size();) {
      const Tile tile = first_tile(batch.subspan(done));
      if (auto ran = run(tile, done); !ran) return ran;
      done += tile.cells.size();
    }
  }
  return {};
}

Status ClosedFormDevice::add_cell(CellIndex cell, const CellImage& image, const CellImage* replaces) {
  std::vector<BatchCell> batch{{cell, &image, 1}};
  if (replaces) batch.push_back({cell, replaces, -1});
  return impl_->add(batch);
}

Status ClosedFormDevice::add_cells(std::span<const CellIndex> cells, std::span<const CellImage* const> images) {
  if (cells.size() != images.size())
    return fail(std::to_string(cells.size()) + " cells came with " + std::to_string(images.size()) + " images", "cells",
                "give one image each");
  std::vector<BatchCell> batch;
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (images[k]) batch.push_back({cells[k], images[k], 1});
  std::stable_sort(batch.begin(), batch.end(), [](const auto& a, const auto& b) {
    return std::pair(tile_of(a.index), a.index) < std::pair(tile_of(b.index), b.index);
  });
  return impl_->add(batch);
}

Status ClosedFormDevice::add_cells(std::span<const CellIndex> cells,
                                   std::span<const std::shared_ptr<const CellImage>> images) {
  std::vector<const CellImage*> pointers;
  for (const auto& image : images) pointers.push_back(image.get());
  impl_->offered = images;
  const Status added = add_cells(cells, pointers);
  impl_->offered = {};
  return added;
}

Status ClosedFormDevice::read(std::vector<double>& irradiance) {
  irradiance.resize(static_cast<std::size_t>(impl_->shared.receivers) * impl_->channels());
  return impl_->device->read(impl_->sums, std::as_writable_bytes(std::span(irradiance)));
}

Status ClosedFormDevice::read_gloss(std::vector<double>& radiance) { return impl_->tiles->read_gloss(radiance); }

Status ClosedFormDevice::read(std::vector<float>& irradiance) {
  std::vector<double> sums;
  if (auto got = read(sums); !got) return got;
  irradiance.assign(sums.begin(), sums.end());
  return {};
}

}  // namespace lumifield
