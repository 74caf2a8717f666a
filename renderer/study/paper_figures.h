#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// The figures of Lu, Pacanowski, Granier 2015 again on a luminaire of the size that the figure used (bike or car1),
/// each number with the paper's beside it; figure 10 on car2. The paper's luminaires, scenes and device (GTX 580,
/// 1024×768) are others: what compares is which of two wins, and by how much. Empty for luminaires of other names.
///
/// Fig. 5 modified secant and bisection at depth 3; 8 Halton and Mersenne twister; 9 K_max; 10 what each step takes; 11
/// precomputed lights; 12 uniform and importance sampling; 13 convergence at 100, 200, 400 samples.
Result<std::vector<FigureRow>> paper_figures(const StudyBench& bench, bool quick, const StudyProgress& progress);

/// The times at which two methods reach one error, from their points of one luminaire: between points by a line in the
/// logarithms, before the first by the first line's slope and beyond the last by the last line's, which `what` says.
/// For closed-form the cheapest point that is at least as good. A method whose error does not fall there has no row.
std::vector<FigureRow> equal_error_rows(const std::vector<StudyPoint>& points, const std::string& luminaire);

}  // namespace lumifield
