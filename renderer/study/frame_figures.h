#pragma once

#include "renderer/study/study_bench.h"

namespace lumifield {

/// Of a frame, seconds: steps on the host by the clock, kernels by the device's profiling.
struct FrameTimes {
  double gbuffer_s = 0, receivers_s = 0, shadows_s = 0, hand_over_s = 0, show_s = 0;
  double balance_s = 0;  ///< kernel of position-dependent for A_m alone
  double drawn_s = 0;    ///< that draws samples too
  double kernel_s = 0;   ///< all of it
  double host_s() const { return gbuffer_s + receivers_s + shadows_s + hand_over_s + show_s; }
  double frame_s() const { return host_s() + kernel_s; }
};

/// The shares of a frame's steps, and its rate, beside the paper's. `size`: of the picture, in words.
std::vector<FigureRow> frame_rows(const FrameTimes& times, const std::string& luminaire, const std::string& size);

/// What one frame of the scene costs with all its luminaires, glossy as it is and in shadow, and what of it each step
/// takes: position-dependent at K = 200, beside Lu, Pacanowski, Granier 2015, Fig. 10 (two car2 headlights, 1024×768,
/// a GTX 580: 9 frames/s), and the closed form. Steps on the host by the clock, kernels by the device's profiling.
/// 1024×768, 256×192 if quick. Errors: no OpenCL, the scene's, stopped.
Result<std::vector<FigureRow>> frame_figures(StudyCamera& camera, const StudyLuminaire& luminaire, bool quick,
                                             const StudyProgress& progress);

}  // namespace lumifield
