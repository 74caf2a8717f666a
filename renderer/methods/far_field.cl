// One point with an intensity distribution: renderer/methods/far_field.h.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef CHANNELS
#define CHANNELS 1
#endif

#ifndef BASIS
#define BASIS 2
#endif

#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/methods/sampling_view.clh"
#include "renderer/methods/gloss.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/sampling_look.clh"

// The geometry's corner is the table's first q, width, height and plane the table's. center: of the grid on U.
__kernel void far_field(const SamplingGeometry geometry, __global const SamplingReceiver* receivers,
                        __global const float* table, const double2 center, __global double* sums,
                        const SamplingLooks looks, __global const uint* bits, __global const GlossLobe* lobes,
                        __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers) return;
  const SamplingReceiver at = receivers[id];
  const double2 p = (double2)(at.p_x, at.p_y) - center;
  const double facing = -(at.n_x * p.x + at.n_y * p.y + at.n_z * at.p_z);
  if (!(at.p_z > 0) || !(facing > 0)) return;
  const double2 q = (p * (geometry.separation / at.p_z) - (double2)(geometry.corner_x, geometry.corner_y)) /
                    (double2)(geometry.pixel_x, geometry.pixel_y);
  if (!(q.x >= 0 && q.x < geometry.width - 1 && q.y >= 0 && q.y < geometry.height - 1)) return;
  const int i = (int)q.x, j = (int)q.y;
  const float x = (float)(q.x - i), y = (float)(q.y - j);
  double factor = geometry.separation * geometry.separation * facing / (at.p_z * at.p_z * at.p_z);
#if SHADOW
  int seen = 0;
  for (int k = 0; k < looks.row_words * looks.rows; ++k) seen += popcount(bits[(size_t)id * looks.row_words * looks.rows + k]);
  factor *= (double)seen / (looks.columns * looks.rows);
#endif
  float values[CHANNELS];
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int c = 0; c < CHANNELS; ++c) {
    __global const float* low = table + c * geometry.plane + j * geometry.width + i;
    __global const float* high = low + geometry.width;
    const float value = (1 - y) * ((1 - x) * low[0] + x * low[1]) + y * ((1 - x) * high[0] + x * high[1]);
    values[c] = value;
  }
  // As add_light does, of one light at the centre.
  for (int c = 0; c < CHANNELS; ++c) sum[c] = values[c];
#if LOBES > 0
  const GlossLobe lobe = lobes[id];
  if (lobe.kind != LOBE_NONE) {
    const float3 to_light = (float3)((float)-p.x, (float)-p.y, (float)-at.p_z);
    const float3 shines = glossy_brdf(&lobe, (float3)((float)at.n_x, (float)at.n_y, (float)at.n_z),
                                      towards_eye(&lobe, at.n_x, at.n_y, at.n_z), to_light, (float)facing);
    const float f[3] = {shines.x, shines.y, shines.z};
    for (int c = 0; c < GLOSSES; ++c) sum[CHANNELS + c] = f[LOBES == 1 ? 0 : c] * values[CHANNELS == 1 ? 0 : c];
  }
#endif
  keep_values(sum, factor, id, sums, gloss);
}
