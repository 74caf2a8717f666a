#include "renderer/study/spot_error_figures.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "renderer/methods/closed_form.h"
#include "renderer/shift_invariant/constant_distance_error.h"
#include "renderer/shift_invariant/shift_invariant.h"
#include "renderer/study/relative_rmse.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {

namespace {

constexpr double separation_mm = 150, pixel_mm = 1.5, spot_sigma = 0.1;
constexpr int side_px = 440;  // to 65°

/// One cell whose light leaves towards a point of S.
LightField one_spot(double support, const Vec2& at_mm) {
  LuminaireGeometry geometry = make_luminaire({.name = "spot", .columns = 1, .rows = 1, .pixels = 1}).geometry();
  geometry.planes.separation_mm = separation_mm;
  // A bell's support is two spacings wide.
  geometry.sampling.spacing_mm = Vec2::Constant(support * separation_mm / 2);
  geometry.measurement = {side_px, side_px, Vec2::Constant(pixel_mm), Vec2::Zero()};
  CellImage image{side_px, side_px, 1, {}, {}, {}};
  for (int j = 0; j < side_px; ++j)
    for (int i = 0; i < side_px; ++i) {
      const Vec2 s = geometry.measurement.pixel_center_mm(i, j);
      image.value.push_back(
          static_cast<float>(std::exp(-0.5 * (s - at_mm).squaredNorm() / std::pow(spot_sigma * separation_mm, 2))));
    }
  LightField field(geometry);
  static_cast<void>(field.add({0, 0}, std::move(image)));
  return field;
}

/// Of receivers across the spot, so many a side, that are turned from it by 45°.
double error_of_the_method(const LightField& field, const Vec3& direction, double distance_mm) {
  constexpr int side = 24;
  const ShiftInvariant spots(field, {});
  const ClosedForm reference(field);
  const Vec3 across = direction.unitOrthogonal(), along = direction.cross(across),
             normal = (across - direction).normalized();
  RelativeRmse error;
  for (int k = 0; k < side * side; ++k) {
    const double x = (k % side + 0.5) / side - 0.5, y = (k / side + 0.5) / side - 0.5;
    const Receiver at{distance_mm * (direction + 0.3 * (x * across + y * along)), normal};
    const auto got = spots.irradiance(at, 0);
    error.add(got ? (*got)[0] : 0, reference.irradiance(at)[0]);
  }
  return error.value();
}

}  // namespace

std::vector<FigureRow> constant_distance_figures() {
  std::vector<FigureRow> rows;
  for (const double support : {0.01, 0.04, 0.1})
    for (const auto& [name, azimuth] : {std::pair("along an axis", 0.0), {"across", std::numbers::pi / 4}})
      for (int degrees = 0; degrees <= 60; degrees += 10) {
        const double theta = degrees * std::numbers::pi / 180;
        char what[96];
        std::snprintf(what, sizeof what, "support %g δ, θ0 = %d°, %s", support, degrees, name);
        const Vec3 direction(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta));
        const LightField field = one_spot(support, separation_mm * direction.head<2>() / direction.z());
        rows.push_back(
            {"Fig. 3", "one cell", what, "Er", constant_distance_error(support / 2, theta, azimuth), std::nan("")});
        for (const double far : {2.0, 10.0}) {
          char quantity[96];
          std::snprintf(quantity, sizeof quantity, "relative RMSE of the method %g δ away", far);
          rows.push_back({"Fig. 3", "one cell", what, quantity,
                          error_of_the_method(field, direction, far * separation_mm), std::nan("")});
        }
      }
  return rows;
}

}  // namespace lumifield
