// Position-dependent importance sampling: renderer/methods/position_dependent.h. One work-item per receiver.
//
// The summed-area table is read in vectors of 16 columns: once per receiver and cell the box' marginal, after which a
// draw in x is one comparison of 16 numbers, and one in y another on the column's sums. Built with PLAIN, draws search
// the tables by the modified secant instead, as boxes wider than WIDEST do always. STEPS: 1 balance, 2 and draws, 3 all.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif
#ifndef PLAIN
#define PLAIN 0
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

#define LEAST_SPAN 4
#define BLOCK 16
#define WIDEST 64

// Near S: 4h² times the mean over the pixels touched.
INLINE double mean_importance(const SamplingGeometry* g, __global const float* image, const Box* box, const View* v) {
  const double2 reach = HALF * fabs(v->rate);
  const int2 first = convert_int2_rtn(box->center - reach), last = convert_int2_rtn(box->center + reach);
  double sum = 0;
  for (int j = max(first.y, 0); j <= min(last.y, g->height - 1); ++j)
    for (int i = max(first.x, 0); i <= min(last.x, g->width - 1); ++i) sum += importance_at(g, image, j * g->stride + i);
  return 4 * HALF * HALF * sum / ((last.x - first.x + 1) * (last.y - first.y + 1));
}

// The marginal of the box' columns, a share of its whole, at the left edge of each; what stands beyond the
// box counts for nothing.
INLINE void fill_marginal(const SamplingGeometry* g, __global const double* table, const Box* box, double all,
                          float* marginal) {
  const int j0 = min((int)box->low.y, g->height - 1), j1 = min((int)box->high.y, g->height - 1);
  const double f0 = box->low.y - j0, f1 = box->high.y - j1;
  __global const double *low = table + j0 * g->stride + box->first.x, *high = table + j1 * g->stride + box->first.x;
  const double fx = box->low.x - box->first.x;
  const double begin = (high[0] + fx * (high[1] - high[0])) * (1 - f1) +
                       (high[g->stride] + fx * (high[g->stride + 1] - high[g->stride])) * f1 -
                       (low[0] + fx * (low[1] - low[0])) * (1 - f0) -
                       (low[g->stride] + fx * (low[g->stride + 1] - low[g->stride])) * f0;
  const double scale = 1 / all;
  for (int i = 0; i < box->count.x; i += BLOCK) {
    const double16 upper = vload16(0, low + i), upper_next = vload16(0, low + i + g->stride);
    const double16 lower = vload16(0, high + i), lower_next = vload16(0, high + i + g->stride);
    const double16 strip = (lower + f1 * (lower_next - lower)) - (upper + f0 * (upper_next - upper));
    vstore16(convert_float16((strip - begin) * scale), 0, marginal + i);
  }
  marginal[0] = 0;
  marginal[box->count.x] = 1;
}

INLINE int count_of(int16 is) {
  const int8 eight = is.lo + is.hi;
  const int4 four = eight.lo + eight.hi;
  return -((four.x + four.y) + (four.z + four.w));
}
INLINE int count_of_long(long16 is) {
  const long8 eight = is.lo + is.hi;
  const long4 four = eight.lo + eight.hi;
  return -(int)((four.x + four.y) + (four.z + four.w));
}

// A draw along one axis: the pixel, from the box' first, and the place, in pixels from there.
typedef struct {
  int pixel;
  float at;
} Draw;

INLINE Draw placed(int pixel, double low, double high, float share) {
  const Draw draw = {pixel, (float)low + share * (float)(high - low)};
  return draw;
}

INLINE Draw draw_x(const Box* box, const float* marginal, float xi) {
  int before = -1;
  for (int i = 0; i < box->count.x; i += BLOCK) {
    const int lanes = box->count.x - i;
    const int16 number = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    before += count_of((vload16(0, marginal + i) <= xi) & (number < lanes));
  }
  before = max(before, 0);
  const float from = marginal[before], rise = marginal[before + 1] - from;
  const double low = fmax(box->low.x - box->first.x, before), high = fmin(box->high.x - box->first.x, before + 1.0);
  return placed(before, low, high, rise > 0 ? clamp((xi - from) / rise, 0.0f, 1.0f) : 0);
}

INLINE Draw draw_y(const SamplingGeometry* g, __global const double* column, const Box* box, float xi) {
  __global const double* first = column + box->first.y;
  const int last = box->count.y - 1;
  const double begin = first[0] + (box->low.y - box->first.y) * (first[1] - first[0]);
  const double end = first[last] + (box->high.y - (box->first.y + last)) * (first[last + 1] - first[last]);
  const double target = begin + xi * (end - begin);
  int before = -1;
  for (int j = 0; j <= last; j += BLOCK) {
    const long16 number = (long16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const int here = count_of_long((vload16(0, first + j) <= target) & (number <= (long)(last - j)));
    before += here;
    if (here < BLOCK) break;
  }
  before = max(before, 0);
  const double from = before == 0 ? begin : first[before], to = before == last ? end : first[before + 1];
  const double low = fmax(box->low.y - box->first.y, before), high = fmin(box->high.y - box->first.y, before + 1.0);
  const double rise = to - from;
  return placed(before, low, high, rise > 0 ? (float)clamp((target - from) / rise, 0.0, 1.0) : 0);
}

// The modified secant: renderer/sampling/cdf_inversion.h.
typedef struct {
  double low, high, at_low, at_high;
} Bracket;

INLINE double position(const Bracket* b, double y) {
  const double rise = b->at_high - b->at_low;
  return rise > 0 ? clamp(b->low + (y - b->at_low) / rise * (b->high - b->low), b->low, b->high) : b->low;
}

#define SEARCH(bracket, y, value_at)                                                            \
  for (int halve = 0;;) {                                                                       \
    const double first_in = floor(bracket.low) + 1, last_in = ceil(bracket.high) - 1;           \
    if (first_in > last_in) break;                                                              \
    const double width = bracket.high - bracket.low;                                            \
    const double guess = halve ? (bracket.low + bracket.high) / 2 : position(&bracket, y);      \
    const double knot = clamp(round(guess), first_in, last_in);                                 \
    const double value = value_at;                                                              \
    if (value <= y) {                                                                           \
      bracket.low = knot;                                                                       \
      bracket.at_low = value;                                                                   \
    } else {                                                                                    \
      bracket.high = knot;                                                                      \
      bracket.at_high = value;                                                                  \
    }                                                                                           \
    halve = !halve && bracket.high - bracket.low > width / 2;                                   \
  }

INLINE Draw search_x(const SamplingGeometry* g, __global const double* table, const Box* box, double all, float xi) {
  Bracket b = {box->low.x, box->high.x, 0, all};
  const double y = xi * all;
  Box part = *box;
  SEARCH(b, y, (part.high.x = knot, box_integral(g, table, &part)))
  const double at = position(&b, y);
  const Draw draw = {min((int)at, g->width - 1) - box->first.x, (float)(at - box->first.x)};
  return draw;
}

INLINE Draw search_y(const SamplingGeometry* g, __global const double* column, const Box* box, float xi) {
  const int last = box->first.y + box->count.y - 1;
  const double begin = column[box->first.y] + (box->low.y - box->first.y) * (column[box->first.y + 1] - column[box->first.y]);
  const double end = column[last] + (box->high.y - last) * (column[last + 1] - column[last]);
  Bracket b = {box->low.y, box->high.y, begin, end};
  const double y = begin + xi * (end - begin);
  SEARCH(b, y, column[(int)knot])
  const double at = position(&b, y);
  const Draw draw = {min((int)at, g->height - 1) - box->first.y, (float)(at - box->first.y)};
  return draw;
}

// F/factor times C/importance, or C near S, summed over the samples of a cell.
INLINE void add_samples(const SamplingGeometry* g, const View* view, const SamplingCell* cell, const Box* box, int on_u,
                        double all, __global const float* image, __global const double* table,
                        __global const double* columns, __global const float2* points,
                        __global const GlossLobe* lobe, const CellSight* sight, int id, int count, double* sum) {
  const double height = center_height(view, cell->u_x, cell->u_y);
  const uint first = first_point(g, (uint)cell->number, (uint)id);
  float marginal[WIDEST + BLOCK + 1];
  const int vectors = !PLAIN && box->count.x <= WIDEST;
  if (vectors && !on_u) fill_marginal(g, table, box, all, marginal);
  const double2 center = box->center - convert_double2(box->first), per_rate = 1 / view->rate;
  for (int k = 0; k < count; ++k) {
    const float2 xi = sample_point(g, points, cell, first, k);
    double2 tau;
    int pixel;
    float ratio = 1;
    if (on_u) {
      tau = convert_double2((float)HALF * (2 * xi - 1));
      const double2 spacing = (double2)(g->spacing_x, g->spacing_y);
      const double2 at = on_s_px(g, view, (double2)(cell->u_x, cell->u_y) + spacing * tau);
      if (!(at.x >= 0 && at.x < g->width && at.y >= 0 && at.y < g->height)) continue;
      pixel = (int)at.y * g->stride + (int)at.x;
    } else {
      const Draw x = vectors ? draw_x(box, marginal, xi.x) : search_x(g, table, box, all, xi.x);
      __global const double* column = columns + (size_t)(box->first.x + x.pixel) * g->column_stride;
      const Draw y = vectors ? draw_y(g, column, box, xi.y) : search_y(g, column, box, xi.y);
      pixel = (box->first.y + y.pixel) * g->stride + box->first.x + x.pixel;
      tau = ((double2)(x.at, y.at) - center) * per_rate;
#if STEPS == 2
      sum[0] += tau.x + tau.y + pixel;
      continue;
#endif
      const float importance = importance_at(g, image, pixel);
      ratio = importance > 0 ? 1 / importance : 0;
    }
    const float facing = (float)fmax(height + dot(view->slope, tau), 0.0);
    const float weight = ratio * phi((float)tau.x) * phi((float)tau.y) * facing * seen_at(sight, convert_float2(tau));
    const double2 u = (double2)(cell->u_x, cell->u_y) + (double2)(g->spacing_x, g->spacing_y) * tau;
    add_light(sum, weight, image + pixel, g->plane, lobe, &view->at, u);
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
  const int on_u = 2 * HALF * fmin(fabs(view.rate.x), fabs(view.rate.y)) < LEAST_SPAN;

  // The balance.
  double all = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    all += on_u ? mean_importance(&geometry, images + (size_t)m * CHANNELS * geometry.plane, &box, &view)
                : box_integral(&geometry, tables + (size_t)m * geometry.table, &box);
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
    const double a = on_u ? mean_importance(&geometry, image, &box, &view) : box_integral(&geometry, table, &box);
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
