#include "app/views/mask_reduction.h"

#include <vector>

namespace lumifield {

QImage reduce_mask(const QImage& mask, const QSize& size) {
  QImage reduced(size, QImage::Format_ARGB32_Premultiplied);
  reduced.fill(Qt::transparent);
  if (mask.isNull() || size.isEmpty()) return reduced;
  std::vector<int> column(static_cast<std::size_t>(mask.width()));
  for (int x = 0; x < mask.width(); ++x)
    column[static_cast<std::size_t>(x)] = static_cast<int>(static_cast<qint64>(x) * size.width() / mask.width());
  for (int y = 0; y < mask.height(); ++y) {
    const auto* from = reinterpret_cast<const QRgb*>(mask.constScanLine(y));
    auto* to = reinterpret_cast<QRgb*>(
        reduced.scanLine(static_cast<int>(static_cast<qint64>(y) * size.height() / mask.height())));
    for (int x = 0; x < mask.width(); ++x)
      if (qAlpha(from[x]) > 0) to[column[static_cast<std::size_t>(x)]] = from[x];
  }
  return reduced;
}

}  // namespace lumifield
