#pragma once

#include <memory>
#include <string>
#include <vector>

#include "renderer/methods/device_method.h"
#include "renderer/methods/running_sums.h"

namespace lumifield {

/// Running sums in the methods' role: an evaluation adds cells piece by piece to all receivers, of which none is
/// computed before the last. Samples and seed count for nothing. Thread-bound.
class SummedEvaluation final : public DeviceMethod {
 public:
  SummedEvaluation(const LuminaireGeometry& geometry, const MethodSettings& settings, std::unique_ptr<RunningSums> sums)
      : DeviceMethod(geometry, settings), sums_(std::move(sums)) {}
  std::string device_name() const override { return sums_->device_name(); }
  double kernel_s() const override { return kernel_s_; }

 private:
  Status take_cells(const LightField& light_field) override;
  Status take_receivers(std::span<const Receiver> receivers) override;
  Status begin() override;
  Result<bool> go_on(double seconds) override;
  double share_computed() const override;
  Status read_computed(std::span<double> irradiance) override;
  Status read_gloss_computed(std::span<double> radiance) override;
  /// Cells of the next piece, where `seconds` are left.
  std::size_t fit(double seconds) const;

  std::unique_ptr<RunningSums> sums_;
  std::vector<CellIndex> cells_;                          ///< the measured ones in the grid's order
  std::vector<std::shared_ptr<const CellImage>> images_;  ///< of these
  std::vector<Receiver> receivers_;                       ///< to clear the sums by
  bool clear_ = false;                                    ///< the device has them, and no cell in its sums
  std::size_t next_ = 0;                                  ///< the first cell not added
  double kernel_s_ = 0;
};

}  // namespace lumifield
