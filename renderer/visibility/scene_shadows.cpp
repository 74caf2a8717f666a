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

bool SceneShadows::Lamp::is_at(const Pose& pose) const {
  return (fine && fine->pose() == pose) || (coarse && coarse->pose() == pose);
}

/// By where they stand; of others, what was at their number is theirs to use again.
void SceneShadows::keep_lamps(const std::vector<ScenePlacement>& placements) {
  std::vector<Lamp> kept(std::min(placements.size(), most_kept));
  std::vector<bool> found(kept.size(), false);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto at = std::ranges::find_if(lamps_, [&](const Lamp& lamp) { return lamp.is_at(placements[k].pose); });
    if (at == lamps_.end()) continue;
    kept[k] = std::exchange(*at, {});
    found[k] = true;
  }
  for (std::size_t k = 0; k < std::min(kept.size(), lamps_.size()); ++k)
    if (!found[k]) kept[k] = std::move(lamps_[k]);
  lamps_ = std::move(kept);
}

Result<TileShadows*> SceneShadows::shadows_of(std::unique_ptr<TileShadows>& shadows) {
  if (!model_) {
    auto made = TileShadows::create(context_, mesh_);
    if (!made) return tl::unexpected(made.error());
    model_ = std::move(*made);
  }
  if (!shadows) shadows = model_->another();
  return shadows.get();
}

Result<TileVisibility> SceneShadows::by_maps(std::size_t number, const Pose& pose, const LuminaireGeometry& geometry,
                                             Visibility visibility, bool coarse, std::span<const float> p,
                                             std::span<const float> n) {
  Lamp& lamp = lamps_[std::min(number, most_kept - 1)];
  const auto positions = positions_ ? std::optional(positions_->positions()) : std::nullopt;
  ShadowSettings settings = settings_of(visibility);
  // Fine maps that there are cost a coarse picture less than coarse ones that are to be made.
  const bool fine = !coarse || (lamp.fine && lamp.fine->has(pose, geometry, settings, positions));
  if (!fine) {
    settings.tiles_per_map = coarse_tiles;
    settings.map_px = coarse_px;
  }
  const auto shadows = shadows_of(fine ? lamp.fine : lamp.coarse);
  if (!shadows) return tl::unexpected(shadows.error());
  const int before = (*shadows)->times_made();
  const Status set = (*shadows)->set(pose, geometry, settings, positions);
  times_made_ += (*shadows)->times_made() - before;
  if (!set) return tl::unexpected(set.error());
  return (*shadows)->see(p, n);
}

Result<TileVisibility> SceneShadows::by_rays(const Pose& pose, const LuminaireGeometry& geometry,
                                             std::span<const float> p, std::span<const float> n) {
  if (rays_) {
    rays_ = rays_->at(pose);
  } else {
    auto made = RayVisibility::create(mesh_, pose);
    if (!made) return tl::unexpected(made.error());
    rays_ = std::move(*made);
  }
  return rays_->see_tiles(TileGrid(geometry.sampling), p, n);
}

void SceneShadows::take_positions(const LuminaireGeometry& geometry,
                                  std::span<const std::shared_ptr<const CellImage>> cells) {
  if (!positions_ || positions_->positions().grid != TileGrid(geometry.sampling)) positions_.emplace(geometry);
  positions_->take(cells);
}

bool SceneShadows::gives_position(const LuminaireGeometry& geometry, CellIndex cell,
                                  const std::shared_ptr<const CellImage>& image) {
  if (!positions_ || positions_->positions().grid != TileGrid(geometry.sampling)) return true;
  return positions_->would_give(cell, image);
}

Status SceneShadows::see(const std::vector<ScenePlacement>& placements, const LuminaireGeometry& geometry,
                         Visibility visibility, bool coarse, std::span<const float> p_xyzw,
                         std::span<const float> face_xyzw, Appearance& appearance) {
  appearance.visible = {};
  appearance.sees = {};
  if (visibility != Visibility::rays) rays_.reset();
  keep_lamps(placements);
  if (visibility == Visibility::none || placements.empty()) return {};

  const std::size_t floats = p_xyzw.size() / placements.size();
  std::vector<RayVisibility> rays;
  if (const Status fits = check_view_memory(
          "shadows", {floats / 4, placements.size(), visibility_bytes(geometry, visibility)}, memory_bytes_);
      !fits)
    return fits;
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const auto p = p_xyzw.subspan(k * floats, floats), n = face_xyzw.subspan(k * floats, floats);
    auto seen = visibility == Visibility::rays ? by_rays(placements[k].pose, geometry, p, n)
                                               : by_maps(k, placements[k].pose, geometry, visibility, coarse, p, n);
    if (!seen) return tl::unexpected(seen.error());
    if (rays_) rays.push_back(*rays_);
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
  appearance.sees = [rays = std::move(rays), each = floats / 4, p = std::vector<float>(p_xyzw.begin(), p_xyzw.end()),
                     n = std::vector<float>(face_xyzw.begin(), face_xyzw.end())](std::size_t k, const Vec2& u) {
    return rays[k / each].sees(vector_of(p, k), vector_of(n, k), {u.x(), u.y(), 0});
  };
  return {};
}

}  // namespace lumifield
