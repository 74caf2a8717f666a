#include "renderer/visibility/shadow_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lumifield {
namespace {

Status check(const LuminaireGeometry& geometry, const ShadowSettings& settings,
             const std::optional<TilePositions>& positions) {
  const auto refuse = [](std::string what, std::string remedy) {
    return fail(std::move(what), "shadows", std::move(remedy));
  };
  if (!(geometry.planes.separation_mm > 0) || geometry.sampling.cells() < 1 || geometry.measurement.pixels() < 1)
    return refuse("the luminaire has no size", "give it cells, pixels and a separation");
  if (settings.map_px < 1)
    return refuse("maps of " + std::to_string(settings.map_px) + " texels a side", "ask for 1 or more");
  if (settings.tiles_per_map < 1 || settings.tiles_per_map > 32)
    return refuse(std::to_string(settings.tiles_per_map) + " tiles per map and axis", "ask for 1 to 32");
  if (!(settings.texel_bias >= 0 && settings.texel_bias < 100))
    return refuse("a bias of " + std::to_string(settings.texel_bias) + " texels", "give 0 or more, less than 100");
  if (!(settings.depth_bias >= 0 && settings.depth_bias < 1))
    return refuse("a depth bias of " + std::to_string(settings.depth_bias), "give 0 or more, less than 1");
  if (settings.position == ShadowPosition::tile_center) return {};
  if (!positions) return refuse("the published positions are not there", "compute them from the cells first");
  if (positions->grid != TileGrid(geometry.sampling) ||
      positions->on_s_mm.size() != static_cast<std::size_t>(positions->grid.tiles()))
    return refuse("the published positions are of another luminaire", "compute them from its own cells");
  return {};
}

/// The tiles [column, column_end) × [row, row_end).
struct Block {
  int column, row, column_end, row_end;
};

Vec2 center_mm(const TileGrid& grid, const Block& b) {
  return (grid.center_mm(b.column, b.row) + grid.center_mm(b.column_end - 1, b.row_end - 1)) / 2;
}

/// Of what of U sees by the map.
Vec2 half_of(const TileGrid& grid, const Block& block) {
  return grid.size_mm.cwiseProduct(Vec2(block.column_end - block.column, block.row_end - block.row)) / 2;
}

std::optional<ShadowView> from_s(const LuminaireGeometry& geometry, const TilePositions& positions,
                                 const Block& block) {
  const TileGrid& grid = positions.grid;
  Vec2 sum(0, 0);
  int tiles = 0;
  for (int row = block.row; row < block.row_end; ++row)
    for (int column = block.column; column < block.column_end; ++column)
      if (const auto& at = positions.at(column, row)) {
        sum += *at;
        ++tiles;
      }
  if (tiles == 0) return std::nullopt;
  const Measurement& m = geometry.measurement;
  const Vec2 half_image = m.center_mm - m.corner_mm();
  const Vec2 half_grid = grid.size_mm.cwiseProduct(Vec2(grid.columns, grid.rows)) / 2;
  const Vec2 apart = (m.center_mm - geometry.sampling.center_mm).cwiseAbs();
  const double delta = geometry.planes.separation_mm;
  const Vec2 widest = published_widening / delta * (half_image + half_grid + apart);
  return ShadowView{Vec3(sum.x() / tiles, sum.y() / tiles, delta), -widest, widest};
}

}  // namespace

ShadowView view_from_u(const LuminaireGeometry& geometry, const Vec2& e, const Vec2& half) {
  const Vec2 corner = geometry.measurement.corner_mm();
  return {Vec3(e.x(), e.y(), 0), (corner - half - e) / geometry.planes.separation_mm,
          (2 * geometry.measurement.center_mm - corner + half - e) / geometry.planes.separation_mm};
}

ShadowView with_own_texels(ShadowView view, int map_px, std::size_t number) {
  if (map_px < 2) return view;
  const Vec2 step = (view.high - view.low) / (map_px - 1);
  const auto part = [&](double ratio) { return std::fmod(0.5 + ratio * static_cast<double>(number), 1.0); };
  view.low -= step.cwiseProduct(Vec2(part(0.7548776662466927), part(0.5698402909980532)));
  view.high = view.low + map_px * step;
  return view;
}

double bias_of(const ShadowView& view, const ShadowSettings& settings) {
  const Vec2 step = (view.high - view.low) / settings.map_px;
  return std::min(settings.depth_bias + settings.texel_bias * step.maxCoeff(), 0.5);
}

Result<ShadowPlan> plan_shadows(const LuminaireGeometry& geometry, const ShadowSettings& settings,
                                const std::optional<TilePositions>& positions) {
  if (const Status good = check(geometry, settings, positions); !good) return tl::unexpected(good.error());
  ShadowPlan plan;
  plan.grid = TileGrid(geometry.sampling);
  plan.block = settings.tiles_per_map;
  plan.separation_mm = geometry.planes.separation_mm;
  const int b = plan.block;
  plan.columns = (plan.grid.columns + b - 1) / b;
  plan.rows = (plan.grid.rows + b - 1) / b;
  const bool published = settings.position == ShadowPosition::published;

  // Bound the maps before they are listed.
  const double texels = static_cast<double>(settings.map_px) * settings.map_px;
  if ((published ? 2.0 : 1.0) * plan.columns * plan.rows * texels > static_cast<double>(max_shadow_texels))
    return fail(std::to_string(plan.columns) + "x" + std::to_string(plan.rows) + " maps of " +
                    std::to_string(settings.map_px) + " texels a side exceed 512 MiB",
                "shadows", "use more tiles per map, or smaller maps");

  for (int set = 0; set < (published ? 2 : 1); ++set)
    for (int row = 0; row < plan.grid.rows; row += b)
      for (int column = 0; column < plan.grid.columns; column += b) {
        const Block block = {column, row, std::min(column + b, plan.grid.columns), std::min(row + b, plan.grid.rows)};
        const auto view =
            set == 0 ? with_own_texels(view_from_u(geometry, center_mm(plan.grid, block), half_of(plan.grid, block)),
                                       settings.map_px, plan.views.size())
                     : from_s(geometry, *positions, block);
        plan.maps_of[static_cast<std::size_t>(set)].push_back(view ? static_cast<int>(plan.views.size()) : -1);
        if (view) plan.views.push_back(*view);
      }
  return plan;
}

}  // namespace lumifield
