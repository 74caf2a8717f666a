#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "renderer/study/stability.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {

namespace {

constexpr double delta = 48;

/// Dyadic pixels and centres, so that a receiver can stand exactly on an edge.
LuminaireGeometry small_geometry(BasisKind basis = BasisKind::bell) {
  LuminaireGeometry g;
  g.planes.separation_mm = delta;
  g.sampling = {basis, {8, 8}, 4, 3, {0, 0}};
  g.measurement = {44, 36, {1.5, 1.5}, {0, 0}};
  g.channels = {"Y"};
  return g;
}

/// Values from `low` to 1 on a smooth ground, seeded.
std::vector<CellImage> random_cells(const LuminaireGeometry& g, float low = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, 1);
  std::vector<CellImage> cells;
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    CellImage image{g.measurement.width_px, g.measurement.height_px, 1, {}, {}, {}};
    for (std::size_t k = 0; k < image.plane(); ++k) image.value.push_back(value(random));
    cells.push_back(std::move(image));
  }
  return cells;
}

std::vector<Receiver> around(double z, const Vec3& n = Vec3(0.2, -0.1, -1)) {
  std::vector<Receiver> receivers;
  for (const Vec2& at : {Vec2(3.3, -2.1), Vec2(-6.2, 4.4), Vec2(0.4, 7.7)})
    receivers.push_back({{at.x(), at.y(), z}, n.normalized()});
  return receivers;
}

std::vector<Receiver> at(const Vec2& p, double z) { return {{{p.x(), p.y(), z}, Vec3(0.2, -0.1, -1).normalized()}}; }

StabilityCase named(std::string name, std::vector<Receiver> receivers) {
  const LuminaireGeometry g = small_geometry();
  return {std::move(name), g, random_cells(g), std::move(receivers)};
}

void add_receiver_cases(std::vector<StabilityCase>& cases) {
  for (const auto& [name, off] : {std::pair("on S", 0.0),
                                  {"on S, Δ = −0", -0.0},
                                  {"Δ = 1e-9", 1e-9},
                                  {"Δ = −1e-9", -1e-9},
                                  {"Δ = 1e-4", 1e-4},
                                  {"Δ = −1e-4", -1e-4}}) {
    cases.push_back(named(name, around(delta + off)));
    // Pixel edges of the small geometry lie at whole multiples of 1.5.
    cases.push_back(named(std::string(name) + ", p on a pixel edge", at({3, 2}, delta + off)));
  }
  cases.push_back(named("just beyond S", around(delta + 2)));
  cases.push_back(named("beyond S", around(delta + 70)));
  cases.push_back(named("between the planes", around(0.6 * delta)));
  cases.push_back(named("near U", around(1e-3)));
  cases.push_back(named("behind U", around(-20, {0.1, 0, 1})));
  cases.push_back(named("on U", around(0)));
  cases.push_back(named("1e5 mm away", at({2e4, -1e4}, 1e5)));
  cases.push_back(named("n flipped", around(delta + 70, {0.2, -0.1, 1})));
  cases.push_back(named("grazing: horizons cut supports", around(delta + 40, {0.98, 0.15, -0.05})));
  cases.push_back(named("grazing near U", around(6, {0.9, 0.4, -0.03})));
  const Vec3 far(500, 700, 2000), axis = Vec3(-700, 500, 0).normalized();
  cases.push_back(
      named("grazing far away", {{far, (axis.cross(far).normalized() + 1e-3 * Vec3(0, 0, -1)).normalized()}}));
  cases.push_back(named("supports partly off the images", at({33, 0}, delta + 40)));
  cases.push_back(named("supports wholly off the images", at({300, 0}, delta + 40)));
}

void add_luminaire_cases(std::vector<StabilityCase>& cases) {
  const std::vector<Receiver> usual = around(delta + 70);
  StabilityCase base = named("S not centred over U", usual);
  base.geometry.measurement.center_mm = {21, -12};
  base.geometry.sampling.center_mm = {-3, 2};
  cases.push_back(base);

  base = named("one pixel 1e6 brighter", usual);
  for (CellImage& cell : base.cells) cell.value[44 * 18 + 22] = 1e6F;
  cases.push_back(base);
  base.name = "one pixel 1e6 brighter, beside what is seen";
  for (CellImage& cell : base.cells) std::swap(cell.value[44 * 18 + 22], cell.value[44 * 2 + 22]);
  cases.push_back(base);

  base = named("no light", usual);
  for (CellImage& cell : base.cells) cell.value.assign(cell.plane(), 0);
  cases.push_back(base);
  base = named("light that cancels", usual);
  for (CellImage& cell : base.cells)
    for (std::size_t k = 0; k < cell.plane(); ++k) cell.value[k] = (k + k / 44) % 2 ? 1.0F : -1.0F;
  cases.push_back(base);
  base = named("negative light", usual);
  base.cells = random_cells(base.geometry, -0.5F, 2);
  cases.push_back(base);
  base = named("missing cells", usual);
  for (const std::size_t k : {std::size_t(0), std::size_t(5), std::size_t(6)}) base.cells[k] = {};
  cases.push_back(base);
  base.name = "no cell at all";
  for (CellImage& cell : base.cells) cell = {};
  cases.push_back(base);
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    base = named(std::isnan(bad) ? "NaN in a cell" : "Inf in a cell", usual);
    base.cells[7].value[100] = bad;
    cases.push_back(base);
  }
  base = named("NaN in a receiver", {{{3, std::nan(""), 100}, {0, 0, -1}}});
  cases.push_back(base);

  base = named("one cell", usual);
  base.geometry.sampling.columns = base.geometry.sampling.rows = 1;
  base.cells.resize(1);
  cases.push_back(base);
  base.name = "one cell of one pixel";
  base.geometry.measurement = {1, 1, {30, 30}, {0, 0}};
  base.cells = random_cells(base.geometry, 0.5F);
  cases.push_back(base);
  base = named("fewer samples than cells", usual);
  base.samples = 5;
  cases.push_back(base);
  for (const BasisKind basis : {BasisKind::box, BasisKind::tent, BasisKind::bspline2}) {
    base = named("basis " + std::string(to_string(basis)), usual);
    base.geometry = small_geometry(basis);
    cases.push_back(base);
  }
}

void add_size_cases(std::vector<StabilityCase>& cases) {
  StabilityCase base = named("pyramid of 300x300", at({20, -15}, 600));
  base.geometry.planes.separation_mm = 150;
  base.geometry.sampling = {BasisKind::bell, {7.5, 7.5}, 2, 2, {0, 0}};
  base.geometry.measurement = {300, 300, {1, 1}, {0, 0}};
  base.cells = random_cells(base.geometry, 0.9F);  // whose level of detail has a bound of use
  base.lod = 4;
  cases.push_back(base);

  base = named("bright 4k images", at({20, -15}, 600));
  base.geometry.planes.separation_mm = 150;
  base.geometry.sampling = {BasisKind::bell, {7.5, 7.5}, 1, 1, {0, 0}};
  base.geometry.measurement = {4096, 2160, {0.125, 0.125}, {0, 0}};
  base.cells = random_cells(base.geometry);
  for (float& v : base.cells[0].value) v *= 1e4F;
  base.cells[0].value[4096 * 300 + 700] = 1e10F;
  cases.push_back(base);

  for (const double ratio : {2.0, 20.0, 200.0}) {
    base = named("δ/a = " + std::to_string(static_cast<int>(ratio)), {});
    const double separation = 8 * ratio;
    base.geometry.planes.separation_mm = separation;
    for (const double z : {1.3, 2.0, 4.0})
      base.receivers.push_back({{2 * z, -1.5 * z, z * separation}, Vec3(0.2, -0.1, -1).normalized()});
    cases.push_back(base);
  }
}

}  // namespace

std::vector<StabilityCase> stability_cases() {
  std::vector<StabilityCase> cases;
  add_receiver_cases(cases);
  add_luminaire_cases(cases);
  add_size_cases(cases);
  return cases;
}

StabilityCase with_look(StabilityCase each, StabilityLook look) {
  if (look == StabilityLook::plain) return each;
  each.name += look == StabilityLook::half_shadow ? ", in half-shadow" : ", glossy in half-shadow";
  TileVisibility& visible = each.appearance.visible;
  visible = {TileGrid(each.geometry.sampling), ShadowWeighing::tile, {}};
  visible.words.assign(each.receivers.size() * visible.receiver_words(), 0);
  for (std::size_t k = 0; k < each.receivers.size(); ++k)
    for (int row = 0; row < visible.grid.rows; ++row)
      for (int column = 0; column < visible.grid.columns; ++column)
        if ((2 * column + 3 * row + static_cast<int>(k)) % 5 < 3 - (column + row) % 2) visible.set_seen(k, column, row);
  if (look == StabilityLook::half_shadow) return each;
  constexpr float roughness = 0.3F;
  const Vec2 center = each.geometry.sampling.center_mm;
  for (const Receiver& r : each.receivers) {
    const Vec3 to_light = (Vec3(center.x(), center.y(), 0) - r.p_mm).normalized();
    const Vec3 eye = 2 * r.n.dot(to_light) * r.n - to_light;
    each.appearance.gloss.push_back({static_cast<float>(eye.x()), static_cast<float>(eye.y()),
                                     static_cast<float>(eye.z()), roughness * roughness, 0.04F, 0.04F, 0.04F,
                                     LOBE_GGX});
  }
  return each;
}

}  // namespace lumifield
