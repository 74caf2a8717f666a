#include "calibration/screen_resampler.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace lumifield {
namespace {

struct Corner {
  double x, y;
};

/// A footprint or a piece of one, in pixels of S. A quadrilateral gains at most two corners by each of the four cuts
/// that bound a pixel.
struct Polygon {
  int count = 0;
  std::array<Corner, 16> corner;

  void add(const Corner& c) {
    if (count < 16) corner[static_cast<std::size_t>(count++)] = c;
  }
  double area() const {
    double twice = 0;
    for (std::size_t i = 2; i < static_cast<std::size_t>(count); ++i) {
      const Corner &o = corner[0], &a = corner[i - 1], &b = corner[i];
      twice += (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    }
    return std::abs(twice) / 2;
  }
};

/// Cuts a polygon along x = at (or y = at) into the part below and the part above.
template <double Corner::*axis>
void cut(const Polygon& whole, double at, Polygon& below, Polygon& above) {
  below.count = above.count = 0;
  Corner previous = whole.corner[static_cast<std::size_t>(whole.count - 1)];
  for (std::size_t i = 0; i < static_cast<std::size_t>(whole.count); ++i) {
    const Corner current = whole.corner[i];
    const double d0 = previous.*axis - at, d1 = current.*axis - at;
    if ((d0 < 0) != (d1 < 0)) {
      const double f = d0 / (d0 - d1);
      Corner crossing{previous.x + f * (current.x - previous.x), previous.y + f * (current.y - previous.y)};
      crossing.*axis = at;
      below.add(crossing);
      above.add(crossing);
    }
    (d1 < 0 ? below : above).add(current);
    previous = current;
  }
}

/// Splits a polygon that spans [low, high] of an axis at the pixel edges and hands each piece inside [0, size) to
/// `take`.
template <double Corner::*axis, class Take>
void split(Polygon rest, double low, double high, int size, Take take) {
  Polygon piece, above;
  int i = 0;
  if (low < 0) {
    cut<axis>(rest, 0, piece, above);
    rest = above;
  } else {
    i = static_cast<int>(low);
  }
  const int last = static_cast<int>(std::min<double>(size - 1, high));
  for (; i < last && rest.count > 2; ++i) {
    cut<axis>(rest, i + 1, piece, above);
    if (piece.count > 2) take(i, piece);
    rest = above;
  }
  if (high > size && rest.count > 2) {
    cut<axis>(rest, size, piece, above);
    rest = piece;
  }
  if (i == last && rest.count > 2) take(i, rest);
}

struct Entry {
  std::uint32_t pixel, photosite;
  float area;
};

/// Collects the overlaps of one channel, photosite by photosite.
class Overlaps {
 public:
  explicit Overlaps(const Measurement& screen) : width_(screen.width_px), height_(screen.height_px) {}

  void add(std::uint32_t photosite, const Polygon& quad) {
    // Bound the footprint
    double x0 = quad.corner[0].x, x1 = x0, y0 = quad.corner[0].y, y1 = y0;
    for (std::size_t i = 1; i < 4; ++i) {
      x0 = std::min(x0, quad.corner[i].x), x1 = std::max(x1, quad.corner[i].x);
      y0 = std::min(y0, quad.corner[i].y), y1 = std::max(y1, quad.corner[i].y);
    }
    if (!(x1 > 0 && y1 > 0 && x0 < width_ && y0 < height_)) return;

    // Take it whole where one pixel holds it
    if (x0 >= 0 && y0 >= 0 && x1 < width_ && y1 < height_ && static_cast<int>(x0) == static_cast<int>(x1) &&
        static_cast<int>(y0) == static_cast<int>(y1))
      return emit(static_cast<int>(x0), static_cast<int>(y0), photosite, quad.area());

    // Else cut it into columns, and those into rows
    split<&Corner::x>(quad, x0, x1, width_, [&](int i, const Polygon& column) {
      double low = column.corner[0].y, high = low;
      for (std::size_t k = 1; k < static_cast<std::size_t>(column.count); ++k)
        low = std::min(low, column.corner[k].y), high = std::max(high, column.corner[k].y);
      if (high <= 0 || low >= height_) return;
      split<&Corner::y>(column, low, high, height_,
                        [&](int j, const Polygon& piece) { emit(i, j, photosite, piece.area()); });
    });
  }

  std::vector<Entry> entries;

 private:
  void emit(int i, int j, std::uint32_t photosite, double area) {
    if (area > 0)
      entries.push_back(
          {static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(width_) + static_cast<std::uint32_t>(i),
           photosite, static_cast<float>(area)});
  }

  int width_, height_;
};

/// Orders the entries by pixel of S, photosites ascending within each.
OverlapWeights by_pixel(const std::vector<Entry>& entries, std::size_t pixels) {
  OverlapWeights weights;
  weights.first.assign(pixels + 1, 0);
  for (const Entry& e : entries) ++weights.first[e.pixel + 1];
  for (std::size_t p = 0; p < pixels; ++p) weights.first[p + 1] += weights.first[p];
  std::vector<std::uint32_t> next(weights.first.begin(), weights.first.end() - 1);
  weights.photosite.resize(entries.size());
  weights.area.resize(entries.size());
  for (const Entry& e : entries) {
    const std::uint32_t at = next[e.pixel]++;
    weights.photosite[at] = e.photosite;
    weights.area[at] = e.area;
  }
  return weights;
}

double smallest_coverage(const OverlapWeights& weights, double multiplicity) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t p = 0; p + 1 < weights.first.size(); ++p) {
    double sum = 0;
    for (std::uint32_t e = weights.first[p]; e < weights.first[p + 1]; ++e) sum += static_cast<double>(weights.area[e]);
    smallest = std::min(smallest, sum / multiplicity);
  }
  return smallest;
}

}  // namespace

int photosite_channel(SensorPattern pattern, int column, int row) {
  // Position of R in the 2×2 tile; B stands across from it
  int red_column = 0, red_row = 0;
  switch (pattern) {
    case SensorPattern::mono:
      return 0;
    case SensorPattern::rggb:
      break;
    case SensorPattern::grbg:
      red_column = 1;
      break;
    case SensorPattern::gbrg:
      red_row = 1;
      break;
    case SensorPattern::bggr:
      red_column = red_row = 1;
      break;
  }
  const bool x = (column & 1) == red_column, y = (row & 1) == red_row;
  return x && y ? 0 : !x && !y ? 2 : 1;
}

ScreenLattice trace_lattice(const LensModel& lens, const CameraModel& camera, SensorPattern pattern, double z_mm) {
  const bool mono = pattern == SensorPattern::mono;
  ScreenLattice lattice;
  lattice.first_px = mono ? -0.5 : -1;
  lattice.columns = camera.width_px + (mono ? 1 : 2);
  lattice.rows = camera.height_px + (mono ? 1 : 2);
  const std::size_t points = static_cast<std::size_t>(lattice.columns) * static_cast<std::size_t>(lattice.rows);
  lattice.x_mm.assign(points, std::numeric_limits<double>::quiet_NaN());
  lattice.y_mm = lattice.x_mm;

  std::size_t at = 0;
  for (int j = 0; j < lattice.rows; ++j) {
    Vec2 start = Vec2::Zero();
    for (int i = 0; i < lattice.columns; ++i, ++at) {
      const auto ray = lens.undistort(Vec2(lattice.first_px + i, lattice.first_px + j), start);
      start = ray.value_or(Vec2::Zero());
      if (!ray) continue;
      if (const auto s = lens.meet_plane(*ray, z_mm)) lattice.x_mm[at] = s->x(), lattice.y_mm[at] = s->y();
    }
  }
  return lattice;
}

OverlapWeights overlap_weights(const ScreenLattice& lattice, const PhotositeSet& set, const Measurement& screen,
                               const Vec2& displacement_mm) {
  const Vec2 corner = screen.corner_mm() + displacement_mm;
  const double per_x = 1 / screen.pixel_mm.x(), per_y = 1 / screen.pixel_mm.y();
  const auto columns = static_cast<std::size_t>(lattice.columns);
  const int reach = set.reach(), width = lattice.columns - reach, height = lattice.rows - reach;
  Overlaps overlaps(screen);

  Polygon quad;
  quad.count = 4;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      if (reach == 2 && photosite_channel(set.pattern, i, j) != set.channel) continue;
      const std::size_t top = static_cast<std::size_t>(j) * columns + static_cast<std::size_t>(i);
      const std::size_t across = static_cast<std::size_t>(reach), bottom = top + across * columns;
      const std::array<std::size_t, 4> at{top, top + across, bottom + across, bottom};
      double finite = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        quad.corner[k] = {(lattice.x_mm[at[k]] - corner.x()) * per_x, (lattice.y_mm[at[k]] - corner.y()) * per_y};
        finite += quad.corner[k].x + quad.corner[k].y;
      }
      if (std::isfinite(finite))
        overlaps.add(static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(width) + static_cast<std::uint32_t>(i),
                     quad);
    }
  }

  OverlapWeights weights = by_pixel(overlaps.entries, screen.pixels());
  weights.smallest_coverage = smallest_coverage(weights, set.multiplicity());
  return weights;
}

std::vector<RowSpan> photosite_rows(std::span<const OverlapWeights> weights, int width_px, int height_px) {
  std::vector<RowSpan> rows(static_cast<std::size_t>(height_px), RowSpan{width_px, 0});
  for (const OverlapWeights& w : weights) {
    for (const std::uint32_t photosite : w.photosite) {
      const auto width = static_cast<std::uint32_t>(width_px);
      RowSpan& row = rows[photosite / width];
      const int i = static_cast<int>(photosite % width);
      row.begin = std::min(row.begin, i), row.end = std::max(row.end, i + 1);
    }
  }
  return rows;
}

ScreenChannel resample(const OverlapWeights& weights, std::span<const PhotositeSignal> photosites) {
  const std::size_t pixels = weights.first.size() - 1;
  ScreenChannel out{std::vector<float>(pixels), std::vector<float>(pixels), std::vector<float>(pixels),
                    std::vector<float>(pixels)};
  for (std::size_t p = 0; p < pixels; ++p) {
    // Sum over all photosites and over the valid ones
    double all = 0, all_value = 0, all_sigma = 0, electrons = 0, valid = 0, value = 0, variance = 0;
    for (std::uint32_t e = weights.first[p]; e < weights.first[p + 1]; ++e) {
      const PhotositeSignal& site = photosites[weights.photosite[e]];
      const double w = static_cast<double>(weights.area[e]), v = w * static_cast<double>(site.valid);
      all += w;
      valid += v;
      value += v * static_cast<double>(site.value);
      variance += v * w * static_cast<double>(site.variance);
      electrons += w * static_cast<double>(site.electrons);
    }
    out.valid_share[p] = static_cast<float>(valid / all);
    out.electrons[p] = static_cast<float>(electrons / all);
    if (valid >= all / 2) {
      out.value[p] = static_cast<float>(value / valid);
      out.variance[p] = static_cast<float>(variance / (valid * valid));
      continue;
    }

    // Fall back on the lower bounds
    for (std::uint32_t e = weights.first[p]; e < weights.first[p + 1]; ++e) {
      const PhotositeSignal& site = photosites[weights.photosite[e]];
      const double w = static_cast<double>(weights.area[e]);
      all_value += w * static_cast<double>(site.value);
      all_sigma += w * std::sqrt(static_cast<double>(site.variance));
    }
    out.value[p] = static_cast<float>(all_value / all);
    out.variance[p] = static_cast<float>((all_sigma / all) * (all_sigma / all));
  }
  return out;
}

}  // namespace lumifield
