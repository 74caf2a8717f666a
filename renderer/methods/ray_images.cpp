#include "renderer/methods/ray_images.h"

#include "renderer/methods/ray_light.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

RayImages::RayImages(const LuminaireGeometry& geometry, bool with_levels) : layout_(geometry, with_levels) {
  const Sampling& s = geometry.sampling;
  const Vec2 first = s.cell_center_mm({0, 0});
  shared_.first_x = first.x();
  shared_.first_y = first.y();
  shared_.half_box = half_box_of(Basis(s.basis));
  shared_.columns = s.columns;
  shared_.rows = s.rows;
  shared_.levels = static_cast<int>(layout_.levels().size());
}

Status RayImages::check_memory(const OpenClDevice& device, const MethodSettings& settings, double further_bytes) const {
  return check_table_memory(settings, bytes_ + further_bytes, static_cast<double>(device.memory_bytes()));
}

Status RayImages::upload(OpenClDevice& device, const LightField& light_field, const MethodSettings& settings,
                         double further_bytes) {
  if (!layout_.fits())
    return fail("images of this size cannot be sampled", "the luminaire", "use smaller images or fewer cells");
  shared_.plane = static_cast<int>(layout_.plane_floats());
  shared_.image = static_cast<int>(layout_.image_floats());
  const std::vector<MeasuredCell> cells = measured_cells(light_field);
  const std::size_t bytes = layout_.image_floats() * sizeof(float);
  bytes_ = static_cast<double>(cells.size() * bytes);
  if (const Status fits = check_memory(device, settings, further_bytes); !fits) return fits;
  if (Status room = device.make_room(images_, cells.size() * bytes, "images"); !room) return room;
  std::vector<int> slots(static_cast<std::size_t>(light_field.geometry().sampling.cells()), -1);
  std::vector<float> packed;
  for (std::size_t m = 0; m < cells.size(); ++m) {
    slots[cells[m].number] = static_cast<int>(m);
    layout_.pack(*cells[m].image, packed);
    if (Status done = device.write(images_, m * bytes, std::as_bytes(std::span(packed))); !done) return done;
  }
  const std::vector<ClosedFormLevel> levels(layout_.levels().begin(), layout_.levels().end());
  if (Status done = device.fill(levels_, levels, "levels"); !done) return done;
  return device.fill(slots_, slots, "cells");
}

}  // namespace lumifield
