// As many uniform samples in the support of each cell: renderer/methods/uniform_box.h.
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

__kernel void uniform_box(const SamplingGeometry geometry, __global const SamplingReceiver* receivers,
                          __global const SamplingCell* cells, __global const float* images,
                          __global const float2* points, __global double* sums, const SamplingLooks looks,
                          __global const uint* bits, __global const GlossLobe* lobes, __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const View view = view_of(&geometry, receivers[id]);
  const double kappa = geometry.samples / geometry.cells;
  double count = rounding_offset(geometry.seed, (uint)id);
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const double before = floor(count);
    count += kappa;
    const int samples = (int)(floor(count) - before);
    const double2 u_m = (double2)(cell.u_x, cell.u_y), spacing = (double2)(geometry.spacing_x, geometry.spacing_y);
    const double height = center_height(&view, cell.u_x, cell.u_y);
    __global const float* image = images + (size_t)m * CHANNELS * geometry.plane;
    const uint first = first_point(&geometry, (uint)cell.number, (uint)id);
    const CellSight sight = sight_of_cell(&looks, bits, id, cell.number);
    for (int k = 0; k < samples; ++k) {
      const float2 xi = sample_point(&geometry, points, &cell, first, k);
      const float2 tau = (float)HALF * (2 * xi - 1);
      const double2 at = on_s_px(&geometry, &view, u_m + spacing * convert_double2(tau));
      if (!(at.x >= 0 && at.x < geometry.width && at.y >= 0 && at.y < geometry.height)) continue;
      const double g = height + dot(view.slope, convert_double2(tau));
      const float weight = phi(tau.x) * phi(tau.y) * (g > 0 ? (float)g : 0) * seen_at(&sight, tau);
      const int pixel = (int)at.y * geometry.stride + (int)at.x;
      add_light(sum, weight, image + pixel, geometry.plane, lobes + (LOBES > 0 ? id : 0), &view.at,
                u_m + spacing * convert_double2(tau));
    }
  }
  const double scale = view.factor * (4 * HALF * HALF) / kappa;
  keep_values(sum, scale, id, sums, gloss);
}
