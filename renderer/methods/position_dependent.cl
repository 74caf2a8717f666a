// Position-dependent importance sampling: renderer/methods/position_dependent.h. One work-item per receiver.
// STEPS: 1 balance, 2 and draws, 3 all.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif
#ifndef STEPS
#define STEPS 3
#endif

#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/methods/sampling_view.clh"
#include "renderer/methods/gloss.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/sampling_look.clh"
#include "renderer/methods/sampling_box.clh"
#include "renderer/methods/light_draws.clh"

// F/factor times C/importance, or C near S, summed over the samples of a cell.
INLINE void add_samples(const SamplingGeometry* g, const View* view, const SamplingCell* cell, const Box* box, int on_u,
                        double all, __global const float* image, __global const double* table,
                        __global const double* columns, __global const float2* points,
                        __global const GlossLobe* lobe, const CellSight* sight, int id, int count, double* sum) {
  const double height = center_height(view, cell->u_x, cell->u_y);
  const uint first = first_point(g, (uint)cell->number, (uint)id);
  CellDraws draws;
  prepare_draws(g, box, on_u, all, table, &draws);
  for (int k = 0; k < count; ++k) {
    const float2 xi = sample_point(g, points, cell, first, k);
    const LightDraw draw = light_draw(g, view, cell, &draws, table, columns, xi);
#if STEPS == 2
    sum[0] += draw.tau.x + draw.tau.y + draw.pixel;
    continue;
#endif
    if (draw.pixel < 0) continue;
    const float weight = light_weight(g, view, height, on_u, image, sight, &draw);
    const double2 u = (double2)(cell->u_x, cell->u_y) + (double2)(g->spacing_x, g->spacing_y) * draw.tau;
    add_light(sum, weight, image + draw.pixel, g->plane, lobe, &view->at, u);
  }
}

__kernel void position_dependent(const SamplingGeometry geometry, __global const SamplingReceiver* receivers,
                                 __global const SamplingCell* cells, __global const float* images,
                                 __global const double* tables, __global const double* columns,
                                 __global const float2* points, __global double* sums, const SamplingLooks looks,
                                 __global const uint* bits, __global const GlossLobe* lobes, __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const View view = view_of(&geometry, receivers[id]);
  const double rates = fabs(view.rate.x * view.rate.y);
  const int on_u = draws_on_u(&view);

  // The balance.
  double all = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    all += cell_light(&geometry, &view, &box, on_u, images + (size_t)m * CHANNELS * geometry.plane,
                      tables + (size_t)m * geometry.table);
  }
#if STEPS == 1
  sums[(size_t)id * CHANNELS] = all;
  return;
#endif
  if (!(all > 0)) return;

  // The samples.
  double count = rounding_offset(geometry.seed, (uint)id);
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    __global const float* image = images + (size_t)m * CHANNELS * geometry.plane;
    __global const double* table = tables + (size_t)m * geometry.table;
    const double a = cell_light(&geometry, &view, &box, on_u, image, table);
    double kappa = geometry.samples * (a / all);
    if (geometry.k_max > 0) kappa = fmin(kappa, geometry.k_max);
    const double before = floor(count);
    count += kappa;
    const int samples = (int)(floor(count) - before);
    if (samples <= 0) continue;
    double part[VALUES];
    for (int c = 0; c < VALUES; ++c) part[c] = 0;
    const CellSight sight = sight_of_cell(&looks, bits, id, cell.number);
    add_samples(&geometry, &view, &cell, &box, on_u, a, image, table, columns + (size_t)m * geometry.columns, points,
                lobes + (LOBES > 0 ? id : 0), &sight, id, samples, part);
    const double scale = (on_u ? 4 * HALF * HALF : a / rates) / kappa;
    for (int c = 0; c < VALUES; ++c) sum[c] += scale * part[c];
  }
  keep_values(sum, view.factor, id, sums, gloss);
}

// Sizes and offsets of the shared structs as the device lays them out, for a test.
__kernel void sampling_layout(__global int* layout) {
  SamplingGeometry geometry;
  SamplingReceiver receiver;
  SamplingCell cell;
  SamplingLooks looks;
  layout[9] = sizeof looks;
  layout[10] = (int)((char*)&looks.grid_columns - (char*)&looks);
  layout[0] = sizeof geometry;
  layout[1] = (int)((char*)&geometry.width - (char*)&geometry);
  layout[2] = (int)((char*)&geometry.first_receiver - (char*)&geometry);
  layout[3] = (int)((char*)&geometry.seed - (char*)&geometry);
  layout[4] = sizeof receiver;
  layout[5] = (int)((char*)&receiver.n_z - (char*)&receiver);
  layout[6] = sizeof cell;
  layout[7] = (int)((char*)&cell.shift_x - (char*)&cell);
  layout[8] = (int)((char*)&cell.first_light - (char*)&cell);
}
