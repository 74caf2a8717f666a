#pragma once

// What host and kernel of multiple importance sampling share beside SamplingGeometry and RayGeometry.

/// A lobe is told by a square about its axis, on U, so many of its widths (LobeDistribution::width) wide: by what share
/// of that the lamp fills. From MIS_SHOWS on there are lobe samples.
#define MIS_REACH 4.0
#define MIS_SHOWS (1.0 / 24)
/// A lobe of at most this width reflects a part of the lamp that is nearly even: averages of that err so little
/// that light samples of it only add noise.
#define MIS_SPLITS 0.05
/// How many single rays an averaged one counts as.
#define MIS_WORTH 8.0

/// Samples of a receiver (MisCounts), and the points in the table of each kind of lobe samples.
typedef struct MisShares {
  double light, light_beside, light_apart;
  int diffuse, glossy;
  int diffuse_points, glossy_points;
} MisShares;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(MisShares) == 40 && offsetof(MisShares, diffuse) == 24 &&
              offsetof(MisShares, glossy_points) == 36);
#endif
