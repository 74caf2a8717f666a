#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/appearance.h"
#include "renderer/methods/method.h"
#include "renderer/methods/receiver.h"

namespace lumifield {

/// A method that computes many receivers, on a device: the cells and the receivers are set, then the irradiance
/// of all receivers is computed from all cells, in pieces where the caller must not be held up. Compared with its host
/// form (HostMethod) by tests. This class keeps what is set and what is computed; a form computes. Thread-bound to its
/// creator.
class DeviceMethod {
 public:
  virtual ~DeviceMethod() = default;

  /// Replaces the cells; after an error there are none. Errors: another geometry, cells that the method cannot take,
  /// too much for the device.
  Status set_cells(const LightField& light_field);
  /// Replaces the receivers; one with n = 0 gets 0. `appearance`: how they look. Errors: NaN or Inf, receivers at which
  /// the method has no answer, an appearance of others, which leave those of before; of the device, after which there
  /// are none.
  Status set_receivers(std::span<const Receiver> receivers, Appearance appearance = {});
  /// Number of samples K and the seed, from the next evaluation on. Errors: those of check_settings.
  Status set_samples(double samples, std::uint32_t seed);

  /// Begins anew after any of the above, else goes on, for about `seconds` and at least one piece; true when all have
  /// been computed. Errors: cells or receivers that are not set, the device's, after which it begins anew.
  Result<bool> evaluate(double seconds);
  /// E of the receivers computed since the evaluation began, receiver-major: receivers · channels; 0 for the others.
  /// Errors: cells or receivers that are not set, the device's.
  Status read(std::vector<double>& irradiance);
  /// Their radiance by gloss towards the eye: receivers · gloss_channels(). The same errors.
  Status read_gloss(std::vector<double>& radiance);
  /// Values of it a receiver; 0 where none shines.
  std::size_t gloss_channels() const { return gloss_channels_; }

  virtual std::string device_name() const = 0;
  /// Kernel time since the evaluation began, seconds.
  virtual double kernel_s() const = 0;
  /// How much of the evaluation is done, 0 … 1.
  double share_done() const { return begun_ ? share_computed() : 0; }

 protected:
  DeviceMethod(const LuminaireGeometry& geometry, const MethodSettings& settings)
      : geometry_(geometry), settings_(settings) {}

  std::size_t channels() const { return geometry_.channels.size(); }
  std::size_t receivers() const { return count_; }
  const Appearance& appearance() const { return appearance_; }

  virtual Status take_cells(const LightField& light_field) = 0;
  /// Finite ones, at most 2^30, that pass check_receiver; with their appearance().
  virtual Status take_receivers(std::span<const Receiver> receivers) = 0;
  /// A receiver in front of U, of n ≠ 0, at which the method has no answer; named "receiver".
  virtual Status check_receiver(const Receiver& receiver) const;
  /// What was made of the cells, the number of samples and the seed no longer holds.
  virtual void forget() {}
  /// Nothing is computed, of the cells, receivers and samples as they are now.
  virtual Status begin() = 0;
  virtual Result<bool> go_on(double seconds) = 0;
  /// Of the receivers, or the cells, once begun.
  virtual double share_computed() const = 0;
  /// What `read` and `read_gloss` say, once begun.
  virtual Status read_computed(std::span<double> irradiance) = 0;
  virtual Status read_gloss_computed(std::span<double> radiance) = 0;

  const LuminaireGeometry geometry_;
  MethodSettings settings_;

 private:
  Status check_set() const;

  std::size_t count_ = 0;  ///< receivers
  Appearance appearance_;
  std::size_t gloss_channels_ = 0;
  bool has_cells_ = false, has_receivers_ = false, begun_ = false;
};

/// Refuses NaN and Inf, the receiver named.
Status check_finite(std::span<const Receiver> receivers);

/// The reference runs on the host, shift-invariant in a context of OpenGL of its own, which it makes current as it
/// needs it; the others in OpenCL. Errors: no such device, settings outside their range or that the kernels have no use
/// for.
Result<std::unique_ptr<DeviceMethod>> make_device_method(const LuminaireGeometry& geometry,
                                                         const MethodSettings& settings);

}  // namespace lumifield
