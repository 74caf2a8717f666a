#include "app/views/camera_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/screen_resampler.h"

namespace lumifield {

namespace {

constexpr int histogram_bits = 8;

/// sRGB code of each DN, full scale = 255.
std::vector<std::uint8_t> display_codes(int bits) {
  std::vector<std::uint8_t> codes(std::size_t{1} << bits);
  const double full = static_cast<double>(codes.size() - 1);
  for (std::size_t dn = 0; dn < codes.size(); ++dn) {
    const double light = static_cast<double>(dn) / full;
    const double code = light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
    codes[dn] = static_cast<std::uint8_t>(std::lround(255 * code));
  }
  return codes;
}

/// The photosites of a frame, none beyond full scale.
struct Frame {
  explicit Frame(const RawImage& image)
      : raw(image),
        width(image.width_px),
        full(static_cast<std::uint16_t>((1U << std::clamp(image.bits, 1, 16)) - 1)) {}

  std::uint16_t at(int column, int row) const {
    return std::min(
        full,
        raw.dn[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)]);
  }

  const RawImage& raw;
  int width;
  std::uint16_t full;
};

QImage photosite_image(const Frame& frame, const std::vector<std::uint8_t>& codes) {
  QImage image(frame.raw.width_px, frame.raw.height_px, QImage::Format_Grayscale8);
  for (int row = 0; row < image.height(); ++row) {
    std::uint8_t* line = image.scanLine(row);
    for (int column = 0; column < image.width(); ++column) line[column] = codes[frame.at(column, row)];
  }
  return image;
}

/// R, mean G, B of the block whose first photosite this is.
std::array<int, 3> block_dn(const Frame& frame, int column, int row) {
  std::array<int, 3> sum{};
  for (const int dy : {0, 1})
    for (const int dx : {0, 1})
      sum[static_cast<std::size_t>(photosite_channel(frame.raw.pattern, column + dx, row + dy))] +=
          frame.at(column + dx, row + dy);
  sum[1] /= 2;
  return sum;
}

QImage block_image(const Frame& frame, const std::vector<std::uint8_t>& codes) {
  QImage image(frame.raw.width_px / 2, frame.raw.height_px / 2, QImage::Format_RGB32);
  for (int row = 0; row < image.height(); ++row) {
    auto* line = reinterpret_cast<QRgb*>(image.scanLine(row));
    for (int column = 0; column < image.width(); ++column) {
      const auto [r, g, b] = block_dn(frame, 2 * column, 2 * row);
      line[column] = qRgb(codes[static_cast<std::size_t>(r)], codes[static_cast<std::size_t>(g)],
                          codes[static_cast<std::size_t>(b)]);
    }
  }
  return image;
}

Histogram histogram_of(const Frame& frame) {
  const int bits = std::clamp(frame.raw.bits, 1, 16), shift = std::max(0, bits - histogram_bits);
  Histogram histogram;
  histogram.counts.resize(std::size_t{1} << (bits - shift));
  histogram.to = static_cast<double>(frame.full) + 1;
  histogram.axis = "signal";
  histogram.unit = "DN";
  histogram.counted = "pixels";
  for (const std::uint16_t dn : frame.raw.dn)
    ++histogram.counts[static_cast<std::size_t>(std::min(dn, frame.full) >> shift)];
  return histogram;
}

/// A pixel is marked when any of its photosites is over-exposed.
QImage mask_of(const RawImage& raw, double saturation_dn, int step) {
  QImage mask(raw.width_px / step, raw.height_px / step, QImage::Format_ARGB32_Premultiplied);
  mask.fill(Qt::transparent);
  const auto width = static_cast<std::size_t>(raw.width_px);
  for (int row = 0; row < mask.height() * step; ++row) {
    auto* line = reinterpret_cast<QRgb*>(mask.scanLine(row / step));
    const std::uint16_t* dn = raw.dn.data() + static_cast<std::size_t>(row) * width;
    for (int column = 0; column < mask.width() * step; ++column)
      if (dn[column] >= saturation_dn) line[column / step] = qRgb(230, 0, 0);
  }
  return mask;
}

}  // namespace

CameraPicture make_camera_picture(std::shared_ptr<const Bracket> bracket, std::size_t exposure, double saturation_dn,
                                  CameraColours colours) {
  CameraPicture picture;
  picture.bracket = std::move(bracket);
  picture.exposure = exposure;
  const RawImage& raw = picture.raw();
  const bool blocks = colours == CameraColours::blocks && raw.pattern != SensorPattern::mono;
  picture.step = blocks ? 2 : 1;
  const Frame frame(raw);
  const std::vector<std::uint8_t> codes = display_codes(std::clamp(raw.bits, 1, 16));
  picture.image = blocks ? block_image(frame, codes) : photosite_image(frame, codes);
  picture.histogram = histogram_of(frame);
  picture.saturated = static_cast<std::uint64_t>(
      std::count_if(raw.dn.begin(), raw.dn.end(), [&](std::uint16_t dn) { return dn >= saturation_dn; }));
  if (!raw.dn.empty())
    picture.saturated_share = static_cast<double>(picture.saturated) / static_cast<double>(raw.dn.size());
  if (picture.saturated > 0) picture.mask = mask_of(raw, saturation_dn, picture.step);
  return picture;
}

QString pixel_text(const CameraPicture& picture, int column, int row) {
  if (!picture.image.rect().contains(column, row)) return {};
  const RawImage& raw = picture.raw();
  const Frame frame(raw);
  column *= picture.step;
  row *= picture.step;
  const QString place = QString("column %1, row %2: ").arg(column).arg(row);
  if (picture.step == 2) {
    const auto [r, g, b] = block_dn(frame, column, row);
    return place + QString("R %1, G %2, B %3 DN").arg(r).arg(g).arg(b);
  }
  const QString colour = raw.pattern == SensorPattern::mono
                             ? QString()
                             : QString(" ") + "RGB"[photosite_channel(raw.pattern, column, row)];
  return place + QString("%1 DN").arg(frame.at(column, row)) + colour;
}

QString exposure_text(double exposure_s) {
  return exposure_s < 0.9995 ? QString::number(1000 * exposure_s, 'g', 3) + " ms"
                             : QString::number(exposure_s, 'g', 3) + " s";
}

}  // namespace lumifield
