// Irradiance in closed form: one work-item per receiver, one running sum in double per receiver and channel.
// Built with BASIS (0 box, 1 tent, 2 bell, 3 bspline2) and CHANNELS.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif

#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/closed_form_axis.clh"
#include "renderer/methods/closed_form_horizon.clh"
#include "renderer/methods/closed_form_sum.clh"
#include "renderer/methods/closed_form_four.clh"

// The pixel `number` of an axis as an interval of X within the support.
double2 interval(double rate, double low, int number) {
  return clamp((double2)(low + number, low + number + 1) / fmax(rate, LEAST_RATE), -HALF, HALF);
}

// Σ C ∬ φφ max(0, g) over a block where the horizon cuts the support: pixels well above it by their moments, those near
// it clipped in double. Near U pixels are too narrow, near S too wide for float to place them: all count as near it.
void cut_block(__global const float* c, int plane, int stride, const ReceiverAxes* receiver,
               const CellAxes* axes, int2 start, const Weights* wx, const RowWeights* wy, const HorizonPlane* g,
               float4 deepest, double sign, double8* sum) {
  const double2 rates = receiver->rate;
  const int exact = fmax(rates.x, rates.y) > 300 || fmin(rates.x, rates.y) < 1;
  const int columns = min(BLOCK, axes->count.x - start.x), rows = min(BLOCK, axes->count.y - start.y);
  const double scale = sign / ((double)receiver->scale.x * receiver->scale.y);
  const float margin = (float)(0.02 * HALF * (fabs(g->x) + fabs(g->y)));
  const float half_support = HALF, rate = (float)fmax(rates.x, LEAST_RATE);
  const float16 low = clamp(((float)(axes->low.x + start.x) + LANES) / rate, -half_support, half_support);
  const float16 high = clamp(((float)(axes->low.x + start.x + 1) + LANES) / rate, -half_support, half_support);
  const float16 least_x = min((float)g->x * low, (float)g->x * high), most_x = max((float)g->x * low, (float)g->x * high);
  for (int j = 0; j < rows; ++j) {
    // Least and greatest g of the row's pixels.
    const double2 v = interval(rates.y, axes->low.y, start.y + j);
    const float16 least = least_x + (float)(g->k + fmin(g->y * v.x, g->y * v.y));
    const float16 most = most_x + (float)(g->k + fmax(g->y * v.x, g->y * v.y));

    // Pixels well above the horizon.
    const float16 moments = (deepest.x * wx->w0 + deepest.y * wx->w1) * wy->w0[j] + deepest.z * wx->w0 * wy->w1[j];
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

// Adds a cell that is above the horizon, and tells whether it is cut instead. The weights of rows are shared by the cells
// of a row of the grid, at row_u; those of 16 rows from row_start on are in wy.
INLINE int add_whole(const ClosedFormGeometry* geometry, const ReceiverView* view, const ClosedFormCell cell,
                     __global const float* images, RowWeights* wy, double* row_u, int* row_start, double8* sum) {
  const int stride = view->level.stride, plane = geometry->plane;
  const double k = above_center(view, cell.u_x, cell.u_y);
  if (k - view->span < 0) return k + view->span > 0;
  const CellAxes seen = axes_of(geometry, view, (double2)(cell.u_x, cell.u_y));
  if (seen.count.x <= 0 || seen.count.y <= 0) return 0;
  if (cell.u_y != *row_u) *row_start = -1;
  *row_u = cell.u_y;
  const Columns c = {{images + (size_t)cell.image * plane + (size_t)seen.first.y * stride + seen.first.x}};
  const float sign = (float)cell.sign;
  const ColumnHorizon g = {sign * (float)(k - view->span), sign * (float)fabs(view->slope_x),
                           sign * (float)fabs(view->slope_y)};
  for (int j = 0; j < seen.count.y; j += BLOCK) {
    if (j != *row_start) row_weights(&view->axes, &seen, *row_start = j, view->slope_y >= 0, wy);
    const int rows = min(BLOCK, seen.count.y - j);
    for (int i = 0; i < seen.count.x; i += BLOCK) {
      const Knots knots = knots_of_one(seen.whole_x, seen.part_x, i);
      const Weights wx =
          weights(&knots, view->axes.unit.x, view->axes.scale.x, view->axes.per_scale.x, view->slope_x >= 0);
      for (int channel = 0; channel < CHANNELS; ++channel) {
        const float16 part = column_sums(&c, 1, j * stride + i + channel * plane, stride, rows, &wx, wy, &g);
        sum[channel] += convert_double8(part.lo + part.hi);
      }
    }
  }
  return 0;
}

// Adds the cells that the horizon cuts.
INLINE void add_cut(const ClosedFormGeometry* geometry, const ReceiverView* view, __global const ClosedFormCell* cells,
                    __global const float* images, int m, int end, RowWeights* wy, double8* sum) {
  const int stride = view->level.stride;
  for (; m < end; ++m) {
    const ClosedFormCell cell = cells[m];
    const HorizonPlane g = {above_center(view, cell.u_x, cell.u_y), view->slope_x, view->slope_y};
    if (g.k + view->span <= 0 || g.k - view->span >= 0) continue;
    const CellAxes seen = axes_of(geometry, view, (double2)(cell.u_x, cell.u_y));
    __global const float* c =
        images + (size_t)cell.image * geometry->plane + (size_t)seen.first.y * stride + seen.first.x;
    const float4 deepest =
        (float)cell.sign * (float4)((float)(g.k - view->span), (float)fabs(g.x), (float)fabs(g.y), 0);
    for (int i = 0; i < seen.count.x; i += BLOCK) {
      const Knots knots = knots_of_one(seen.whole_x, seen.part_x, i);
      const Weights wx = weights(&knots, view->axes.unit.x, view->axes.scale.x, view->axes.per_scale.x, g.x >= 0);
      for (int j = 0; j < seen.count.y; j += BLOCK) {
        row_weights(&view->axes, &seen, j, g.y >= 0, wy);
        cut_block(c + j * stride + i, geometry->plane, stride, &view->axes, &seen, (int2)(i, j), &wx, wy, &g, deepest,
                  cell.sign, sum);
      }
    }
  }
}

__kernel void closed_form_add(const ClosedFormGeometry geometry, __global const ClosedFormReceiver* receivers,
                              __global const ClosedFormCell* cells, __global const float* images,
                              __global const ClosedFormLevel* levels, __global double* sums) {
  const int id = get_global_id(0);
  if (id >= geometry.receivers) return;
  const ClosedFormReceiver receiver = receivers[id];
  if (receiver.p_z <= 0 || (receiver.n_x == 0 && receiver.n_y == 0 && receiver.n_z == 0)) return;

  // What follows from the receiver alone.
  const double z = receiver.p_z, separation = geometry.separation;
  const double2 spacing = (double2)(geometry.spacing_x, geometry.spacing_y);
  const double2 pixel = (double2)(geometry.pixel_x, geometry.pixel_y);
  const double forward = z >= separation ? 1 : -1;
  ReceiverView view;
  view.at = receiver;
  view.axes = receiver_axes((double2)(receiver.p_x, receiver.p_y), z, separation, spacing, pixel,
                            (double2)(geometry.pixels_per_mm_x, geometry.pixels_per_mm_y), geometry.lod,
                            geometry.levels);
  view.level = levels[view.axes.level];
  view.slope_x = forward * receiver.n_x * geometry.spacing_x;
  view.slope_y = forward * receiver.n_y * geometry.spacing_y;
  view.span = HALF * (fabs(view.slope_x) + fabs(view.slope_y));
  images += view.level.offset;

  double8 sum[CHANNELS];
  for (int channel = 0; channel < CHANNELS; ++channel) sum[channel] = 0;
  RowWeights wy;
  double row_u = NAN;  // of wy
  const int end = geometry.first_cell + geometry.cells;
  int m = geometry.first_cell;
  if (view.axes.level > 0) m = add_fours(&geometry, &view, cells, images, m, end, &wy, &row_u, sum);
  // A cell by itself is no loop: what a compiler takes out of one costs as much as it would save.
  int cut = 0, row_start = 0;
  if (end - m == 1)
    cut = add_whole(&geometry, &view, cells[m], images, &wy, &row_u, &row_start, sum);
  else
    for (int i = m; i < end; ++i) cut |= add_whole(&geometry, &view, cells[i], images, &wy, &row_u, &row_start, sum);
  if (cut) add_cut(&geometry, &view, cells, images, m, end, &wy, sum);
  const double factor =
      separation * separation * geometry.spacing_x * geometry.spacing_y / (z * z * z) * view.axes.scale.x * view.axes.scale.y;
  for (int channel = 0; channel < CHANNELS; ++channel) {
    const double4 four = sum[channel].lo + sum[channel].hi;
    sums[(size_t)id * CHANNELS + channel] += factor * ((four.x + four.y) + (four.z + four.w));
  }
}

// Sizes and offsets of the shared structs as the device lays them out, for a test.
__kernel void closed_form_layout(__global int* layout) {
  ClosedFormGeometry geometry;
  ClosedFormReceiver receiver;
  ClosedFormCell cell;
  ClosedFormLevel level;
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
}
