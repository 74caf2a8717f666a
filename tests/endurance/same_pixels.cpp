// Whether two datasets hold the same cells to the bit, values and variances, whatever their generations.
//   same_pixels A.lumi B.lumi [values]    with `values`: whatever their variances

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "luminaire/dataset.h"

namespace lumifield {
namespace {

/// How many of the values differ, and by how much of the largest.
std::string extent(const CellImage& a, const CellImage& b) {
  if (a.value.size() != b.value.size()) return "";
  std::size_t different = 0;
  double off = 0, largest = 0;
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    different += a.value[i] != b.value[i];
    off = std::max(off, std::abs(double(a.value[i]) - b.value[i]));
    largest = std::max(largest, double(a.value[i]));
  }
  char text[120];
  std::snprintf(text, sizeof text, ": %zu of %zu values, by up to %.2g of the largest", different, a.value.size(),
                off / largest);
  return text;
}

std::string difference(const LightField& a, const LightField& b, bool values_only) {
  if (const auto member = first_difference(a.geometry(), b.geometry())) return *member;
  for (int k = 0; k < a.geometry().sampling.cells(); ++k) {
    const CellIndex index = a.geometry().sampling.index(k);
    const auto one = a.cell(index), other = b.cell(index);
    const bool same =
        one && other ? one->value == other->value && (values_only || one->variance == other->variance) : one == other;
    if (!same) return "cell " + to_string(index) + (one && other ? extent(*one, *other) : "");
  }
  return {};
}

int run(int argc, char** argv) {
  const bool values_only = argc == 4 && std::string(argv[3]) == "values", used_well = argc == 3 || values_only;
  const auto a = read_dataset(used_well ? argv[1] : ""), b = read_dataset(used_well ? argv[2] : "");
  for (const auto* dataset : {&a, &b})
    if (!*dataset) {
      std::fprintf(stderr, "%s\n", dataset->error().message().c_str());
      return 2;
    }
  const std::string differs = difference(a->light_field, b->light_field, values_only);
  if (!differs.empty()) std::printf("%s\n", differs.c_str());
  return differs.empty() ? 0 : 1;
}

}  // namespace
}  // namespace lumifield

int main(int argc, char** argv) { return lumifield::run(argc, argv); }
