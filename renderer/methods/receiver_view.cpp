#include "renderer/methods/receiver_view.h"

#include <algorithm>
#include <cmath>

#include "renderer/methods/gloss.h"

namespace lumifield {

ReceiverView::ReceiverView(const LuminaireGeometry& geometry, const Basis& basis, const Receiver& receiver,
                           const Look& look)
    : geometry_(&geometry),
      basis_(&basis),
      receiver_(at_lit_height(receiver)),
      look_(look),
      channels_(geometry.channels.size()),
      gloss_(gloss_values(look.lobe, channels_)),
      half_(basis.half_support()) {
  if (!in_front()) return;
  const double delta = geometry.planes.separation_mm, z = receiver_.p_mm.z();
  const Vec2 a = geometry.sampling.spacing_mm;
  factor_ = delta * delta * a.x() * a.y() / (z * z * z);
  rate_ = (z - delta) / z * a.cwiseQuotient(geometry.measurement.pixel_mm);
}

Vec2 ReceiverView::on_s_px(const Vec2& u_m, const Vec2& tau) const {
  const double delta = geometry_->planes.separation_mm, z = receiver_.p_mm.z();
  const double r = (z - delta) / z, t = delta / z;
  const Vec2 p = receiver_.p_mm.head<2>(), u = u_m + geometry_->sampling.spacing_mm.cwiseProduct(tau);
  const Measurement& m = geometry_->measurement;
  // s(u) is p + r (u − p) and u + t (p − u): the one that does not cancel.
  const Vec2 from_corner =
      std::abs(r) < std::abs(t) ? Vec2((p - m.corner_mm()) + r * (u - p)) : Vec2((u - m.corner_mm()) + t * (p - u));
  return from_corner.cwiseQuotient(m.pixel_mm);
}

PixelBox ReceiverView::box(const Vec2& u_m) const {
  const Vec2 a = on_s_px(u_m, {-half_, -half_}), b = on_s_px(u_m, {half_, half_});
  return {std::min(a.x(), b.x()), std::max(a.x(), b.x()), std::min(a.y(), b.y()), std::max(a.y(), b.y())};
}

Vec2 ReceiverView::tau(const Vec2& u_m, const Vec2& on_s) const {
  return (on_s - on_s_px(u_m, {0, 0})).cwiseQuotient(rate_);
}

double ReceiverView::weight(const Vec2& u_m, const Vec2& tau) const {
  const Vec2 u = u_m + geometry_->sampling.spacing_mm.cwiseProduct(tau);
  const Vec3 &p = receiver_.p_mm, &n = receiver_.n;
  const double g = n.x() * (u.x() - p.x()) + n.y() * (u.y() - p.y()) - n.z() * p.z();
  return g > 0 ? factor_ * (*basis_)(tau.x()) * (*basis_)(tau.y()) * g : 0;
}

double ReceiverView::seen(CellIndex cell, const Vec2& tau) const {
  const Sampling& sampling = geometry_->sampling;
  if (look_.sees) return look_.sees(sampling.cell_center_mm(cell) + sampling.spacing_mm.cwiseProduct(tau)) ? 1 : 0;
  if (!look_.visible) return 1;
  // The tile under τ; the support's high end counts to its last.
  const auto tile = [&](double t) { return std::clamp(static_cast<int>(t + half_), 0, basis_->overlap() - 1); };
  return look_.visible->share(look_.receiver, cell, cell.column + tile(tau.x()), cell.row + tile(tau.y()));
}

ReceiverView::Weights ReceiverView::weights(std::uint32_t number, const Vec2& tau) const {
  const Sampling& sampling = geometry_->sampling;
  const CellIndex cell = sampling.index(static_cast<int>(number));
  const Vec2 u_m = sampling.cell_center_mm(cell), u = u_m + sampling.spacing_mm.cwiseProduct(tau);
  Weights result{weight(u_m, tau), {}};
  if (result.irradiance == 0) return result;
  result.irradiance *= seen(cell, tau);
  if (gloss_ == 0 || result.irradiance == 0) return result;
  const Vec3& p = receiver_.p_mm;
  result.gloss = glossy_brdf(look_.lobe, receiver_.n, Vec3(u.x() - p.x(), u.y() - p.y(), -p.z()).normalized());
  for (double& f : result.gloss) f *= result.irradiance;
  return result;
}

}  // namespace lumifield
