#include "renderer/methods/far_field_device.h"

#include <array>

#include "renderer/methods/far_field.h"

namespace lumifield {

Result<std::unique_ptr<FarFieldDevice>> FarFieldDevice::create(const LuminaireGeometry& geometry,
                                                               const MethodSettings& settings) {
  std::unique_ptr<FarFieldDevice> made(new FarFieldDevice(geometry, settings));
  if (Status opened = made->open("far_field", "far_field"); !opened) return tl::unexpected(opened.error());
  return made;
}

Status FarFieldDevice::take_cells(const LightField& light_field) {
  const auto made = FarFieldTable::create(light_field, settings_);
  if (!made) return tl::unexpected(made.error());
  const FarFieldTable& table = *made;
  const std::vector<float> values(table.values().begin(), table.values().end());
  if (Status done = device_->fill(table_, values, "the far field"); !done) return done;
  shared_.width = table.width();
  shared_.height = table.height();
  shared_.plane = table.width() * table.height();
  shared_.corner_x = table.first_q_mm().x();
  shared_.corner_y = table.first_q_mm().y();
  return {};
}

unsigned FarFieldDevice::set_arguments(DeviceKernel& kernel) {
  const Vec2 center = geometry_.sampling.center_mm;
  kernel.set(1, receivers_);
  kernel.set(2, table_);
  kernel.set(3, std::array{center.x(), center.y()});
  kernel.set(4, sums_);
  return 5;
}

}  // namespace lumifield
