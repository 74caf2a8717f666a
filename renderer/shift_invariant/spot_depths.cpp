#include "renderer/shift_invariant/spot_depths.h"

#include <epoxy/gl.h>
#include <string>

#include "luminaire/dataset.h"
#include "renderer/visibility/shadow_plan.h"

namespace lumifield {

ShadowView spot_view(const LuminaireGeometry& geometry, CellIndex cell, int map_px) {
  const Sampling& s = geometry.sampling;
  const Vec2 half = Basis(s.basis).half_support() * s.spacing_mm;
  return with_own_texels(view_from_u(geometry, s.cell_center_mm(cell), half), map_px,
                         static_cast<std::size_t>(s.flat(cell)));
}

double spot_depth_kept(const ShadowView& view, int map_px) { return 1 - bias_of(view, {.map_px = map_px}); }

Status SpotDepths::set(const Pose& pose, const LuminaireGeometry& geometry, int map_px) {
  const bool same_room = pose_ && map_px == map_px_ && !first_difference(geometry, geometry_);
  if (same_room && *pose_ == pose) return {};
  pose_.reset();
  geometry_ = geometry;
  map_px_ = map_px;
  if (!same_room)
    if (const Status room = make_room(); !room) return room;
  pose_ = pose;
  forget();
  return {};
}

void SpotDepths::forget() { there_.assign(static_cast<std::size_t>(geometry_.sampling.cells()), false); }

Status SpotDepths::make_room() {
  const int cells = geometry_.sampling.cells();
  GLint layers = 0, side = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
  if (cells > layers || map_px_ > side ||
      static_cast<double>(cells) * map_px_ * map_px_ > static_cast<double>(max_shadow_texels))
    return fail(std::to_string(cells) + " maps of " + std::to_string(map_px_) + " texels a side", "shadow maps",
                "make smaller maps, or give no shadows");
  texture_ = GlTexture();
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_R32F, map_px_, map_px_, cells);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
  return gl_status("shadow maps");
}

Status SpotDepths::draw(ShadowMapPass& pass, std::span<const CellIndex> cells) {
  std::vector<int> flats;
  std::vector<ShadowView> views;
  for (const CellIndex cell : cells) {
    const int flat = geometry_.sampling.flat(cell);
    if (there_[static_cast<std::size_t>(flat)]) continue;
    there_[static_cast<std::size_t>(flat)] = true;
    flats.push_back(flat);
    views.push_back(spot_view(geometry_, cell, map_px_));
  }
  if (views.empty()) return {};
  const auto failed = [&](const Error& error) {
    for (const int flat : flats) there_[static_cast<std::size_t>(flat)] = false;
    return Status(tl::unexpected(error));
  };
  const Result<ShadowMaps> maps = pass.draw(*pose_, views, map_px_);
  if (!maps) return failed(maps.error());
  drawn_ += static_cast<int>(views.size());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
  for (std::size_t k = 0; k < flats.size(); ++k)
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, flats[k], map_px_, map_px_, 1, GL_RED, GL_FLOAT,
                    maps->depth_mm.data() + k * maps->texels());
  const Status done = gl_status("shadow maps");
  return done ? done : failed(done.error());
}

void SpotDepths::bind(int unit) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture_.id());
}

}  // namespace lumifield
