#pragma once

#include <optional>

#include "renderer/methods/closed_form.h"
#include "renderer/methods/device_method.h"

namespace lumifield {

/// The closed form in the role of the methods: each evaluation sums all cells anew, in pieces of rows of the grid. Read
/// in the midst of one, every receiver has the light of the rows summed so far. Thread-bound.
class ClosedFormEvaluation final : public DeviceMethod {
 public:
  /// Errors: those of ClosedFormDevice.
  static Result<std::unique_ptr<ClosedFormEvaluation>> create(const LuminaireGeometry& geometry,
                                                              const MethodSettings& settings);

  Status set_cells(const LightField& light_field) override;
  Status set_receivers(std::span<const Receiver> receivers) override;
  Status set_samples(double samples, std::uint32_t seed) override;
  Result<bool> evaluate(double seconds) override;
  Status read(std::vector<double>& irradiance) override { return device_->read(irradiance); }
  std::string device_name() const override { return device_->device_name(); }
  double kernel_s() const override { return kernel_s_; }

 private:
  ClosedFormEvaluation(const LuminaireGeometry& geometry, const MethodSettings& settings,
                       std::unique_ptr<ClosedFormDevice> device)
      : geometry_(geometry), settings_(settings), device_(std::move(device)) {}
  Status add_rows(int rows);

  LuminaireGeometry geometry_;
  MethodSettings settings_;
  std::optional<LightField> light_field_;
  std::unique_ptr<ClosedFormDevice> device_;
  std::vector<Receiver> receivers_;
  bool clear_ = false;  ///< the device has the receivers, and no cell in its sums
  bool begun_ = false;
  int next_row_ = 0;
  double kernel_s_ = 0;
};

}  // namespace lumifield
