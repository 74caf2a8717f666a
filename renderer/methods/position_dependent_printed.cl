// Position-dependent importance sampling transcribed from the paper, step by step and sample by sample:
// renderer/methods/position_dependent_printed.h. One work-item per receiver.
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
#include "renderer/methods/sampling_box.clh"

// cdf^-1 by the modified secant over [low, high] of a table that is linear between whole numbers.
double inverse(__global const double* cdf, int pieces, double low, double high, float xi) {
  const int first = min((int)low, pieces - 1), last = min((int)high, pieces - 1);
  double at_low = cdf[first] + (low - first) * (cdf[first + 1] - cdf[first]);
  double at_high = cdf[last] + (high - last) * (cdf[last + 1] - cdf[last]);
  const double y = at_low + xi * (at_high - at_low);
  if (!(at_high > at_low)) return -1;
  for (int halve = 0;;) {
    const double first_in = floor(low) + 1, last_in = ceil(high) - 1, width = high - low;
    if (first_in > last_in) break;
    const double line = low + (y - at_low) / (at_high - at_low) * (high - low);
    const double knot = clamp(round(halve || !(at_high > at_low) ? (low + high) / 2 : line), first_in, last_in);
    const double value = cdf[(int)knot];
    if (value <= y) {
      low = knot;
      at_low = value;
    } else {
      high = knot;
      at_high = value;
    }
    halve = !halve && high - low > width / 2;
  }
  return at_high > at_low ? clamp(low + (y - at_low) / (at_high - at_low) * (high - low), low, high) : low;
}

float luminance_at(const SamplingGeometry* g, __global const float* image, int pixel) {
#if CHANNELS == 1
  return image[pixel];
#else
  return 0.2126f * image[pixel] + 0.7152f * image[g->plane + pixel] + 0.0722f * image[2 * g->plane + pixel];
#endif
}

// A_m in pixel² beyond S, on S the luminance of the pixel at p.
double area_of(const SamplingGeometry* g, const View* v, __global const float* image, __global const double* table,
               const Box* box) {
  if (v->r > 0) return box_integral(g, table, box);
  const double2 at = box->center;
  if (!(at.x >= 0 && at.x < g->width && at.y >= 0 && at.y < g->height)) return 0;
  return luminance_at(g, image, (int)at.y * g->stride + (int)at.x);
}

__kernel void position_dependent_printed(const SamplingGeometry geometry, __global const SamplingReceiver* receivers,
                                         __global const SamplingCell* cells, __global const float* images,
                                         __global const double* tables, __global const double* columns,
                                         __global const double* marginals, __global const float2* points,
                                         __global double* sums, const SamplingLooks looks,
                                         __global const uint* bits, __global const GlossLobe* lobes,
                                         __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const SamplingReceiver at = receivers[id];
  const View view = view_of(&geometry, at);
  const float delta = (float)(at.p_z - geometry.separation), separation = (float)geometry.separation;
  const double2 p = (double2)(at.p_x, at.p_y), spacing = (double2)(geometry.spacing_x, geometry.spacing_y);
  const float3 n = (float3)((float)at.n_x, (float)at.n_y, (float)at.n_z);

  // Step 1: A.
  double all = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    all += area_of(&geometry, &view, images + (size_t)m * CHANNELS * geometry.plane,
                   tables + (size_t)m * geometry.table, &box);
  }
  if (!(all > 0)) return;

  // Step 2: the samples of each image.
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    __global const float* image = images + (size_t)m * CHANNELS * geometry.plane;
    const double a = area_of(&geometry, &view, image, tables + (size_t)m * geometry.table, &box);
    double kappa = geometry.samples * (a / all);
    if (geometry.k_max > 0) kappa = fmin(kappa, geometry.k_max);
    const int samples = (int)floor(kappa + 0.5);
    const double2 u_m = (double2)(cell.u_x, cell.u_y);
    const uint first = first_point(&geometry, 0, (uint)id);
    const CellSight sight = sight_of_cell(&looks, bits, id, cell.number);
    double part[VALUES];
    for (int c = 0; c < VALUES; ++c) part[c] = 0;
    for (int k = 0; k < samples; ++k) {
      const float2 xi = sample_point(&geometry, points, &cell, first, k);
      double2 u;
      int i, j;
      if (view.r > 0) {
        const double x = inverse(marginals + (size_t)m * geometry.stride, geometry.width, box.low.x, box.high.x, xi.x);
        i = min((int)x, geometry.width - 1);
        if (x < 0) continue;
        const double y = inverse(columns + (size_t)m * geometry.columns + (size_t)i * geometry.column_stride,
                                 geometry.height, box.low.y, box.high.y, xi.y);
        j = min((int)y, geometry.height - 1);
        if (y < 0) continue;
        const double2 s = (double2)(geometry.corner_x, geometry.corner_y) +
                          (double2)(x, y) * (double2)(geometry.pixel_x, geometry.pixel_y);
        u = p + (s - p) * (at.p_z / (at.p_z - geometry.separation));
      } else {
        u = u_m + spacing * convert_double2((float)HALF * (2 * xi - 1));
        i = (int)box.center.x;
        j = (int)box.center.y;
      }
      // Ψ = Φ δ²/cos⁴θ; the receiver's cosine and 1/|·−p|³ on S, or on U from S itself.
      const float3 up = (float3)(convert_float2(u - p), -(separation + delta));
      const float distance = length(up);
      const float cosine = (separation + delta) / distance;
      const float2 tau = convert_float2((u - u_m) / spacing);
      const float psi = phi(tau.x) * phi(tau.y) * separation * separation / (cosine * cosine * cosine * cosine);
      const float facing = fmax(dot(n, up) / distance, 0.0f);
      const float to_plane = view.r > 0 ? delta : separation, share = to_plane / (separation + delta);
      const float along = view.r > 0 ? distance * share : distance;
      const int pixel = j * geometry.stride + i;
      const float luminance = luminance_at(&geometry, image, pixel);
      if (!(luminance > 0)) continue;
      const float weight = psi * facing * to_plane / (along * along * along) / luminance * seen_at(&sight, tau);
      add_light(part, weight, image + pixel, geometry.plane, lobes + (LOBES > 0 ? id : 0), &at, u);
    }
    const double pixel_area = view.r > 0 ? geometry.pixel_x * geometry.pixel_y
                                         : 4 * HALF * HALF * geometry.spacing_x * geometry.spacing_y;
    if (samples > 0)
      for (int c = 0; c < VALUES; ++c) sum[c] += a * pixel_area / samples * part[c];
  }
  keep_values(sum, 1, id, sums, gloss);
}
