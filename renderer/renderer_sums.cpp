#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/table_memory.h"
#include "renderer/renderer_impl.h"
#include "renderer/shading.h"
#include "renderer/shift_invariant/spot_memory.h"
#include "renderer/view_memory.h"

namespace lumifield {

bool Renderer::Impl::surround(double seconds) {
  constexpr std::size_t band = 4096;  // some 10 ms of gloss
  if (!environment_on) return true;
  const auto start = std::chrono::steady_clock::now();
  const std::size_t pixels = gbuffer.position.size() / 4;
  environment_radiance.resize(3 * pixels);
  while (environment_pixels < pixels) {
    const std::size_t end = std::min(environment_pixels + band, pixels);
    shade_by_environment(gbuffer, materials, *environment, eye_mm, environment_pixels, end, environment_radiance);
    environment_pixels = end;
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() >= seconds) break;
  }
  return environment_pixels == pixels;
}

/// All cells wait.
void Renderer::Impl::clear() {
  handed_over = false;
  irradiance_before.clear();
  gloss_before.clear();
  summed.assign(cells.size(), nullptr);
  waiting.clear();
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (cells[k]) waiting.insert(static_cast<int>(k));
}

/// Before any of it is taken.
Status Renderer::Impl::check_memory() const {
  const bool glossy = std::ranges::any_of(materials, [](const Material& m) { return m.lobe != LOBE_NONE; });
  const bool shadowed = visibility != Visibility::none;
  ViewMemory view{.pixels = gbuffer.position.size() / 4, .luminaires = placements.size()};
  view.each_bytes = 3 * 4 * sizeof(float) + geometry->channels.size() * sizeof(double);
  if (glossy) view.each_bytes += sizeof(GlossLobe) + 3 * sizeof(double);
  if (spots) {
    const SpotMemory own = spot_memory(*geometry, settings.spots, shadowed, glossy);
    view.each_bytes += own.each_receiver;
    view.luminaire_bytes = own.maps;
    view.once_bytes = own.images;
  } else {
    view.each_bytes += sizeof(Receiver) + (shadowed ? visibility_bytes(*geometry, visibility) : 0);
  }
  return check_view_memory("receivers", view, host_memory_bytes());
}

/// Of additive methods: all that is summed.
Status Renderer::Impl::read_sums() {
  if (const Status read = device->read(irradiance); !read) return read;
  if (const Status read = device->read_gloss(gloss); !read) return read;
  for (std::size_t k = 0; k < irradiance_before.size(); ++k) irradiance[k] += irradiance_before[k];
  for (std::size_t k = 0; k < gloss_before.size(); ++k) gloss[k] += gloss_before[k];
  return {};
}

Status Renderer::Impl::hand_over() {
  if (const Status ready = need_luminaire(); !ready || (handed_over && !positions_wait)) return ready;
  if (const Status fits = check_memory(); !fits) return fits;
  // Tiles that get their first position change what is seen of cells to come alone (FirstPositions): sums go on.
  // Coarse maps are shared by tiles.
  if (handed_over && device && lod == 0) {
    if (const Status read = read_sums(); !read) return read;
    handed_over = false;
    irradiance_before = irradiance;
    gloss_before = gloss;
  } else {
    clear();
  }
  const Receivers seen = receivers_of(gbuffer, placements);
  Appearance appearance;
  appearance.gloss = lobes_of(gbuffer, materials, placements, eye_mm);
  if (const Status there = spots ? set_spot_scene(seen) : see(seen, appearance); !there) return there;
  gloss_channels = appearance.gloss_channels(geometry->channels.size());
  gloss.assign(seen.p.size() / 4 * gloss_channels, 0.0);
  if (method) {
    irradiance.assign(seen.p.size() / 4 * geometry->channels.size(), 0.0);
    const Status set = method->set_receivers(as_receivers(seen), std::move(appearance));
    handed_over = set.has_value();
    positions_wait = false;
    return set;
  }
  if (auto* closed_form = dynamic_cast<ClosedFormDevice*>(device.get()))
    if (const Status detailed = closed_form->set_lod(lod); !detailed) return detailed;
  const Status set = device->set_receivers(seen.p, seen.n, appearance);
  handed_over = set.has_value();
  positions_wait = false;
  return set;
}

/// What the receivers see of the luminaires, by their faces.
Status Renderer::Impl::see(const Receivers& seen, Appearance& appearance) {
  if (visibility == Visibility::published) shadows->take_positions(*geometry, cells);
  return shadows->see(placements, *geometry, visibility, lod > 0, seen.p, seen.face, appearance);
}

/// Spotlights have depth maps of their own, whatever else tells shadows.
Status Renderer::Impl::set_spot_scene(const Receivers& seen) {
  SpotScene scene{{}, {}, gbuffer.width_px};
  for (const ScenePlacement& each : placements) scene.poses.push_back(each.pose);
  if (visibility != Visibility::none) scene.face_xyzw = seen.face;
  return spots->set_scene(std::move(scene));
}

Status Renderer::Impl::keep(CellIndex cell, std::shared_ptr<const CellImage> image) {
  if (const Status ready = need_luminaire(); !ready) return ready;
  if (!image) return fail("comes without an image", "cell " + to_string(cell), "measure the cell again");
  if (const Status fits = check_cell(*geometry, cell, *image); !fits) return fits;
  if (!spots && visibility == Visibility::published && shadows->gives_position(*geometry, cell, image))
    positions_wait = true;
  const int flat = geometry->sampling.flat(cell);
  cells[static_cast<std::size_t>(flat)] = std::move(image);
  if (method) {
    method_has_cells = false;
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (cells[k]) waiting.insert(static_cast<int>(k));
  }
  waiting.insert(flat);
  return {};
}

/// The first `count` that wait: in the grid's order, in which the cells of a row share work.
Status Renderer::Impl::sum(std::size_t count) {
  if (method) return evaluate(HUGE_VAL);
  if (const Status handed = hand_over(); !handed) return handed;
  std::vector<int> flats;
  for (auto next = waiting.begin(); next != waiting.end() && flats.size() < count; ++next) flats.push_back(*next);
  return sum(flats);
}

Status Renderer::Impl::sum(const std::vector<int>& flats) {
  if (flats.empty()) return {};
  const auto start = std::chrono::steady_clock::now();
  const Status added = add(flats);
  // A device that failed in the midst has sums of no known cells.
  if (!added) {
    handed_over = false;
    return added;
  }
  for (const int flat : flats) {
    summed[static_cast<std::size_t>(flat)] = cells[static_cast<std::size_t>(flat)];
    waiting.erase(flat);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  receiver_s = took.count() / (static_cast<double>(flats.size()) * std::max(receivers(), 1.0));
  return {};
}

Status Renderer::Impl::add(const std::vector<int>& flats) {
  std::vector<CellIndex> indices;
  std::vector<std::shared_ptr<const CellImage>> images;
  for (const int flat : flats) {
    const CellIndex index = geometry->sampling.index(flat);
    const auto& image = cells[static_cast<std::size_t>(flat)];
    const auto& before = summed[static_cast<std::size_t>(flat)];
    if (before || flats.size() == 1) {
      if (const Status added = device->replace_cell(index, image, before); !added) return added;
      continue;
    }
    indices.push_back(index);
    images.push_back(image);
  }
  return indices.empty() ? Status{} : device->add_cells(indices, images);
}

/// How many wait in the grid's first row that has any, of the columns that a run of the kernel takes.
std::size_t Renderer::Impl::first_row() const {
  if (waiting.empty()) return 0;
  const int columns = geometry->sampling.columns, row = *waiting.begin() / columns, column = *waiting.begin() % columns;
  const int end = row * columns + std::min((column / GRID_CELLS + 1) * GRID_CELLS, columns);
  return static_cast<std::size_t>(std::distance(waiting.begin(), waiting.lower_bound(end)));
}

Status Renderer::Impl::need_opencl() const {
  if (!needs_opencl(settings.method) || !no_opencl) return {};
  Error error = *no_opencl;
  error.remedy += (error.remedy.empty() ? "" : ", or ") + std::string("use shift-invariant, which needs none");
  return tl::unexpected(std::move(error));
}

Result<std::unique_ptr<RunningSums>> Renderer::Impl::make_sums() {
  if (settings.method == Method::closed_form) {
    auto made = ClosedFormDevice::create(*geometry);
    if (!made) return tl::unexpected(made.error());
    return std::move(*made);
  }
  auto made = ShiftInvariantDevice::create(*context, *geometry, settings.spots);
  if (!made) return tl::unexpected(made.error());
  if (const Status set = (*made)->set_occluders(shadows->mesh()); !set) return tl::unexpected(set.error());
  return std::move(*made);
}

/// For the luminaire and the settings that are set.
Status Renderer::Impl::make_method() {
  if (const Status there = need_opencl(); !there) return there;
  std::unique_ptr<RunningSums> sums;
  std::unique_ptr<DeviceMethod> others;
  if (is_additive(settings.method)) {
    auto made = make_sums();
    if (!made) return tl::unexpected(made.error());
    sums = std::move(*made);
  } else {
    auto made = make_device_method(*geometry, settings);
    if (!made) return tl::unexpected(made.error());
    others = std::move(*made);
  }
  if (spots) spot_maps_before += spots->times_drawn();
  device = std::move(sums);
  method = std::move(others);
  spots = dynamic_cast<ShiftInvariantDevice*>(device.get());
  handed_over = method_has_cells = false;
  (spots ? info.opengl : info.opencl) = device ? device->device_name() : method->device_name();
  return {};
}

Result<LightField> Renderer::Impl::kept_cells() const {
  LightField kept(*geometry);
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (cells[k])
      if (const Status added = kept.add(geometry->sampling.index(static_cast<int>(k)), cells[k]); !added)
        return tl::unexpected(added.error());
  return kept;
}

Status Renderer::Impl::give_cells() {
  const auto kept = kept_cells();
  if (!kept) return tl::unexpected(kept.error());
  const Status given = method->set_cells(*kept);
  method_has_cells = given.has_value();
  return given;
}

/// Goes on for about `seconds`; when all receivers are done no cell waits.
Status Renderer::Impl::evaluate(double seconds) {
  if (const Status handed = hand_over(); !handed) return handed;
  if (waiting.empty()) return {};
  if (!method_has_cells)
    if (const Status given = give_cells(); !given) return given;
  const auto done = method->evaluate(seconds);
  if (!done) {
    handed_over = false;
    return tl::unexpected(done.error());
  }
  if (!*done) return {};
  if (const Status read = method->read(irradiance); !read) return read;
  if (const Status read = method->read_gloss(gloss); !read) return read;
  receiver_s = method->kernel_s() / (static_cast<double>(waiting.size()) * std::max(receivers(), 1.0));
  summed = cells;
  waiting.clear();
  return {};
}

}  // namespace lumifield
