#include "luminaire/neighbours.h"

#include <cmath>
#include <limits>
#include <vector>

namespace lumifield {

double neighbour_difference(const Sampling& sampling, CellIndex cell,
                            const std::function<const CellImage*(CellIndex)>& image_of) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const CellImage* own = image_of(cell);
  if (!own) return unknown;
  std::vector<const CellImage*> around;
  for (const CellIndex at : {CellIndex{cell.row - 1, cell.column}, CellIndex{cell.row + 1, cell.column},
                             CellIndex{cell.row, cell.column - 1}, CellIndex{cell.row, cell.column + 1}}) {
    if (!sampling.contains(at)) continue;
    const CellImage* image = image_of(at);
    if (image && image->value.size() == own->value.size()) around.push_back(image);
  }
  if (around.empty()) return unknown;

  double apart = 0, together = 0;
  const float share = 1.0F / static_cast<float>(around.size());
  for (std::size_t i = 0; i < own->value.size(); ++i) {
    float mean = 0;
    for (const CellImage* image : around) mean += image->value[i];
    mean *= share;
    apart += std::abs(own->value[i] - mean);
    together += std::abs(own->value[i]) + std::abs(mean);
  }
  return together > 0 ? apart / together : unknown;
}

}  // namespace lumifield
