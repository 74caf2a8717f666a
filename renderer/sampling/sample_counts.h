#pragma once

#include <span>
#include <vector>

namespace lumifield {

/// How many samples each cell gets: κ_m = min(K A_m/A, K_max), A = Σ A_m; all 0 where A is. k_max = 0: no bound.
std::vector<double> expected_counts(std::span<const double> a, double k, double k_max = 0);

/// Whole numbers K_m of which each has the expected value κ_m when `offset` is uniform in [0, 1): the running sum of κ,
/// moved by the offset, counts the whole numbers that it passes. (Rounding each κ_m by itself, as Lu 2015 Eq. 12 does,
/// never draws from cells of κ_m < ½.) The last may miss by rounding of the sum alone.
std::vector<int> systematic_rounding(std::span<const double> kappa, double offset);

/// ⌊κ_m + ½⌋, as published.
std::vector<int> nearest_counts(std::span<const double> kappa);

}  // namespace lumifield
