#pragma once

#include "renderer/methods/host_method.h"
#include "renderer/study/stability.h"

namespace lumifield {

/// What the receivers of a case get, by quadrature of the definition (definition_quadrature.h), which shares nothing
/// with the methods. By value: the irradiance of each receiver, of the one channel, then its radiance by gloss, where
/// the case has lobes.
struct StabilityTruth {
  std::vector<double> irradiance;  ///< E, or the radiance
  std::vector<double> light;       ///< Σ_m ∫|C_m Φ_m| max(0, n·(u−p)), with the lobe: what errors are shares of
  /// The same of |n_x (u−p)_x| + |n_y (u−p)_y| + |n_z p_z|, which n·(u−p) rounds with: much more than the light near U
  /// and at grazing angles. A bound: the largest of all supports.
  std::vector<double> terms;
  std::vector<double> lobe;  ///< of gloss: the light times the lobe's peak, what a lobe in float rounds with; else 0
};
StabilityTruth stability_truth(const StabilityCase& each, const LightField& light_field);

/// What both forms of a method say of a case. A form that refuses says why, and nothing else.
struct StabilityAnswers {
  std::vector<std::vector<Estimate>> host;  ///< by seed, by value
  std::vector<std::vector<double>> kernel;  ///< of the first seeds, by value
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
