// Irradiance in closed form: one running sum in double per receiver and channel. Built with BASIS (0 box, 1 tent, 2 bell,
// 3 bspline2), CHANNELS and BUNCH, the receivers of a work-item that adds many cells.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif
#ifndef BUNCH
#define BUNCH 16
#endif

#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/closed_form_axis.clh"
#include "renderer/methods/closed_form_horizon.clh"
#include "renderer/methods/closed_form_sum.clh"
#define WIDTH 16
#include "renderer/methods/closed_form_wide.clh"
#if CHANNELS == 1
#define ABREAST 1
#include "renderer/methods/closed_form_abreast.clh"
#define ABREAST 3
#include "renderer/methods/closed_form_abreast.clh"
#else
#include "renderer/methods/closed_form_together.clh"
#endif
#undef WIDTH
#define WIDTH 8
#include "renderer/methods/closed_form_wide.clh"
#if CHANNELS == 1
#define ABREAST 1
#include "renderer/methods/closed_form_abreast.clh"
#define ABREAST 3
#include "renderer/methods/closed_form_abreast.clh"
#else
#include "renderer/methods/closed_form_together.clh"
#endif
#undef WIDTH

// The pixel `number` of an axis as an interval of X within the support.
double2 interval(double rate, double low, int number) {
  return clamp((double2)(low + number, low + number + 1) / fmax(rate, LEAST_RATE), -HALF, HALF);
}

// Σ C ∬ φφ max(0, g) over a block where the horizon cuts the support: pixels well above it by their moments, those near
// it clipped in double. Near U pixels are too narrow, near S too wide for float to place them: all count as near it.
void cut_block(__global const float* c, int plane, int stride, const ReceiverAxes* receiver,
               const CellAxes* axes, int2 start, const Weights16* wx, const Weights16* wy, const HorizonPlane* g,
               float deepest, double sign, double8* sum) {
  const double2 rates = receiver->rate;
  const int exact = fmax(rates.x, rates.y) > 300 || fmin(rates.x, rates.y) < 1;
  const int columns = min(BLOCK, axes->count.x - start.x), rows = min(BLOCK, axes->count.y - start.y);
  const double scale = sign / ((double)receiver->scale.x * receiver->scale.y);
  const float margin = (float)(0.02 * HALF * (fabs(g->x) + fabs(g->y)));
  const float half_support = HALF, rate = (float)fmax(rates.x, LEAST_RATE);
  const float16 low = clamp(((float)(axes->low.x + start.x) + LANES_16) / rate, -half_support, half_support);
  const float16 high = clamp(((float)(axes->low.x + start.x + 1) + LANES_16) / rate, -half_support, half_support);
  const float16 least_x = min((float)g->x * low, (float)g->x * high), most_x = max((float)g->x * low, (float)g->x * high);
  for (int j = 0; j < rows; ++j) {
    // Least and greatest g of the row's pixels.
    const double2 v = interval(rates.y, axes->low.y, start.y + j);
    const float16 least = least_x + (float)(g->k + fmin(g->y * v.x, g->y * v.y));
    const float16 most = most_x + (float)(g->k + fmax(g->y * v.x, g->y * v.y));

    // Pixels well above the horizon.
    const float w0 = ((const float*)&wy->w0)[j], w1 = ((const float*)&wy->w1)[j];
    const float16 moments = (float)sign * ((deepest * wx->w0 + wx->w1) * w0 + wx->w0 * w1);
    const float16 weight = select((float16)0, moments, least >= margin && (int16)!exact);
    for (int channel = 0; channel < CHANNELS; ++channel) {
      const float16 product = weight * vload16(0, c + channel * plane + j * stride);
      sum[channel] += convert_double8(product.lo + product.hi);
    }

    // Pixels near it.
    int near[BLOCK];
    vstore16((least < margin && most > -margin) || (int16)exact, 0, near);
    for (int i = 0; i < columns; ++i) {
      if (!near[i]) continue;
      const double clipped = scale * clipped_integral(g, (double4)(interval(rates.x, axes->low.x, start.x + i), v));
      for (int channel = 0; channel < CHANNELS; ++channel)
        sum[channel].s0 += clipped * c[channel * plane + j * stride + i];
    }
  }
}

// The pixels of a cell that are seen; what is below the horizon shows none.
INLINE CellAxes axes_of(const ClosedFormGeometry* geometry, const ReceiverView* view, double2 u) {
  const double2 corner = (double2)(geometry->corner_x, geometry->corner_y);
  return cell_axes(&view->axes, u, corner, (double2)(view->level.width, view->level.height));
}

// Adds a cell that is above the horizon, and tells whether it is cut instead.
INLINE int add_whole(const ClosedFormGeometry* geometry, const ReceiverView* view, const ClosedFormCell cell,
                     __global const float* images, double8* sum) {
  const int stride = view->level.stride, plane = geometry->plane;
  const double k = center_of(view, cell);
  if (k - view->span < 0) return k + view->span > 0;
  const CellAxes seen = axes_of(geometry, view, (double2)(cell.u_x, cell.u_y));
  if (seen.count.x <= 0 || seen.count.y <= 0) return 0;
  const ReceiverAxis x = axis_x(&view->axes), y = axis_y(&view->axes);
  __global const float* c =
      images + view->level.offset + (size_t)cell.image * plane + (size_t)seen.first.y * stride + seen.first.x;
  const float deepest = (float)(k - view->span);
  if (max(seen.count.x, seen.count.y) <= 8) {
    const Knots knots_x = knots_from(seen.whole_x, seen.part_x, 0), knots_y = knots_from(seen.whole_y, seen.part_y, 0);
    const Weights8 wx = weights_8(&knots_x, &x), wy = weights_8(&knots_y, &y);
    add_block_8(c, plane, stride, seen.count.y, &wx, &wy, deepest, cell.sign, sum);
    return 0;
  }
  for (int j = 0; j < seen.count.y; j += BLOCK) {
    const Knots knots_y = knots_from(seen.whole_y, seen.part_y, j);
    const Weights16 wy = weights_16(&knots_y, &y);
    const int rows = min(BLOCK, seen.count.y - j);
    for (int i = 0; i < seen.count.x; i += BLOCK) {
      const Knots knots_x = knots_from(seen.whole_x, seen.part_x, i);
      const Weights16 wx = weights_16(&knots_x, &x);
      add_block_16(c + j * stride + i, plane, stride, rows, &wx, &wy, deepest, cell.sign, sum);
    }
  }
  return 0;
}

// Adds a cell if the horizon cuts it.
INLINE void add_cut(const ClosedFormGeometry* geometry, const ReceiverView* view, const ClosedFormCell cell,
                    __global const float* images, double8* sum) {
  const int stride = view->level.stride;
  const HorizonPlane g = {center_of(view, cell), view->axes.tilt.x, view->axes.tilt.y};
  if (g.k + view->span <= 0 || g.k - view->span >= 0) return;
  const CellAxes seen = axes_of(geometry, view, (double2)(cell.u_x, cell.u_y));
  const ReceiverAxis x = axis_x(&view->axes), y = axis_y(&view->axes);
  __global const float* c =
      images + view->level.offset + (size_t)cell.image * geometry->plane + (size_t)seen.first.y * stride + seen.first.x;
  for (int i = 0; i < seen.count.x; i += BLOCK) {
    const Knots knots_x = knots_from(seen.whole_x, seen.part_x, i);
    const Weights16 wx = weights_16(&knots_x, &x);
    for (int j = 0; j < seen.count.y; j += BLOCK) {
      const Knots knots_y = knots_from(seen.whole_y, seen.part_y, j);
      const Weights16 wy = weights_16(&knots_y, &y);
      cut_block(c + j * stride + i, geometry->plane, stride, &view->axes, &seen, (int2)(i, j), &wx, &wy, &g,
                (float)(g.k - view->span), cell.sign, sum);
    }
  }
}

#include "renderer/methods/closed_form_grid.clh"

INLINE void add_sums(const ClosedFormGeometry* geometry, const ReceiverView* view, const double8* sum,
                     __global double* sums) {
  const double z = view->at.p_z, separation = geometry->separation;
  const double factor = separation * separation * geometry->spacing_x * geometry->spacing_y / (z * z * z) *
                        view->axes.scale.x * view->axes.scale.y;
  for (int channel = 0; channel < CHANNELS; ++channel) {
    const double4 four = sum[channel].lo + sum[channel].hi;
    sums[channel] += factor * ((four.x + four.y) + (four.z + four.w));
  }
}

// A few cells, one work-item for each receiver.
__kernel void closed_form_add(const ClosedFormGeometry geometry, __global const ClosedFormReceiver* receivers,
                              __global const ClosedFormCell* cells, __global const float* images,
                              __global const ClosedFormLevel* levels, __global double* sums) {
  const int id = get_global_id(0);
  if (id >= geometry.receivers || !is_lit(receivers[id])) return;
  const ReceiverView view = view_of(&geometry, receivers[id], levels);
  double8 sum[CHANNELS];
  for (int channel = 0; channel < CHANNELS; ++channel) sum[channel] = 0;
  // A cell by itself is no loop: what a compiler takes out of one costs as much as it would save.
  int cut = 0;
  if (geometry.cells == 1)
    cut = add_whole(&geometry, &view, cells[0], images, sum);
  else
    for (int m = 0; m < geometry.cells; ++m) cut |= add_whole(&geometry, &view, cells[m], images, sum);
  if (cut)
    for (int m = 0; m < geometry.cells; ++m) add_cut(&geometry, &view, cells[m], images, sum);
  add_sums(&geometry, &view, sum, sums + (size_t)id * CHANNELS);
}

// Many cells of a grid, one work-item for BUNCH receivers: row by row, so that the pixels that neighbouring receivers see
// of its cells stay in the nearest cache. u: of the columns, then of the rows; row_begin: of the cells of each row.
__kernel void closed_form_add_grid(const ClosedFormGeometry geometry, __global const ClosedFormReceiver* receivers,
                                   __global const ClosedFormCell* cells, __global const float* images,
                                   __global const ClosedFormLevel* levels, __global double* sums,
                                   const ClosedFormGrid grid, __global const double* u, __global const int* row_begin) {
  const int first = get_global_id(0) * BUNCH, count = min(BUNCH, geometry.receivers - first);
  GridReceiver all[BUNCH];
  for (int i = 0; i < count; ++i) {
    GridReceiver* r = all + i;
    r->lit = is_lit(receivers[first + i]);
    if (!r->lit) continue;
    r->view = view_of(&geometry, receivers[first + i], levels);
    for (int channel = 0; channel < CHANNELS; ++channel) r->sum[channel] = 0;
    see_grid(&geometry, &grid, u, r);
  }
  for (int row = 0; row < grid.rows; ++row) {
    const int begin = row_begin[row], end = row_begin[row + 1];
    for (int m = begin; m < end; m += SIDE_BY_SIDE)
      for (int i = 0; i < count; ++i) {
        if (!all[i].lit) continue;
        if (all[i].one_by_one)
          add_row(&geometry, cells, images, m, min(m + SIDE_BY_SIDE, end), row, all + i);
        else if (m == begin && all[i].apart)
          add_row_apart(&geometry, cells, images, begin, end, all + i);
        else if (m == begin)
          add_row(&geometry, cells, images, begin, end, row, all + i);
      }
  }
  for (int i = 0; i < count; ++i)
    if (all[i].lit) add_sums(&geometry, &all[i].view, all[i].sum, sums + (size_t)(first + i) * CHANNELS);
}

// Sizes and offsets of the shared structs as the device lays them out, for a test.
__kernel void closed_form_layout(__global int* layout) {
  ClosedFormGeometry geometry;
  ClosedFormReceiver receiver;
  ClosedFormCell cell;
  ClosedFormLevel level;
  ClosedFormGrid grid;
  layout[0] = sizeof geometry;
  layout[1] = (int)((char*)&geometry.corner_x - (char*)&geometry);
  layout[2] = (int)((char*)&geometry.levels - (char*)&geometry);
  layout[3] = (int)((char*)&geometry.cells - (char*)&geometry);
  layout[4] = sizeof receiver;
  layout[5] = (int)((char*)&receiver.n_z - (char*)&receiver);
  layout[6] = sizeof cell;
  layout[7] = (int)((char*)&cell.sign - (char*)&cell);
  layout[8] = (int)((char*)&cell.image - (char*)&cell);
  layout[9] = sizeof level;
  layout[10] = (int)((char*)&level.offset - (char*)&level);
  layout[11] = (int)((char*)&cell.column - (char*)&cell);
  layout[12] = sizeof grid;
  layout[13] = (int)((char*)&grid.rows - (char*)&grid);
  ClosedFormTiles tiles;
  layout[14] = sizeof tiles;
  layout[15] = (int)((char*)&tiles.first - (char*)&tiles);
}
