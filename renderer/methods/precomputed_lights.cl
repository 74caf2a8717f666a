// The same light samples for all receivers, cell by cell, sixteen at a time: renderer/methods/precomputed_lights.h.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif

#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/methods/sampling_view.clh"
#include "renderer/methods/gloss.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/sampling_look.clh"

// How far sixteen lights lie from a place along one axis, pixels. Near each other two floats differ exactly, so that what
// is left of both decides.
INLINE float16 apart(__global const float* place, int plane, float near, float rest) {
  return (vload16(0, place) - near) + (vload16(0, place + plane) - rest);
}

// lights: planes of `plane`: x of all, and what float leaves of it; y of all, and what is left; then each channel's value
// of all. Those of a cell begin at a multiple of 16 and are filled up with values of 0. A receiver on S sees none.
__kernel void precomputed_lights(const SamplingGeometry geometry, __global const SamplingReceiver* receivers,
                                 __global const SamplingCell* cells, __global const float* lights,
                                 __global double* sums, const SamplingLooks looks, __global const uint* bits,
                                 __global const GlossLobe* lobes, __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const SamplingReceiver at = receivers[id];
  const View view = view_of(&geometry, at);
  if (view.rate.x == 0) return;
  const float2 per_rate = convert_float2(1 / view.rate), slope = convert_float2(view.slope / view.rate);
  const double2 p = ((double2)(at.p_x, at.p_y) - (double2)(geometry.corner_x, geometry.corner_y)) /
                    (double2)(geometry.pixel_x, geometry.pixel_y);
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const CellSight sight = sight_of_cell(&looks, bits, id, cell.number);
    // Places count from where the support's centre shows, between the planes from p, about which n·(u − p) is linear too:
    // near U it is of the size of the height there, and cancels about the centre.
    const double2 center = on_s_px(&geometry, &view, (double2)(cell.u_x, cell.u_y));
    const double2 origin = view.r < 0 ? p : center;
    const float2 near = convert_float2(origin), rest = convert_float2(origin - convert_double2(near));
    const float2 off = convert_float2(origin - center);
    const float height = (float)(view.r < 0 ? -at.n_z * at.p_z : center_height(&view, cell.u_x, cell.u_y));
    float16 part[CHANNELS];
    for (int c = 0; c < CHANNELS; ++c) part[c] = 0;
    for (int k = cell.first_light; k < cells[m + 1].first_light; k += 16) {
      const float16 x = apart(lights + k, geometry.plane, near.x, rest.x);
      const float16 y = apart(lights + 2 * geometry.plane + k, geometry.plane, near.y, rest.y);
      const float16 g = height + slope.x * x + slope.y * y;
      const float16 tau_x = (x + off.x) * per_rate.x, tau_y = (y + off.y) * per_rate.y;
      const float16 weight = phi_of_16(tau_x) * phi_of_16(tau_y) * fmax(g, (float16)0) * seen_at_16(&sight, tau_x, tau_y);
#if LOBES == 0
      for (int c = 0; c < CHANNELS; ++c) part[c] += weight * vload16(0, lights + (4 + c) * geometry.plane + k);
#else
      float weights[16], taus_x[16], taus_y[16];
      vstore16(weight, 0, weights);
      vstore16(tau_x, 0, taus_x);
      vstore16(tau_y, 0, taus_y);
      for (int i = 0; i < 16; ++i)
        if (weights[i] != 0)
          add_light(sum, weights[i], lights + 4 * geometry.plane + k + i, geometry.plane, lobes + id, &at,
                    (double2)(cell.u_x + geometry.spacing_x * taus_x[i], cell.u_y + geometry.spacing_y * taus_y[i]));
#endif
    }
    for (int c = 0; c < CHANNELS; ++c) {
      const float8 eight = part[c].lo + part[c].hi;
      const float4 four = eight.lo + eight.hi;
      sum[c] += (four.x + four.y) + (four.z + four.w);
    }
  }
  const double scale = view.factor / fabs(view.rate.x * view.rate.y);
  keep_values(sum, scale, id, sums, gloss);
}
