#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/method.h"

namespace lumifield {

/// A method that computes many receivers, as OpenCL kernels: the cells and the receivers are set, then the irradiance
/// of all receivers is computed from all cells, in pieces where the caller must not be held up. Compared with its host
/// form (HostMethod) by tests. Thread-bound to its creator.
class DeviceMethod {
 public:
  virtual ~DeviceMethod() = default;

  /// Replaces the cells. Errors: another geometry, cells that the method cannot take, too much for the device.
  virtual Status set_cells(const LightField& light_field) = 0;
  /// Replaces the receivers; one with n = 0 gets 0. Errors: NaN or Inf, receivers at which the method has no answer.
  virtual Status set_receivers(std::span<const Receiver> receivers) = 0;
  /// Number of samples K and the seed, from the next evaluation on. Errors: those of check_settings.
  virtual Status set_samples(double samples, std::uint32_t seed) = 0;

  /// Begins anew after any of the above, else goes on, for about `seconds` and at least one piece; true when all has
  /// been computed. Errors: no cells were set, or those set last were refused.
  virtual Result<bool> evaluate(double seconds) = 0;
  /// E of the receivers computed, receiver-major: receivers · channels; 0 for the others. (The closed form's pieces are
  /// cells: in the midst of an evaluation all receivers have part of their light.)
  virtual Status read(std::vector<double>& irradiance) = 0;

  virtual std::string device_name() const = 0;
  /// Kernel time since the evaluation began, seconds.
  virtual double kernel_s() const = 0;
};

/// What an evaluation without cells says.
tl::unexpected<Error> no_cells();

/// The reference runs on the host. Errors: no OpenCL device, settings outside their range or that a kernel does not
/// heed.
Result<std::unique_ptr<DeviceMethod>> make_device_method(const LuminaireGeometry& geometry,
                                                         const MethodSettings& settings);

}  // namespace lumifield
