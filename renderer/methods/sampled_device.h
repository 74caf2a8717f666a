#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/methods/device_method.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/opencl/device.h"

namespace lumifield {

/// What the kernels of the sampling methods have in common: receivers, the table of cells, sums, and the evaluation in
/// bands of receivers. A method adds its tables and its kernel's arguments.
class SampledDevice : public DeviceMethod {
 public:
  std::string device_name() const override { return device_->name(); }
  double kernel_s() const override { return kernel_s_; }

 protected:
  SampledDevice(const LuminaireGeometry& geometry, const MethodSettings& settings);
  /// Opens the device and builds one function of an embedded source. `defines` beyond BASIS and CHANNELS. Errors:
  /// channels or settings that the kernels cannot take, the device's.
  Status open(std::string_view source, const std::string& function, const std::string& defines = "");

  /// Sets all arguments but the first, the geometry, and the last, what the receivers look like; gives the number of
  /// the next.
  virtual unsigned set_arguments(DeviceKernel& kernel) = 0;
  /// What depends on the cells, the samples and the seed; called before an evaluation where these changed.
  virtual Status make_points() = 0;
  /// Samples of a receiver at most, of all kinds that are drawn for it: what bands of them are measured in.
  virtual double rays_of_a_receiver() const;

  SamplingGeometry shared_{};
  std::unique_ptr<OpenClDevice> device_;
  DeviceBuffer receivers_, sums_;

 private:
  Status take_receivers(std::span<const Receiver> receivers) override;
  void forget() override { points_made_ = false; }
  Status begin() override;
  Result<bool> go_on(double seconds) override;
  double share_computed() const override;
  Status read_computed(std::span<double> irradiance) override;
  Status read_gloss_computed(std::span<double> radiance) override;
  Status build();
  Status take_appearance();
  void set_looks(DeviceKernel& kernel, unsigned number);
  /// Receivers of the next band, where `seconds` are left.
  std::size_t band(double seconds) const;

  std::string source_, function_, defines_;
  std::map<std::string, DeviceKernel> kernels_;  ///< by what appearances they are for
  DeviceKernel kernel_;
  SamplingLooks looks_{};
  DeviceBuffer bits_, lobes_, gloss_;
  std::size_t next_ = 0;  ///< the first receiver not computed
  bool points_made_ = false;
  double kernel_s_ = 0;
};

}  // namespace lumifield
