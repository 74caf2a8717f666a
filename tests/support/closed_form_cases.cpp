#include "tests/support/closed_form_cases.h"

#include <Eigen/Geometry>
#include <cstdlib>
#include <random>

namespace lumifield {

LightField random_luminaire(BasisKind basis, int channels, unsigned seed) {
  LuminaireGeometry g;
  g.planes.separation_mm = 48;
  g.sampling = {basis, {5, 6.5}, 4, 3, {1.25, -2.5}};
  g.measurement = {44, 37, {1.5, 1.25}, {-4, 2.875}};
  g.channels = channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  LightField field(g);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-0.5f, 1.0f);
  std::uniform_int_distribution<int> pixel(0, int(g.measurement.pixels()) - 1);
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    if (flat % 5 == 3) continue;
    CellImage image{g.measurement.width_px, g.measurement.height_px, channels, {}, {}, {}};
    image.value.resize(image.plane() * static_cast<std::size_t>(channels));
    for (float& v : image.value) v = value(random);
    for (int c = 0; c < channels; ++c) image.channel(c)[pixel(random)] = 1e6f;
    if (!field.add(g.sampling.index(flat), std::move(image))) std::abort();
  }
  return field;
}

std::vector<ReceiverCase> receiver_cases(const LuminaireGeometry& g, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  const double delta = g.planes.separation_mm;
  const Vec2 edge = g.measurement.corner_mm() + Vec2(20 * g.measurement.pixel_mm.x(), 18 * g.measurement.pixel_mm.y());
  const Vec3 down(0, 0, -1), up(0, 0, 1);
  const auto tilted = [&] { return Vec3(0.4 * unit(random), 0.4 * unit(random), -1).normalized(); };
  std::vector<ReceiverCase> cases;
  for (int repeat = 0; repeat < 6; ++repeat) {
    const double x = 15 * unit(random), y = 12 * unit(random);
    cases.push_back({"beyond S", {x, y, delta + 60 + 50 * unit(random)}, tilted()});
    cases.push_back({"just beyond S", {x, y, delta + 2 + unit(random)}, tilted()});
    cases.push_back({"between the planes", {x, y, delta * (0.6 + 0.3 * unit(random))}, tilted()});
    cases.push_back({"near U", {x / 2, y / 2, 1e-3}, tilted()});
    cases.push_back({"close to U", {x / 2, y / 2, 1.5 + unit(random)}, tilted()});
    cases.push_back({"1e4 mm", {3000 * unit(random), 3000 * unit(random), 1e4}, tilted()});
    cases.push_back({"1e5 mm", {3e4 * unit(random), 3e4 * unit(random), 1e5}, tilted()});
    cases.push_back({"beside the images", {x + 45, y - 35, delta + 30 + 20 * unit(random)}, tilted()});
    cases.push_back({"n flipped", {x, y, delta + 60 + 50 * unit(random)}, -tilted()});
    const Vec3 along(unit(random), unit(random), 0.05 * unit(random));
    cases.push_back({"grazing beyond S", {x, y, delta + 40}, along.normalized(), true});
    cases.push_back({"grazing between", {x / 4, y / 4, 6}, along.normalized(), true});
    const Vec3 far(500 * unit(random), 700 * unit(random), 2000);
    const Vec3 axis = Vec3(-far.y(), far.x(), 0).normalized();
    cases.push_back({"grazing near U", {x / 4, y / 4, 1e-3}, along.normalized(), true});
    cases.push_back({"grazing far away", far, axis.cross(far).normalized() + 1e-3 * tilted(), true});
    for (double beyond : {0.0, -0.0, 1e-9, -1e-9, 1e-4, -1e-4}) {
      cases.push_back({"on S", {x, y, delta + beyond}, tilted()});
      cases.push_back({"on S, p_x on an edge", {edge.x(), y, delta + beyond}, tilted()});
      cases.push_back({"on S, on a corner", {edge.x(), edge.y(), delta + beyond}, tilted()});
      cases.push_back({"on S, grazing", {edge.x(), y, delta + beyond}, {0.999, 0.02, -0.04 * unit(random)}, true});
    }
  }
  cases.push_back({"on U", {1, 2, 0}, down});
  cases.push_back({"behind U", {1, 2, -20}, up});
  cases.push_back({"behind U", {1, 2, -20}, down});
  for (ReceiverCase& each : cases) each.n.normalize();
  return cases;
}

}  // namespace lumifield
