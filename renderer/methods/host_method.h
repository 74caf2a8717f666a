#pragma once

#include <memory>
#include <vector>

#include "luminaire/light_field.h"
#include "renderer/methods/closed_form.h"
#include "renderer/methods/look.h"
#include "renderer/methods/method.h"

namespace lumifield {

/// What a method says of one receiver.
struct Estimate {
  /// Per channel, the dataset's irradiance unit; of a glossy look then its radiance (Look, gloss_values).
  std::vector<double> irradiance;
  /// How far the method itself says it may be off, per channel: for samplers at least one standard deviation of this
  /// estimate over all seeds, derived from the distribution that is drawn from (not from the samples; without the
  /// mean's square of each cell, which would lessen it), and the known bias where there is one; for the others a bound.
  std::vector<double> stated_error;
};

/// A method on the host, in double precision: what its kernel is compared with, and what says where it cannot be used.
/// Reentrant; reads the light field's cells at construction.
class HostMethod {
 public:
  virtual ~HostMethod() = default;

  /// `number` of the receiver seeds what is random about it alone. Errors: a receiver at which the method has no
  /// answer, with the reason.
  Result<std::vector<double>> irradiance(const Receiver& receiver, std::uint32_t number) const {
    return light(receiver, number, {});
  }
  Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number) const {
    return estimate(receiver, number, {});
  }
  /// Of a receiver that sees a part of U, or shines: irradiance, then radiance by gloss (Look, gloss_values).
  virtual Result<std::vector<double>> light(const Receiver& receiver, std::uint32_t number, const Look& look) const = 0;
  virtual Result<Estimate> estimate(const Receiver& receiver, std::uint32_t number, const Look& look) const = 0;
};

/// Errors: settings outside their range, a luminaire that the method cannot take (cell named), tables that take more
/// memory than they may.
Result<std::unique_ptr<HostMethod>> make_host_method(const LightField& light_field, const MethodSettings& settings);

/// Refuses what no method takes: fewer than one sample, more than most_samples or most_lights, NaN; and a bound of the
/// samples of a cell, an inversion or a depth for a method that has none.
Status check_settings(const MethodSettings& settings);

}  // namespace lumifield
