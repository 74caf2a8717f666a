#include "luminaire/light_field.h"

#include <cmath>

namespace lumifield {

std::string to_string(CellIndex cell) {
  std::string text = "(";
  return text.append(std::to_string(cell.row)).append(", ").append(std::to_string(cell.column)).append(")");
}

std::string_view to_string(Quantity q) {
  switch (q) {
    case Quantity::radiance:
      return "radiance";
    case Quantity::luminance:
      return "luminance";
    case Quantity::relative:
      return "relative";
  }
  return "";
}

std::string_view unit_of(Quantity q) {
  switch (q) {
    case Quantity::radiance:
      return "W/(m^2 sr)";
    case Quantity::luminance:
      return "cd/m^2";
    case Quantity::relative:
      return "relative";
  }
  return "";
}

std::string_view irradiance_unit_of(Quantity q) {
  switch (q) {
    case Quantity::radiance:
      return "W/m^2";
    case Quantity::luminance:
      return "lx";
    case Quantity::relative:
      return "relative";
  }
  return "";
}

Status check_image(const LuminaireGeometry& geometry, const CellImage& image, std::string_view where) {
  const Measurement& m = geometry.measurement;
  const std::size_t values = m.pixels() * geometry.channels.size();
  if (image.width_px != m.width_px || image.height_px != m.height_px ||
      image.channels != static_cast<int>(geometry.channels.size()) || image.value.size() != values ||
      (!image.variance.empty() && image.variance.size() != values))
    return fail("has another size or number of channels than the luminaire", std::string(where),
                "use the luminaire that it was measured for");
  const auto refuse = [&](const char* what, const char* suffix, std::size_t k) {
    const std::size_t pixel = k % m.pixels(), width = static_cast<std::size_t>(m.width_px);
    return fail(what,
                std::string(where) + ": channel " + geometry.channels[k / m.pixels()] + suffix + ": pixel (" +
                    std::to_string(pixel % width) + ", " + std::to_string(pixel / width) + ")",
                "measure the cell again");
  };
  for (std::size_t k = 0; k < image.value.size(); ++k)
    if (!std::isfinite(image.value[k])) return refuse("holds NaN or Inf", "", k);
  for (std::size_t k = 0; k < image.variance.size(); ++k)
    if (!std::isfinite(image.variance[k]) || image.variance[k] < 0)
      return refuse("holds NaN, Inf or a negative number", ".variance", k);
  return {};
}

Status check_cell(const LuminaireGeometry& geometry, CellIndex cell, const CellImage& image) {
  const std::string where = "cell " + to_string(cell);
  if (!geometry.sampling.contains(cell)) return fail("lies outside the grid of cells", where, "check row and column");
  return check_image(geometry, image, where);
}

LightField::LightField(LuminaireGeometry geometry)
    : geometry_(std::move(geometry)), cells_(static_cast<std::size_t>(geometry_.sampling.cells())) {}

Status LightField::add(CellIndex cell, CellImage image) {
  return add(cell, std::make_shared<const CellImage>(std::move(image)));
}

Status LightField::add(CellIndex cell, std::shared_ptr<const CellImage> image) {
  if (Status ok = check_cell(geometry_, cell, *image); !ok) return ok;
  cells_[static_cast<std::size_t>(geometry_.sampling.flat(cell))] = std::move(image);
  return {};
}

std::shared_ptr<const CellImage> LightField::cell(CellIndex cell) const {
  if (!geometry_.sampling.contains(cell)) return nullptr;
  return cells_[static_cast<std::size_t>(geometry_.sampling.flat(cell))];
}

Coverage LightField::coverage() const {
  Coverage coverage;
  coverage.total = geometry_.sampling.cells();
  for (int k = 0; k < coverage.total; ++k)
    if (cells_[static_cast<std::size_t>(k)])
      ++coverage.measured;
    else
      coverage.missing.push_back(geometry_.sampling.index(k));
  return coverage;
}

}  // namespace lumifield
