#pragma once

#include <vector>

#include "renderer/methods/host_method.h"
#include "renderer/methods/receiver_view.h"

namespace lumifield {

/// The luminaire as seen from infinity, as a table over q = δ (ω_x, ω_y)/ω_z, the displacement from U to S along ω:
///
///     T(q) = Σ_m ∫ C_m(u + q) Φ_m(u) du,   I(ω) = δ²/cos³θ T(q)   [L·mm²]
///
/// Exact at the table's points, one pixel of S apart; bilinear between. Value type, immutable.
class FarFieldTable {
 public:
  /// Multiply-adds that a table is made with at most, about a minute on one core.
  static constexpr double most_work = 1e11;

  /// Errors, before memory or time is taken: more than most_work, more memory than the settings allow or 2^31 entries.
  static Result<FarFieldTable> create(const LightField& light_field, const MethodSettings& settings);

  int width() const { return width_; }
  int height() const { return height_; }
  const Vec2& first_q_mm() const { return first_q_mm_; }  ///< of entry (0, 0)
  /// Channel by channel, row by row.
  const std::vector<double>& values() const { return values_; }
  /// T; 0 beyond the table, where no light goes.
  double at(int channel, const Vec2& q_mm) const;
  /// Of `at`, by the table's second differences about q: h²/8 max|T″| an axis, doubled.
  double interpolation_error(int channel, const Vec2& q_mm) const;

 private:
  explicit FarFieldTable(const LuminaireGeometry& geometry);
  /// Of one more than ⌈size⌉, so that numbers too large for int are refused first.
  Status check(const Vec2& size, int cells, const MethodSettings& settings) const;
  void add(const CellImage& image, const Vec2& u_m);

  LuminaireGeometry geometry_;
  Basis basis_;
  int width_ = 0, height_ = 0;
  Vec2 first_q_mm_{0, 0};
  std::vector<double> values_;
};

/// The goniometric luminaire of lighting design: one point at the centre of the grid on U with the intensity I(ω),
///
///     E = I(ω) max(0, −n·ω)/d²,   ω from the point to the receiver, d away.
///
/// Its error falls as size/d and depends on the direction; the bound it states follows from the least and greatest C
/// between the ray taken and the true ones, and from the table's step.
class FarField final : public HostMethod {
 public:
  /// Errors: those of the table.
  static Result<std::unique_ptr<FarField>> create(const LightField& light_field, const MethodSettings& settings);

  using HostMethod::estimate;
  Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const override;
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const override;

 private:
  FarField(const LightField& light_field, FarFieldTable table);
  void state_look(const Look& look, const Receiver& receiver, const std::vector<double>& most_light,
                  Estimate& result) const;

  LightField light_field_;
  Basis basis_;
  FarFieldTable table_;
};

}  // namespace lumifield
