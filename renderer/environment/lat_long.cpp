#include "renderer/environment/lat_long.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/scene/texture.h"

namespace lumifield {

using std::numbers::pi;

LatLong::LatLong(int width_px, int height_px, std::vector<float> rgb)
    : width_(width_px), height_(height_px), rgb_(std::make_shared<const std::vector<float>>(std::move(rgb))) {}

Result<LatLong> LatLong::read(const std::filesystem::path& file) {
  Result<Texture> image = read_texture(file);
  if (!image) return tl::unexpected(image.error());
  if (image->width_px != 2 * image->height_px)
    return fail("is an image of " + std::to_string(image->width_px) + " x " + std::to_string(image->height_px) +
                    " pixels, no latitude-longitude map",
                file.string(), "give one that is twice as wide as high");
  LatLong environment(image->width_px, image->height_px, std::move(image->rgb));
  environment.note_ = std::move(image->note);
  return environment;
}

std::array<double, 3> LatLong::pixel(int i, int j) const {
  const std::size_t at =
      3 * (static_cast<std::size_t>(j) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(i));
  return {(*rgb_)[at], (*rgb_)[at + 1], (*rgb_)[at + 2]};
}

std::array<int, 2> LatLong::pixel_at(const Vec3& d) const {
  const double x = (std::atan2(d.x(), d.y()) / (2 * pi) + 0.5) * width_;
  const double y = std::atan2(std::hypot(d.x(), d.y()), d.z()) / pi * height_;
  return {std::clamp(static_cast<int>(x), 0, width_ - 1), std::clamp(static_cast<int>(y), 0, height_ - 1)};
}

std::array<double, 3> LatLong::radiance(const Vec3& d) const {
  const auto [i, j] = pixel_at(d);
  return pixel(i, j);
}

Vec3 LatLong::direction(double i, double j) const {
  const double turn = 2 * pi * (i / width_ - 0.5), theta = pi * j / height_;
  return {std::sin(theta) * std::sin(turn), std::sin(theta) * std::cos(turn), std::cos(theta)};
}

double LatLong::solid_angle(int j) const {
  return 2 * pi / width_ * (std::cos(pi * j / height_) - std::cos(pi * (j + 1) / height_));
}

}  // namespace lumifield
