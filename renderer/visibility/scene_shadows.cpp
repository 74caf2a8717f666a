#include "renderer/visibility/scene_shadows.h"

#include <algorithm>
#include <utility>

#include "renderer/view_memory.h"

namespace lumifield {

namespace {

ShadowSettings settings_of(Visibility visibility) {
  ShadowSettings settings;
  if (visibility == Visibility::published) {
    settings.position = ShadowPosition::published;
    settings.weighing = ShadowWeighing::mean;
  }
  return settings;
}

Vec3 vector_of(const std::vector<float>& list, std::size_t k) {
  return {list[4 * k], list[4 * k + 1], list[4 * k + 2]};
}

}  // namespace

/// For rays to points positions and faces are kept too.
std::size_t visibility_bytes(const LuminaireGeometry& geometry, Visibility visibility) {
  const TileVisibility one{.grid = TileGrid(geometry.sampling)};
  return one.receiver_words() * sizeof(std::uint32_t) + (visibility == Visibility::rays ? 8 * sizeof(float) : 0);
}

Result<TileShadows*> SceneShadows::shadows_of(std::unique_ptr<TileShadows>& shadows) {
  if (!shadows) {
    auto made = TileShadows::create(context_, mesh_);
    if (!made) return tl::unexpected(made.error());
    shadows = std::move(*made);
  }
  return shadows.get();
}

Result<TileVisibility> SceneShadows::by_maps(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                             Visibility visibility, bool coarse, std::span<const float> p,
                                             std::span<const float> n) {
  lamps_.resize(std::max(lamps_.size(), std::min(number + 1, most_kept)));
  Lamp& lamp = lamps_[number % most_kept];
  ShadowSettings settings = settings_of(visibility);
  // Fine maps that there are cost a coarse picture less than coarse ones that are to be made.
  const bool there = lamp.fine_pose == pose && lamp.fine_settings == settings && lamp.fine_positions == positions_;
  const bool fine = !coarse || there;
  if (!fine) {
    settings.tiles_per_map = coarse_tiles;
    settings.map_px = coarse_px;
  }
  const auto shadows = shadows_of(fine ? lamp.fine : lamp.coarse);
  if (!shadows) return tl::unexpected(shadows.error());
  if (fine) lamp.fine_pose.reset();
  if (const Status set = (*shadows)->set(pose, geometry, settings, positions_); !set)
    return tl::unexpected(set.error());
  if (fine) {
    lamp.fine_pose = pose;
    lamp.fine_settings = settings;
    lamp.fine_positions = positions_;
  }
  return (*shadows)->see(p, n);
}

Result<TileVisibility> SceneShadows::by_rays(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                             std::span<const float> p, std::span<const float> n) {
  Rays& rays = rays_[number];
  if (!rays.by || rays.pose != pose) {
    auto made = RayVisibility::create(mesh_, pose);
    if (!made) return tl::unexpected(made.error());
    rays = {pose, std::make_shared<const RayVisibility>(std::move(*made))};
  }
  return rays.by->see_tiles(TileGrid(geometry.sampling), p, n);
}

void SceneShadows::take_positions(const LightField& light_field) {
  TilePositions now = published_positions(light_field);
  if (positions_ && positions_->grid == now.grid)
    add_missing(*positions_, now);
  else
    positions_ = std::move(now);
}

void SceneShadows::forget_luminaire() {
  forget_positions();
  for (Lamp& lamp : lamps_) lamp.fine_pose.reset();
}

bool SceneShadows::gives_position(const LuminaireGeometry& geometry, CellIndex cell) const {
  const TileGrid grid(geometry.sampling);
  if (!positions_ || !(positions_->grid == grid)) return true;
  for (int row = cell.row; row < cell.row + grid.per_support; ++row)
    for (int column = cell.column; column < cell.column + grid.per_support; ++column)
      if (!positions_->at(column, row)) return true;
  return false;
}

int SceneShadows::times_made() const {
  int times = 0;
  for (const Lamp& lamp : lamps_)
    times += (lamp.fine ? lamp.fine->times_made() : 0) + (lamp.coarse ? lamp.coarse->times_made() : 0);
  return times;
}

Status SceneShadows::see(const std::vector<ScenePlacement>& placements, const LuminaireGeometry& geometry,
                         Visibility visibility, bool coarse, std::span<const float> p_xyzw,
                         std::span<const float> face_xyzw, Appearance& appearance) {
  appearance.visible = {};
  appearance.sees = {};
  rays_.resize(visibility == Visibility::rays ? placements.size() : 0);
  if (visibility == Visibility::none || placements.empty()) return {};

  const std::size_t floats = p_xyzw.size() / placements.size();
  if (const Status fits = check_view_memory("shadows", floats / 4, placements.size(),
                                            visibility_bytes(geometry, visibility), memory_bytes_);
      !fits)
    return fits;
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const auto p = p_xyzw.subspan(k * floats, floats), n = face_xyzw.subspan(k * floats, floats);
    auto seen = visibility == Visibility::rays ? by_rays(k, placements[k].pose, geometry, p, n)
                                               : by_maps(k, placements[k].pose, geometry, visibility, coarse, p, n);
    if (!seen) return tl::unexpected(seen.error());
    TileVisibility& all = appearance.visible;
    if (k == 0) {
      all = std::move(*seen);
      all.words.reserve(placements.size() * all.words.size());
    } else {
      all.words.insert(all.words.end(), seen->words.begin(), seen->words.end());
    }
  }
  if (visibility != Visibility::rays) return {};
  // Of points: what is kept of the receivers lives as long as the function.
  appearance.sees = [rays = rays_, each = floats / 4, p = std::vector<float>(p_xyzw.begin(), p_xyzw.end()),
                     n = std::vector<float>(face_xyzw.begin(), face_xyzw.end())](std::size_t k, const Vec2& u) {
    return rays[k / each].by->sees(vector_of(p, k), vector_of(n, k), {u.x(), u.y(), 0});
  };
  return {};
}

}  // namespace lumifield
