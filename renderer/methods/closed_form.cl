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

#define BLOCK 16

// Weights of 16 rows, to be read one by one.
typedef struct {
  float w0[BLOCK], w1[BLOCK];
} RowWeights;

INLINE void row_weights(const ReceiverAxes* receiver, const CellAxes* axes, int start, int from_low, RowWeights* rows) {
  const Weights w = weights(receiver->unit.y, receiver->scale.y, axes->whole_y, axes->part_y, start, from_low);
  vstore16(w.w0, 0, rows->w0);
  vstore16(w.w1, 0, rows->w1);
}

// Σ C (k w0 w0 + x w1 w0 + y w0 w1) over a block of 16 columns and `rows` rows, left in eight parts; g is taken at the end
// of the support that lies deepest, so that its terms have one sign.
INLINE float8 block_sum(__global const float* c, int stride, int rows, const Weights* wx, const RowWeights* wy, float4 g) {
  float16 plain = 0, tilted = 0, plain_odd = 0, tilted_odd = 0;
  int j = 0;
  for (; j + 1 < rows; j += 2) {
    const float16 row = vload16(0, c + j * stride), next = vload16(0, c + (j + 1) * stride);
    plain += row * wy->w0[j];
    tilted += row * wy->w1[j];
    plain_odd += next * wy->w0[j + 1];
    tilted_odd += next * wy->w1[j + 1];
  }
  if (j < rows) {
    const float16 row = vload16(0, c + j * stride);
    plain += row * wy->w0[j];
    tilted += row * wy->w1[j];
  }
  plain += plain_odd;
  tilted += tilted_odd;
  const float16 sum = plain * (g.x * wx->w0 + g.y * wx->w1) + tilted * (g.z * wx->w0);
  return sum.lo + sum.hi;
}

// The pixel `number` of an axis as an interval of X within the support.
double2 interval(double rate, double low, int number) {
  return clamp((double2)(low + number, low + number + 1) / fmax(rate, LEAST_RATE), -HALF, HALF);
}

// Σ C ∬ φφ max(0, g) over a block where the horizon cuts the support: pixels well above it by their moments, those near
// it clipped in double. Near U pixels are too narrow, near S too wide for float to place them: all count as near it.
void cut_block(__global const float* c, const ClosedFormGeometry* geometry, const ReceiverAxes* receiver,
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
      const float16 product = weight * vload16(0, c + channel * geometry->plane + j * geometry->stride);
      sum[channel] += convert_double8(product.lo + product.hi);
    }

    // Pixels near it.
    int near[BLOCK];
    vstore16((least < margin && most > -margin) || (int16)exact, 0, near);
    for (int i = 0; i < columns; ++i) {
      if (!near[i]) continue;
      const double clipped = scale * clipped_integral(g, (double4)(interval(rates.x, axes->low.x, start.x + i), v));
      for (int channel = 0; channel < CHANNELS; ++channel)
        sum[channel].s0 += clipped * c[channel * geometry->plane + j * geometry->stride + i];
    }
  }
}

__kernel void closed_form_add(const ClosedFormGeometry geometry, __global const ClosedFormReceiver* receivers,
                              __global const ClosedFormCell* cells, __global const float* images,
                              __global double* sums) {
  const int id = get_global_id(0);
  if (id >= geometry.receivers) return;
  const ClosedFormReceiver receiver = receivers[id];
  if (receiver.p_z <= 0 || (receiver.n_x == 0 && receiver.n_y == 0 && receiver.n_z == 0)) return;

  // What follows from the receiver alone.
  const double z = receiver.p_z, separation = geometry.separation;
  const double2 spacing = (double2)(geometry.spacing_x, geometry.spacing_y);
  const double2 corner = (double2)(geometry.corner_x, geometry.corner_y);
  const double2 pixel = (double2)(geometry.pixel_x, geometry.pixel_y);
  const double2 pixels = (double2)(geometry.width, geometry.height);
  const ReceiverAxes axes = receiver_axes((double2)(receiver.p_x, receiver.p_y), z, separation, spacing, pixel);
  const double forward = z >= separation ? 1 : -1;
  const double slope_x = forward * receiver.n_x * geometry.spacing_x, slope_y = forward * receiver.n_y * geometry.spacing_y;
  const double span = HALF * (fabs(slope_x) + fabs(slope_y));
  const double factor =
      separation * separation * geometry.spacing_x * geometry.spacing_y / (z * z * z) * ((double)axes.scale.x * axes.scale.y);

  double8 sum[CHANNELS];
  for (int channel = 0; channel < CHANNELS; ++channel) sum[channel] = 0;
  RowWeights wy;
  double row_u = NAN;  // of wy
  int row_start = -1;
  for (int m = geometry.first_cell; m < geometry.first_cell + geometry.cells; ++m) {
    // Above, below or across the horizon.
    const ClosedFormCell cell = cells[m];
    const double k = receiver.n_x * (cell.u_x - receiver.p_x) + receiver.n_y * (cell.u_y - receiver.p_y) - receiver.n_z * z;
    if (k + span <= 0) continue;

    // The pixels seen; the weights of rows are shared by the cells of a row of the grid.
    const CellAxes seen = cell_axes(&axes, (double2)(cell.u_x, cell.u_y), corner, pixel, pixels);
    if (seen.count.x <= 0 || seen.count.y <= 0) continue;
    if (cell.u_y != row_u) row_start = -1;
    row_u = cell.u_y;
    __global const float* c =
        images + (size_t)cell.image * geometry.plane + (size_t)seen.first.y * geometry.stride + seen.first.x;

    const float sign = (float)cell.sign;
    const float4 deepest = sign * (float4)((float)(k - span), (float)fabs(slope_x), (float)fabs(slope_y), 0);
    const HorizonPlane g = {k, slope_x, slope_y};
    for (int i = 0; i < seen.count.x; i += BLOCK) {
      const Weights wx = weights(axes.unit.x, axes.scale.x, seen.whole_x, seen.part_x, i, slope_x >= 0);
      for (int j = 0; j < seen.count.y; j += BLOCK) {
        if (j != row_start) row_weights(&axes, &seen, row_start = j, slope_y >= 0, &wy);
        __global const float* block = c + j * geometry.stride + i;
        if (k - span < 0) {
          cut_block(block, &geometry, &axes, &seen, (int2)(i, j), &wx, &wy, &g, deepest, cell.sign, sum);
          continue;
        }
        for (int channel = 0; channel < CHANNELS; ++channel)
          sum[channel] += convert_double8(block_sum(block + channel * geometry.plane, geometry.stride,
                                                    min(BLOCK, seen.count.y - j), &wx, &wy, deepest));
      }
    }
  }
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
  layout[0] = sizeof geometry;
  layout[1] = (int)((char*)&geometry.corner_x - (char*)&geometry);
  layout[2] = (int)((char*)&geometry.width - (char*)&geometry);
  layout[3] = (int)((char*)&geometry.cells - (char*)&geometry);
  layout[4] = sizeof receiver;
  layout[5] = (int)((char*)&receiver.n_z - (char*)&receiver);
  layout[6] = sizeof cell;
  layout[7] = (int)((char*)&cell.sign - (char*)&cell);
  layout[8] = (int)((char*)&cell.image - (char*)&cell);
}
