#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// The figures of Lu, Pacanowski, Granier 2015 again on a luminaire of the size that the figure used (bike or car1),
/// each number with the paper's beside it. The paper's luminaires, scenes and device (GTX 580,
/// 1024×768) are others: what compares is which of two wins, and by how much. Empty for luminaires of other names.
///
/// Fig. 5 modified secant and bisection at depth 3; 8 Halton and Mersenne twister; 9 K_max; 11 precomputed
/// lights; 12 uniform and importance sampling; 13 convergence at 100, 200, 400 samples.
Result<std::vector<FigureRow>> paper_figures(const StudyBench& bench, bool quick, const StudyProgress& progress);

}  // namespace lumifield
