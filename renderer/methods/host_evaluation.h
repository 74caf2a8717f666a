#pragma once

#include <optional>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"

namespace lumifield {

/// A host form in the role of the kernels, on two threads: the reference for whole pictures, slowly. Thread-bound.
class HostEvaluation final : public DeviceMethod {
 public:
  HostEvaluation(const LuminaireGeometry& geometry, const MethodSettings& settings)
      : geometry_(geometry), settings_(settings) {}

  Status set_cells(const LightField& light_field) override;
  Status set_receivers(std::span<const Receiver> receivers) override;
  Status set_samples(double samples, std::uint32_t seed) override;
  Result<bool> evaluate(double seconds) override;
  Status read(std::vector<double>& irradiance) override;
  std::string device_name() const override { return "host, double precision"; }
  double kernel_s() const override { return took_s_; }

 private:
  LuminaireGeometry geometry_;
  MethodSettings settings_;
  std::optional<LightField> light_field_;
  std::unique_ptr<HostMethod> form_;  ///< null until it is made for the cells and settings
  std::vector<Receiver> receivers_;
  std::vector<double> irradiance_;
  std::size_t next_ = 0;  ///< the first not computed
  double took_s_ = 0;
};

}  // namespace lumifield
