#include "renderer/methods/far_field.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "renderer/methods/gloss.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

/// ∫ φ over the pixels that a support at `center_px` shows from infinity; rate: pixels per spacing.
struct AxisTaps {
  int first;
  std::vector<double> weight;
};
AxisTaps axis_taps(const Basis& basis, double center_px, double rate) {
  const double half = basis.half_support();
  AxisTaps taps{static_cast<int>(std::floor(center_px - half * rate)), {}};
  const int last = static_cast<int>(std::ceil(center_px + half * rate));
  for (int i = taps.first; i < last; ++i)
    taps.weight.push_back(basis.moment(0, (i - center_px) / rate, (i + 1 - center_px) / rate));
  return taps;
}

/// Pixels [x0, x1) × [y0, y1).
struct PixelWindow {
  int x0, x1, y0, y1;
};

/// Least and greatest value of a channel over a window, 0 beside the image.
std::pair<double, double> range_over(const CellImage& image, int c, const PixelWindow& w) {
  double least = HUGE_VAL, greatest = -HUGE_VAL;
  const auto take = [&](double v) { least = std::min(least, v), greatest = std::max(greatest, v); };
  if (w.x0 < 0 || w.y0 < 0 || w.x1 > image.width_px || w.y1 > image.height_px) take(0);
  for (int j = std::max(w.y0, 0); j < std::min(w.y1, image.height_px); ++j)
    for (int i = std::max(w.x0, 0); i < std::min(w.x1, image.width_px); ++i) take(image.at(c, i, j));
  return {least, greatest};
}

/// What true rays and those along q see through a part of a support.
PixelWindow seen_through(const ReceiverView& view, const Vec2& u_m, const Vec2& low, const Vec2& high, const Vec2& q) {
  const LuminaireGeometry& g = view.geometry();
  const auto along_q = [&](const Vec2& tau) {
    const Vec2 s = u_m + g.sampling.spacing_mm.cwiseProduct(tau) + q - g.measurement.corner_mm();
    return Vec2(s.cwiseQuotient(g.measurement.pixel_mm));
  };
  const Vec2 a = view.on_s_px(u_m, low), b = view.on_s_px(u_m, high), c = along_q(low), d = along_q(high);
  const Vec2 least = a.cwiseMin(b).cwiseMin(c), greatest = a.cwiseMax(b).cwiseMax(d);
  const auto whole = [](double v) { return static_cast<int>(std::clamp(v, -1e6, 1e6)); };
  return {whole(std::floor(least.x())), whole(std::floor(greatest.x())) + 1, whole(std::floor(least.y())),
          whole(std::floor(greatest.y())) + 1};
}

/// Of a support and axis, each with a bound of its own.
constexpr int parts = 64;

double seen_share(const Look& look, const LuminaireGeometry& g) {
  if (look.sees) return look.sees(g.sampling.center_mm) ? 1 : 0;
  if (!look.visible) return 1;
  const TileGrid& grid = look.visible->grid;
  int seen = 0;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) seen += look.visible->sees(look.receiver, column, row);
  return static_cast<double>(seen) / grid.tiles();
}

}  // namespace

FarFieldTable::FarFieldTable(const LuminaireGeometry& geometry)
    : geometry_(geometry), basis_(geometry.sampling.basis) {}

Result<FarFieldTable> FarFieldTable::create(const LightField& light_field, const MethodSettings& settings) {
  // All q at which a support shows a pixel.
  FarFieldTable table(light_field.geometry());
  const Sampling& s = table.geometry_.sampling;
  const Measurement& m = table.geometry_.measurement;
  const Vec2 half = table.basis_.half_support() * s.spacing_mm;
  const Vec2 low = s.cell_center_mm({0, 0}) - half, high = s.cell_center_mm({s.rows - 1, s.columns - 1}) + half;
  table.first_q_mm_ = m.corner_mm() - high - m.pixel_mm;
  const Vec2 last = m.corner_mm() + Vec2(m.width_px, m.height_px).cwiseProduct(m.pixel_mm) - low + m.pixel_mm;
  const Vec2 size = (last - table.first_q_mm_).cwiseQuotient(m.pixel_mm).array().ceil() + 1;
  if (const Status fits = table.check(size, light_field.coverage().measured, settings); !fits)
    return tl::unexpected(fits.error());

  table.width_ = static_cast<int>(size.x());
  table.height_ = static_cast<int>(size.y());
  table.values_.assign(table.geometry_.channels.size() * static_cast<std::size_t>(size.prod()), 0.0);
  for (int flat = 0; flat < s.cells(); ++flat)
    if (const auto image = light_field.cell(s.index(flat))) table.add(*image, s.cell_center_mm(s.index(flat)));
  return table;
}

Status FarFieldTable::check(const Vec2& size, int cells, const MethodSettings& settings) const {
  constexpr const char* where = "far-field";
  constexpr const char* remedy = "use closed-form, larger pixels or a smaller grid";
  const Measurement& m = geometry_.measurement;
  const auto channels = static_cast<double>(geometry_.channels.size());
  // The values, as float too for a device, and the rows of one image.
  const double entries = channels * size.prod();
  if (!(entries < 0x1p31)) return fail("its table would have more than 2^31 entries", where, remedy);
  const double bytes = entries * (sizeof(double) + sizeof(float)) + size.x() * m.height_px * sizeof(double);
  if (const Status fits = check_table_memory(settings, bytes, host_memory_bytes()); !fits) return fits;
  // Each pixel of an image, and of its rows, counts at as many points as a support spans; each point is visited.
  const Vec2 taps = 2 * basis_.half_support() * geometry_.sampling.spacing_mm.cwiseQuotient(m.pixel_mm) + Vec2(2, 2);
  const double rows = m.height_px * (m.width_px * std::min(taps.x(), size.x()) + size.x());
  const double columns = m.height_px * std::min(taps.y(), size.y()) * size.x() + size.y();
  const double work = cells * channels * (rows + columns);
  if (work <= most_work) return {};
  char text[96];
  std::snprintf(text, sizeof text, "its table takes %.2g multiply-adds, more than %.0g", work, most_work);
  return fail(text, where, remedy);
}

/// Rows, then columns: the support is a product.
void FarFieldTable::add(const CellImage& image, const Vec2& u_m) {
  const Measurement& m = geometry_.measurement;
  const Vec2 rate = geometry_.sampling.spacing_mm.cwiseQuotient(m.pixel_mm);
  const Vec2 center = (u_m + first_q_mm_ - m.corner_mm()).cwiseQuotient(m.pixel_mm);
  const AxisTaps x = axis_taps(basis_, center.x(), rate.x()), y = axis_taps(basis_, center.y(), rate.y());
  const double area = geometry_.sampling.spacing_mm.prod();
  const auto width = static_cast<std::size_t>(width_);
  std::vector<double> rows(width * static_cast<std::size_t>(m.height_px));
  for (int c = 0; c < image.channels; ++c) {
    for (int j = 0; j < m.height_px; ++j)
      for (int q = 0; q < width_; ++q) {
        double sum = 0;
        const int first = x.first + q;
        for (int i = std::max(first, 0); i < std::min(first + static_cast<int>(x.weight.size()), m.width_px); ++i)
          sum += x.weight[static_cast<std::size_t>(i - first)] * image.at(c, i, j);
        rows[static_cast<std::size_t>(j) * width + static_cast<std::size_t>(q)] = area * sum;
      }
    double* out = values_.data() + static_cast<std::size_t>(c) * width * static_cast<std::size_t>(height_);
    for (int v = 0; v < height_; ++v, out += width_) {
      const int first = y.first + v;
      for (int j = std::max(first, 0); j < std::min(first + static_cast<int>(y.weight.size()), m.height_px); ++j) {
        const double weight = y.weight[static_cast<std::size_t>(j - first)];
        const double* row = rows.data() + static_cast<std::size_t>(j) * width;
        for (std::size_t q = 0; q < width; ++q) out[q] += weight * row[q];
      }
    }
  }
}

double FarFieldTable::at(int channel, const Vec2& q_mm) const {
  const Vec2 at = (q_mm - first_q_mm_).cwiseQuotient(geometry_.measurement.pixel_mm);
  if (!(at.x() >= 0 && at.x() < width_ - 1 && at.y() >= 0 && at.y() < height_ - 1)) return 0;
  const int i = static_cast<int>(at.x()), j = static_cast<int>(at.y());
  const double x = at.x() - i, y = at.y() - j;
  const double* low =
      values_.data() +
      (static_cast<std::size_t>(channel) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(j)) *
          static_cast<std::size_t>(width_) +
      i;
  const double* high = low + width_;
  return (1 - y) * ((1 - x) * low[0] + x * low[1]) + y * ((1 - x) * high[0] + x * high[1]);
}

double FarFieldTable::interpolation_error(int channel, const Vec2& q_mm) const {
  const Vec2 pixel = geometry_.measurement.pixel_mm;
  double worst = 0;
  for (int k = 0; k < 4; ++k) {
    const Vec2 at = q_mm + pixel.cwiseProduct(Vec2(k % 2 - 0.5, k / 2 - 0.5));
    double sum = 0;
    for (const Vec2& step : {Vec2(pixel.x(), 0), Vec2(0, pixel.y())})
      sum += std::abs(this->at(channel, at + step) - 2 * this->at(channel, at) + this->at(channel, at - step));
    worst = std::max(worst, sum);
  }
  // Where T is smooth, or its slope breaks at points of the table alone, the second difference half a step beside is
  // that of the step; of a slope that breaks amid a step, as of a box on other pixels, it may see one half.
  return geometry_.sampling.basis == BasisKind::box ? worst / 2 : worst / 4;
}

FarField::FarField(const LightField& light_field, FarFieldTable table)
    : light_field_(light_field), basis_(light_field.geometry().sampling.basis), table_(std::move(table)) {}

Result<std::unique_ptr<FarField>> FarField::create(const LightField& light_field, const MethodSettings& settings) {
  auto table = FarFieldTable::create(light_field, settings);
  if (!table) return tl::unexpected(table.error());
  return std::unique_ptr<FarField>(new FarField(light_field, std::move(*table)));
}

/// As one point it is seen by the share of the tiles that are, and shines from its centre.
Result<std::vector<double>> FarField::light(const Receiver& receiver, std::uint32_t, const Look& look) const {
  const LuminaireGeometry& g = light_field_.geometry();
  const std::size_t channels = g.channels.size();
  std::vector<double> e(channels + gloss_values(look.lobe, channels), 0.0);
  const Receiver at = at_lit_height(receiver);
  const Vec3 p = at.p_mm - Vec3(g.sampling.center_mm.x(), g.sampling.center_mm.y(), 0);
  const double facing = -at.n.dot(p), delta = g.planes.separation_mm;
  if (!(p.z() > 0) || !(facing > 0)) return e;
  // δ²/cos³θ · (−n·p)/d · 1/d², with cosθ = p_z/d.
  const double factor = seen_share(look, g) * delta * delta * facing / (p.z() * p.z() * p.z());
  for (std::size_t c = 0; c < channels; ++c)
    e[c] = factor * table_.at(static_cast<int>(c), p.head<2>() * (delta / p.z()));
  const std::array<double, 3> f = glossy_brdf(look.lobe, at.n, -p.normalized());
  for (std::size_t c = channels; c < e.size(); ++c) e[c] = f[c - channels] * e[channels == 1 ? 0 : c - channels];
  return e;
}

/// Adds what half-shadow and a lobe that varies over U may make of the light, at most `most_light`.
void FarField::state_look(const Look& look, const Receiver& receiver, const std::vector<double>& most_light,
                          Estimate& result) const {
  const LuminaireGeometry& g = light_field_.geometry();
  const std::size_t channels = g.channels.size();
  // All of a half-shadow's light may come through the tiles that are seen, or through those that are not.
  const double share = seen_share(look, g),
               off = look.sees || (share > 0 && share < 1) ? std::max(share, 1 - share) : 0;
  for (std::size_t c = 0; c < channels; ++c)
    result.stated_error[c] = share * result.stated_error[c] + off * most_light[c];
  if (look.lobe.kind == LOBE_NONE) return;

  // The lobe over a grid of points of U.
  const TileGrid grid(g.sampling);
  const Vec3 center(g.sampling.center_mm.x(), g.sampling.center_mm.y(), 0);
  const auto lobe_at = [&](const Vec3& u) {
    return glossy_brdf(look.lobe, receiver.n, (u - receiver.p_mm).normalized());
  };
  const std::array<double, 3> taken = lobe_at(center);
  std::array<double, 3> most = taken, varies{};
  constexpr int points = 32;
  for (int k = 0; k < points * points; ++k) {
    const Vec2 u =
        grid.corner_mm +
        grid.size_mm.cwiseProduct(Vec2(grid.columns * (k % points), grid.rows * (k / points))) / (points - 1);
    const std::array<double, 3> f = lobe_at({u.x(), u.y(), 0});
    for (std::size_t c = 0; c < 3; ++c) {
      most[c] = std::max(most[c], f[c]);
      varies[c] = std::max(varies[c], std::abs(f[c] - taken[c]));
    }
  }
  for (std::size_t c = 0; c < gloss_values(look.lobe, channels); ++c) {
    const std::size_t light = channels == 1 ? 0 : c;
    result.stated_error.push_back(most[c] * result.stated_error[light] + varies[c] * most_light[light]);
  }
}

Result<Estimate> FarField::estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const {
  Estimate result{*light(receiver, number, look), {}};
  const LuminaireGeometry& g = light_field_.geometry();
  result.stated_error.assign(g.channels.size(), 0.0);
  const ReceiverView view(g, basis_, receiver);
  if (!view.in_front()) {
    result.stated_error.assign(result.irradiance.size(), 0.0);
    return result;
  }

  const double z = lit_height_mm(receiver.p_mm.z()), delta = g.planes.separation_mm;
  const Vec2 spacing = g.sampling.spacing_mm, n = receiver.n.head<2>(), center = g.sampling.center_mm;
  const Vec2 q = (receiver.p_mm.head<2>() - center) * (delta / z);
  const double factor = delta * delta * spacing.prod() / (z * z * z);
  const double far_g = std::max(0.0, n.dot(center - receiver.p_mm.head<2>()) - receiver.n.z() * z);
  const double h = basis_.half_support();
  const double table_factor = delta * delta / (z * z * z) * far_g;
  for (std::size_t c = 0; c < result.stated_error.size(); ++c)
    result.stated_error[c] = table_factor * table_.interpolation_error(static_cast<int>(c), q);
  std::vector<double> most_light(g.channels.size(), 0.0);
  for (int flat = 0; flat < g.sampling.cells(); ++flat) {
    const CellIndex index = g.sampling.index(flat);
    const auto image = light_field_.cell(index);
    if (!image) continue;
    const Vec2 u_m = g.sampling.cell_center_mm(index);
    for (int k = 0; k < parts * parts; ++k) {
      // A part of the support, and the pixels that the true rays and the parallel ones see through it.
      const Vec2 low = Vec2(k % parts, k / parts) * (2 * h / parts) - Vec2(h, h),
                 high = low + Vec2(1, 1) * (2 * h / parts);
      const double share = basis_.moment(0, low.x(), high.x()) * basis_.moment(0, low.y(), high.y());
      const Vec2 u_low = u_m + low.cwiseProduct(spacing), u_high = u_m + high.cwiseProduct(spacing);
      const double off_g =
          std::max(std::abs(n.x() * (u_low.x() - center.x())), std::abs(n.x() * (u_high.x() - center.x()))) +
          std::max(std::abs(n.y() * (u_low.y() - center.y())), std::abs(n.y() * (u_high.y() - center.y())));
      const PixelWindow window = seen_through(view, u_m, low, high, q);
      for (std::size_t c = 0; c < result.stated_error.size(); ++c) {
        const auto [least, greatest] = range_over(*image, static_cast<int>(c), window);
        most_light[c] += factor * share * (off_g + far_g) * std::max(std::abs(least), std::abs(greatest));
        result.stated_error[c] +=
            factor * share * (off_g * std::max(std::abs(least), std::abs(greatest)) + far_g * (greatest - least));
      }
    }
  }
  if (!look.plain()) state_look(look, at_lit_height(receiver), most_light, result);
  return result;
}

}  // namespace lumifield
