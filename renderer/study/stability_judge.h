#pragma once

#include "renderer/methods/host_method.h"
#include "renderer/study/stability.h"

namespace lumifield {

/// What the receivers of a case get, by quadrature of the definition (definition_quadrature.h), which shares nothing
/// with the methods. By receiver, of the one channel.
struct StabilityTruth {
  std::vector<double> irradiance;  ///< E
  std::vector<double> light;       ///< Σ_m ∫|C_m Φ_m| max(0, n·(u−p)), what errors are shares of
  /// The same of |n_x (u−p)_x| + |n_y (u−p)_y| + |n_z p_z|, which n·(u−p) rounds with: much more than the light near U
  /// and at grazing angles. A bound: the largest of all supports.
  std::vector<double> terms;
};
StabilityTruth stability_truth(const StabilityCase& each, const LightField& light_field);

/// What both forms of a method say of a case. A form that refuses says why, and nothing else.
struct StabilityAnswers {
  std::vector<std::vector<Estimate>> host;  ///< by seed, by receiver
  std::vector<std::vector<double>> kernel;  ///< E of the first seeds, by receiver
  std::string host_refuses, kernel_refuses;
};
StabilityAnswers stability_answers(Method method, const StabilityCase& each, const LightField& light_field);

/// Draws by chance; the other methods repeat themselves.
bool is_sampler(Method method);

/// `failed`, whatever the method says of itself, where
/// - the host form is off the truth by more than rounding (reference, closed form without a level of detail), its bound
///   (closed form with one, far field), or what chance and a stated bias do to a sampler's mean over the seeds;
/// - the kernel is off the host form of the same seed by more than rounding of float, but for the few runs in which
///   rounding moves a draw to the pixel beside;
/// - a form answers NaN or Inf, or the kernel answers where its host form refuses, or refuses where that has an answer
///   of use.
/// Else `refused` where both refuse, and where one run states an error above a quarter of a receiver's light: no answer
/// of use.
StabilityRow judged(Method method, const StabilityCase& each, const StabilityTruth& truth,
                    const StabilityAnswers& answers);

}  // namespace lumifield
