#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/error.h"
#include "luminaire/light_field.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/receiver.h"
#include "renderer/methods/running_sums.h"

namespace lumifield {

/// The irradiance of receivers as an exact sum over the pixels of every cell: no samples, no noise.
///
///     E_m(p, n) = δ²/(δ+Δ)³ ∫_U C_m(s(u)) Φ_m(u) max(0, n·(u−p)) du
///
/// For a support above the receiver's horizon the integrand is C times a polynomial, so each pixel contributes two
/// moments of the basis per axis; at a cut horizon the crossed pixels are clipped and integrated exactly.
///
/// Host oracle: double precision throughout. Reentrant; reads the light field's cells at construction.
class ClosedForm {
 public:
  /// pixels_per_support: level of detail T, as of ClosedFormDevice::set_lod; finite, 0 or more.
  explicit ClosedForm(const LightField& light_field, double pixels_per_support = 0);
  ~ClosedForm();

  /// E per channel, in the dataset's irradiance unit.
  std::vector<double> irradiance(const Receiver& receiver) const;
  /// The most that the level of detail may be off the exact sum, per channel, same unit:
  ///
  ///     δ²a_x a_y/(δ+Δ)³ Σ |g| max(C_max − C̄, C̄ − C_min)
  ///
  /// over the level's pixels of mean C̄ and weight g; 0 where all is exact.
  std::vector<double> detail_error_bound(const Receiver& receiver) const;

  /// What a receiver that sees a part of U, or shines, gets, the sum split at the tiles of U (TileGrid) and at the
  /// `division`-th parts of them, subtiles:
  ///
  ///     E = δ²/(δ+Δ)³ Σ_m Σ_subtiles v ∫ C_m(s(u)) Φ_m(u) max(0, n·(u−p)) du,   the same with f(u) in it for gloss
  ///
  /// v is what is seen of a subtile: of its tile, or of its middle where the look tells by point; f, the lobe, is taken
  /// at the subtiles' corners and bilinear between them, which keeps the integrand C times a polynomial and the error
  /// second order in the subtiles' size (at a cut horizon f is that at the middle of each pixel's part). Irradiance by
  /// channel, then radiance by gloss (gloss_values).
  std::vector<double> light(const Receiver& receiver, const Look& look, int division) const;
  /// Of detail_error_bound, the same.
  std::vector<double> light_detail_error_bound(const Receiver& receiver, const Look& look, int division) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The same sum as an OpenCL kernel, with one running sum in double per receiver and channel: a new cell costs one
/// cell, a retaken one two, closed(C_new) − closed(C_old), the second exactly what had been added. Needs a device with
/// double precision. Thread-bound to its creator.
class ClosedFormDevice final : public RunningSums {
 public:
  /// Chooses the OpenCL device (LUMIFIELD_OPENCL names another, by a part of its name). Probes OpenCL in a child
  /// process first: a driver that aborts becomes an Error.
  static Result<std::unique_ptr<ClosedFormDevice>> create(const LuminaireGeometry& geometry);
  ~ClosedFormDevice() override;

  /// Level of detail T: each receiver sums over means of 2^ℓ×2^ℓ pixels, so coarse that a support spans at most T
  /// pixels an axis. 0, the default, is exact. Takes effect at the next set_receivers, which clears the sums; adding
  /// and replacing cells then keeps to it. Errors: negative or not finite.
  Status set_lod(double pixels_per_support);

  Status set_receivers(std::span<const Receiver> receivers, const Appearance& appearance = {}) override;
  Status set_receivers(std::span<const float> p_xyzw, std::span<const float> n_xyzw,
                       const Appearance& appearance = {}) override;

  /// Adds one cell to all sums; with `replaces` adds the difference.
  Status add_cell(CellIndex cell, const CellImage& image, const CellImage* replaces = nullptr);
  /// Adds many in one go (a whole dataset after a change of view).
  Status add_cells(std::span<const CellIndex> cells, std::span<const CellImage* const> images);
  /// The same of images that do not change: where the device has just these, all of them, it keeps them from one set of
  /// receivers to the next with as much or as little detail. Holds them until others come.
  Status add_cells(std::span<const CellIndex> cells, std::span<const std::shared_ptr<const CellImage>> images) override;
  Status replace_cell(CellIndex cell, const std::shared_ptr<const CellImage>& image,
                      const std::shared_ptr<const CellImage>& before) override {
    return add_cell(cell, *image, before.get());
  }

  Status read(std::vector<float>& irradiance);
  Status read(std::vector<double>& irradiance) override;
  Status read_gloss(std::vector<double>& radiance) override;

  std::string device_name() const override;
  /// From OpenCL's own profiling.
  double last_kernel_s() const override;

 private:
  struct Impl;
  explicit ClosedFormDevice(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace lumifield
