#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// What shift-invariant does, beside Granier, Goesele, Heidrich, Seidel 2003.
///
/// "Table 1": frames a second of 400×400 pixels, of lamps of 5×5, 7×7 and 9×7 cells of 300×300 in colour, in halls of
/// some 500 and 8,000 triangles, with and without shadows, depth maps kept and made anew; what one more cell takes; and
/// how far sums in sRGBE are from those in float, by cells per pass. If quick, of 5×5 cells in the small hall and 9×7
/// in the large one, with shadows, alone. Errors: no EGL, a hall that cannot be written, stopped.
Result<std::vector<FigureRow>> spot_speed_figures(bool quick, const StudyProgress& progress);

}  // namespace lumifield
