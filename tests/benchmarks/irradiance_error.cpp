// Receivers before a lamp, and the error of one table of irradiances against another.
//   irradiance_error points NEAR_MM FAR_MM COUNT SEED > points.csv
//   irradiance_error lit TRUTH.csv COUNT > points.csv     the first COUNT whose E_Y·d² is at least 1 % of the largest
//   irradiance_error compare MEASURED.csv REFERENCE.csv [LIMIT]
// compare prints, per channel E_* of MEASURED, the relative RMSE (RMS error over the mean of the reference) and the
// median and largest |error|/reference; with LIMIT it fails when a relative RMSE is above it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "luminaire/geometry.h"
#include "tests/support/csv_table.h"

using lumifield::Vec3;

namespace {

/// Distances uniform in NEAR … FAR from the centre of plane U, directions uniform over slopes |x/z|, |y/z| ≤ 0.8 (all
/// of it inside what a ±45° screen measures), normals towards the lamp, tilted by up to 60°.
void print_points(double near_mm, double far_mm, int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::puts("x_mm,y_mm,z_mm,nx,ny,nz");
  for (int k = 0; k < count; ++k) {
    const Vec3 direction = Vec3(1.6 * unit(random) - 0.8, 1.6 * unit(random) - 0.8, 1).normalized();
    const Vec3 p = direction * (near_mm + (far_mm - near_mm) * unit(random));
    const Vec3 towards = -direction;
    const Vec3 across = towards.cross(Vec3::UnitX()).normalized(), up = towards.cross(across);
    const double tilt = std::numbers::pi / 3 * std::sqrt(unit(random)), turn = 2 * std::numbers::pi * unit(random);
    const Vec3 n = std::cos(tilt) * towards + std::sin(tilt) * (std::cos(turn) * across + std::sin(turn) * up);
    std::printf("%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
}

/// Where the lamp shines: elsewhere a relative error says nothing, and dark receivers only dilute the mean.
int print_lit(const std::string& truth_file, int count) {
  const auto table = lumifield::test::read_csv_table(truth_file);
  const std::size_t n = table.at("E_Y").size();
  std::vector<double> intensity(n);
  for (std::size_t k = 0; k < n; ++k)
    intensity[k] =
        table.at("E_Y")[k] * Vec3(table.at("x_mm")[k], table.at("y_mm")[k], table.at("z_mm")[k]).squaredNorm();
  const double least = 0.01 * *std::max_element(intensity.begin(), intensity.end());
  std::puts("x_mm,y_mm,z_mm,nx,ny,nz");
  for (std::size_t k = 0; k < n && count > 0; ++k) {
    if (intensity[k] < least) continue;
    for (const char* name : {"x_mm", "y_mm", "z_mm", "nx", "ny"}) std::printf("%.17g,", table.at(name)[k]);
    std::printf("%.17g\n", table.at("nz")[k]);
    --count;
  }
  return count > 0;
}

int compare(const std::string& measured_file, const std::string& reference_file, double limit) {
  const auto measured = lumifield::test::read_csv_table(measured_file);
  const auto reference = lumifield::test::read_csv_table(reference_file);
  int compared = 0, above = 0;
  for (const auto& [name, values] : measured) {
    if (!name.starts_with("E_")) continue;
    const std::vector<double>& truth = reference.at(name);
    double squares = 0, sum = 0;
    std::vector<double> relative;
    for (std::size_t k = 0; k < values.size(); ++k) {
      squares += (values[k] - truth[k]) * (values[k] - truth[k]);
      sum += truth[k];
      relative.push_back(std::abs(values[k] - truth[k]) / std::abs(truth[k]));
    }
    const double n = static_cast<double>(values.size()), rmse = std::sqrt(squares / n) / (sum / n);
    std::sort(relative.begin(), relative.end());
    std::printf("%s relative_rmse %.5f median %.5f largest %.5f points %zu\n", name.c_str(), rmse,
                relative[relative.size() / 2], relative.back(), values.size());
    ++compared;
    if (!(rmse <= limit)) ++above;
  }
  if (compared == 0) std::fprintf(stderr, "no E_ columns in %s\n", measured_file.c_str());
  return compared == 0 || above > 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "points" && argc == 6) {
    print_points(std::atof(argv[2]), std::atof(argv[3]), std::atoi(argv[4]), static_cast<unsigned>(std::atoi(argv[5])));
    return 0;
  }
  if (what == "lit" && argc == 4) return print_lit(argv[2], std::atoi(argv[3]));
  if (what == "compare" && argc >= 4) return compare(argv[2], argv[3], argc > 4 ? std::atof(argv[4]) : INFINITY);
  std::fprintf(stderr,
               "usage: irradiance_error points NEAR_MM FAR_MM COUNT SEED | lit TRUTH.csv COUNT | compare MEASURED.csv "
               "REFERENCE.csv [LIMIT]\n");
  return 2;
}
