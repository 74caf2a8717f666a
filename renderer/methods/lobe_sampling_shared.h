#pragma once

// A point of the unit square as draws of directions use it, shared by host and kernels.

typedef struct LobePoint {
  double x, log_x;          ///< 0 < x ≤ 1, and its logarithm
  double cos_phi, sin_phi;  ///< of 2π y
} LobePoint;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(LobePoint) == 32 && offsetof(LobePoint, sin_phi) == 24);
#endif
