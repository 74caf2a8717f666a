#include "renderer/methods/precomputed_lights_device.h"

#include "renderer/methods/precomputed_lights.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

constexpr std::size_t vector_width = 16;

}  // namespace

Result<std::unique_ptr<PrecomputedLightsDevice>> PrecomputedLightsDevice::create(const LuminaireGeometry& geometry,
                                                                                 const MethodSettings& settings) {
  std::unique_ptr<PrecomputedLightsDevice> made(new PrecomputedLightsDevice(geometry, settings));
  if (Status opened = made->open("precomputed_lights", "precomputed_lights"); !opened)
    return tl::unexpected(opened.error());
  return made;
}

Status PrecomputedLightsDevice::take_cells(const LightField& light_field) {
  measured_ = measured_cells(light_field);
  return check_memory();
}

Status PrecomputedLightsDevice::check_memory() const {
  return check_table_memory(settings_, host_table_bytes(geometry_, settings_, static_cast<int>(measured_.size())),
                            host_memory_bytes());
}

/// Cell by cell, each cell's lights filled up to whole vectors with lights of no value.
Status PrecomputedLightsDevice::make_points() {
  if (Status fits = check_memory(); !fits) return fits;
  const std::vector<PrecomputedLight> lights = precompute_lights(measured_, settings_);
  std::vector<SamplingCell> cells;
  std::vector<const PrecomputedLight*> placed;
  auto next = lights.begin();
  for (std::size_t m = 0; m < measured_.size(); ++m) {
    const MeasuredCell& cell = measured_[m];
    cells.push_back(
        {cell.u_mm.x(), cell.u_mm.y(), 0, 0, static_cast<int>(cell.number), static_cast<int>(placed.size())});
    for (; next != lights.end() && next->cell == static_cast<int>(m); ++next) placed.push_back(&*next);
    while (placed.size() % vector_width != 0) placed.push_back(nullptr);
  }
  cells.push_back({0, 0, 0, 0, 0, static_cast<int>(placed.size())});

  const std::size_t plane = placed.size();
  std::vector<float> table((4 + channels()) * plane, 0.0F);
  const auto split = [&](double place, std::size_t k) {
    table[k] = static_cast<float>(place);
    table[plane + k] = static_cast<float>(place - static_cast<double>(table[k]));
  };
  for (std::size_t k = 0; k < plane; ++k) {
    if (!placed[k]) continue;
    split(placed[k]->on_s_px.x(), k);
    split(placed[k]->on_s_px.y(), 2 * plane + k);
    for (std::size_t c = 0; c < channels(); ++c) table[(4 + c) * plane + k] = static_cast<float>(placed[k]->value[c]);
  }
  shared_.cells = static_cast<int>(measured_.size());
  shared_.plane = static_cast<int>(plane);
  if (Status done = device_->fill(lights_, table, "lights"); !done) return done;
  return device_->fill(cells_, cells, "cells");
}

unsigned PrecomputedLightsDevice::set_arguments(DeviceKernel& kernel) {
  kernel.set(1, receivers_);
  kernel.set(2, cells_);
  kernel.set(3, lights_);
  kernel.set(4, sums_);
  return 5;
}

Status PrecomputedLightsDevice::check_receiver(const Receiver& receiver) const {
  if (receiver.p_mm.z() == geometry_.planes.separation_mm)
    return fail("lies on S, where no light is seen", "receiver", "use closed-form");
  return {};
}

}  // namespace lumifield
