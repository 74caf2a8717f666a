#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/methods/device_method.h"
#include "renderer/methods/sampled_cell.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/opencl/device.h"

namespace lumifield {

/// Refuses cells of another luminaire than a method was made for.
Status check_same_luminaire(const LuminaireGeometry& cells, const LuminaireGeometry& method);

/// Refuses NaN and Inf, the receiver named.
Status check_finite(std::span<const Receiver> receivers);

/// What the kernels of the sampling methods have in common: receivers, the table of cells, sums, and the evaluation in
/// bands of receivers. A method adds its tables and its kernel's arguments.
class SampledDevice : public DeviceMethod {
 public:
  Status set_receivers(std::span<const Receiver> receivers) override;
  Status set_samples(double samples, std::uint32_t seed) override;
  Result<bool> evaluate(double seconds) override;
  Status read(std::vector<double>& irradiance) override;
  std::string device_name() const override { return device_->name(); }
  double kernel_s() const override { return kernel_s_; }

 protected:
  SampledDevice(const LuminaireGeometry& geometry, const MethodSettings& settings);
  /// Opens the device and builds one function of an embedded source. `defines` beyond BASIS and CHANNELS.
  Status open(std::string_view source, const std::string& function, const std::string& defines = "");

  /// Sets all arguments but the first, the geometry.
  virtual void set_arguments(DeviceKernel& kernel) = 0;
  /// What depends on the samples and the seed; called before an evaluation where these changed.
  virtual Status make_points() = 0;
  /// Receivers at which the method has no answer.
  virtual Status check_receiver(const Receiver& receiver) const;

  template <class T>
  Status upload(DeviceBuffer& buffer, const std::vector<T>& values, std::string_view purpose) {
    if (buffer.bytes() < values.size() * sizeof(T) || buffer.bytes() == 0) {
      buffer = {};
      auto more = device_->allocate(values.size() * sizeof(T), purpose);
      if (!more) return tl::unexpected(more.error());
      buffer = *more;
    }
    return device_->write(buffer, 0, std::as_bytes(std::span(values)));
  }
  /// Another evaluation is due; with new points too.
  void begin_anew(bool with_points);

  LuminaireGeometry geometry_;
  MethodSettings settings_;
  SamplingGeometry shared_{};
  std::unique_ptr<OpenClDevice> device_;
  DeviceBuffer receivers_, sums_;

 private:
  Status begin();

  DeviceKernel kernel_;
  std::size_t count_ = 0;  ///< receivers
  std::size_t next_ = 0;   ///< the first not computed
  bool begun_ = false, points_made_ = false;
  double kernel_s_ = 0;
};

}  // namespace lumifield
