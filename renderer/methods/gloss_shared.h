#pragma once

// What a surface reflects besides diffusely, as host and kernels share it.

#define LOBE_NONE 0
#define LOBE_PHONG 1
#define LOBE_GGX 2

/// A glossy lobe at one receiver. The eye is in the frame of the receiver's normal.
typedef struct GlossLobe {
  float eye_x, eye_y, eye_z;  ///< unit, towards the eye
  float shape;                ///< Phong: exponent n; GGX: width α = roughness²
  float r, g, b;              ///< Phong: k_s; GGX: reflectance F0 at normal incidence
  int kind;                   ///< LOBE_NONE, LOBE_PHONG, LOBE_GGX
} GlossLobe;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(GlossLobe) == 32 && offsetof(GlossLobe, shape) == 12 && offsetof(GlossLobe, kind) == 28);
#endif
