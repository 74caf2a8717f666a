#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"

namespace lumifield {

/// A host form in the role of the kernels, on two threads: the reference for whole pictures, slowly. Thread-bound.
class HostEvaluation final : public DeviceMethod {
 public:
  using Maker =
      std::function<Result<std::unique_ptr<HostMethod>>(const LightField& light_field, const MethodSettings& settings)>;
  /// What the form throws, out of memory, is an Error of the evaluation.
  HostEvaluation(const LuminaireGeometry& geometry, const MethodSettings& settings, Maker make = make_host_method)
      : DeviceMethod(geometry, settings), make_(std::move(make)) {}

  std::string device_name() const override { return "host, double precision"; }
  double kernel_s() const override { return took_s_; }

 private:
  Status take_cells(const LightField& light_field) override;
  Status take_receivers(std::span<const Receiver> receivers) override;
  void forget() override { form_.reset(); }
  Status begin() override;
  Result<bool> go_on(double seconds) override;
  double share_computed() const override;
  Status read_computed(std::span<double> irradiance) override;
  Status read_gloss_computed(std::span<double> radiance) override;
  /// Receivers [begin, end), up to the first error.
  Status compute(std::size_t begin, std::size_t end);
  Status compute_on_two_threads(std::size_t begin, std::size_t end);

  Maker make_;
  std::optional<LightField> light_field_;
  std::unique_ptr<HostMethod> form_;  ///< null until it is made for the cells and samples
  std::vector<Receiver> receivers_;
  std::vector<double> irradiance_, gloss_;
  std::size_t next_ = 0;  ///< the first not computed
  double took_s_ = 0;
};

}  // namespace lumifield
