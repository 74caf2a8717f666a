// The closed form of receivers that see a part of U, or shine: split at the tiles of U, and finer (ClosedForm::light).
// Built with BASIS, CHANNELS, DIVISION and LOBES: 0, irradiance; 1 and 3, radiance by lobes of one or three colours.
// KEEP: the moments of a run's columns are kept, where its work-items have a cache of their own.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif
#ifndef DIVISION
#define DIVISION 1
#endif
#ifndef LOBES
#define LOBES 1
#endif
#ifndef KEEP
#define KEEP 1
#endif
// Values of a receiver: each channel by its lobe, or by the only one; or one channel by three.
#if LOBES == 3
#define OUTS 3
#else
#define OUTS CHANNELS
#endif

#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/closed_form_axis.clh"
#include "renderer/methods/closed_form_horizon.clh"
#include "renderer/methods/closed_form_sum.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/closed_form_moments.clh"
#include "renderer/methods/gloss.clh"

// A receiver and what its cells have in common.
typedef struct {
  ReceiverView view;
  TileAxis x, y;
  int forward;  // X grows with u
  __global const uint* bits;
  __global const float* corners;  // the lobe, by colour, row and column of the subtiles' corners
  int corner_columns, corner_plane;
} TileView;

// Of a cell: its place among the tiles.
typedef struct {
  CellSight sight;
  float deepest;  // n·(u − p), least on the support
  int column, row;
} TileCell;

// Subtile k of a support along X, counted along u.
INLINE int along_u(const TileView* t, int k) { return t->forward ? k : SUBTILES - 1 - k; }

#if LOBES > 0
// The lobe of one colour at the ends of subtile (i, j) in X: low and high end along x, of the low or high end along y.
INLINE float2 lobe_ends(const TileView* t, const TileCell* cell, int colour, int i, int j, int high) {
  const int column = cell->column * NODES + along_u(t, i), row = cell->row * NODES + along_u(t, j);
  const int at_row = row + STEP * (t->forward ? high : 1 - high);
  __global const float* f = t->corners + colour * t->corner_plane + at_row * t->corner_columns + column;
  return t->forward ? (float2)(f[0], f[STEP]) : (float2)(f[STEP], f[0]);
}
#endif

// What the columns' moments of a cell are to the rows of its subtile row j: weights of plain and rising row moments, by
// colour and end.
#if LOBES == 0
#define ENDS 1
#define COLOURS 1
#else
#define ENDS 2
#define COLOURS LOBES
#endif
typedef struct {
  float16 plain[COLOURS][ENDS], rising[COLOURS][ENDS];
} ColumnWeights;

// False where nothing is seen.
INLINE int column_weights(const TileView* t, const TileCell* cell, const Moments* x, int j, ColumnWeights* w) {
  for (int c = 0; c < COLOURS; ++c)
    for (int e = 0; e < ENDS; ++e) w->plain[c][e] = w->rising[c][e] = 0;
  int any = 0;
  for (int i = 0; i < SUBTILES; ++i) {
    const float v = cell->sight.share[TILE_OF(along_u(t, j))][TILE_OF(along_u(t, i))];
    if (v == 0) continue;
    any = 1;
#if LOBES == 0
    w->plain[0][0] += v * (cell->deepest * x[i].plain + x[i].rising);
    w->rising[0][0] += v * x[i].plain;
#else
    const float16 low = cell->deepest * x[i].plain + x[i].rising, high = cell->deepest * x[i].plain_high + x[i].rising_high;
    for (int c = 0; c < COLOURS; ++c)
      for (int e = 0; e < ENDS; ++e) {
        const float2 f = v * lobe_ends(t, cell, c, i, j, e);
        w->plain[c][e] += f.x * low + f.y * high;
        w->rising[c][e] += f.x * x[i].plain + f.y * x[i].plain_high;
      }
#endif
  }
  return any;
}

// The rows' moments of one subtile row as numbers, and which rows of a block it shows.
typedef struct {
  int begin, end;
  float plain[ENDS][BLOCK], rising[ENDS][BLOCK];
} RowMoments;

INLINE RowMoments row_moments(const Moments* m, int2 rows, int row) {
  RowMoments r;
  r.begin = max(rows.x - row, 0);
  r.end = min(rows.y - row, BLOCK);
  vstore16(m->plain, 0, r.plain[0]);
  vstore16(m->rising, 0, r.rising[0]);
#if LOBES > 0
  vstore16(m->plain_high, 0, r.plain[1]);
  vstore16(m->rising_high, 0, r.rising[1]);
#endif
  return r;
}

// Adds the pixels of rows `begin` to `end` of a block, of one subtile row. Where channels share a weight it is formed for
// each pixel, else the rows' moments are summed by themselves.
#if CHANNELS == 3 && COLOURS == 1
INLINE void add_rows(__global const float* pixels, int plane, int stride, int begin, int end, const ColumnWeights* w,
                     const RowMoments* y, float16* sum) {
  for (int j = begin; j < end; ++j) {
    float16 weight = w->plain[0][0] * y->plain[0][j] + w->rising[0][0] * y->rising[0][j];
#if ENDS == 2
    weight += w->plain[0][1] * y->plain[1][j] + w->rising[0][1] * y->rising[1][j];
#endif
#pragma unroll
    for (int o = 0; o < OUTS; ++o) sum[o] += weight * vload16(0, pixels + o * plane + j * stride);
  }
}
#else
INLINE void add_rows(__global const float* pixels, int plane, int stride, int begin, int end, const ColumnWeights* w,
                     const RowMoments* y, float16* sum) {
#pragma unroll
  for (int channel = 0; channel < CHANNELS; ++channel) {
    float16 plain[ENDS], rising[ENDS];
#pragma unroll
    for (int e = 0; e < ENDS; ++e) plain[e] = rising[e] = 0;
    for (int j = begin; j < end; ++j) {
      const float16 value = vload16(0, pixels + channel * plane + j * stride);
#pragma unroll
      for (int e = 0; e < ENDS; ++e) {
        plain[e] += value * y->plain[e][j];
        rising[e] += value * y->rising[e][j];
      }
    }
#pragma unroll
    for (int c = 0; c < COLOURS; ++c)
      if (CHANNELS == 1 || c == channel)
#pragma unroll
        for (int e = 0; e < ENDS; ++e) sum[c] += plain[e] * w->plain[c][e] + rising[e] * w->rising[c][e];
  }
}
#endif

// A pixel's part in a subtile, in X.
INLINE double2 part_of(const TileAxis* axis, const SeenAxis* seen, int pixel, int subtile) {
  const double rate = fmax(axis->rate, LEAST_RATE);
  const double begin = -HALF + subtile * LENGTH, end = -HALF + (subtile + 1) * LENGTH;
  return clamp((double2)(seen->low + pixel, seen->low + pixel + 1) / rate, begin, end);
}

// Adds a cell that the horizon cuts, pixel by pixel in double.
INLINE void add_cut_cell(const TileView* t, const TileCell* cell, double k, const SeenAxis* x, const SeenAxis* y,
                         __global const float* pixels, int plane, int stride, double sign, double8* sum) {
  const HorizonPlane g = {k, t->x.tilt, t->y.tilt};
  for (int v = 0; v < SUBTILES; ++v)
    for (int u = 0; u < SUBTILES; ++u) {
      const float seen = cell->sight.share[TILE_OF(along_u(t, v))][TILE_OF(along_u(t, u))];
      const double4 whole = (double4)(-HALF + u * LENGTH, -HALF + (u + 1) * LENGTH,
                                      -HALF + v * LENGTH, -HALF + (v + 1) * LENGTH);
      if (seen == 0 || highest(&g, whole) <= 0) continue;
      const int2 columns = shown_by(&t->x, x, u), rows = shown_by(&t->y, y, v);
      for (int j = rows.x; j < rows.y; ++j)
        for (int i = columns.x; i < columns.y; ++i) {
          const double4 r = (double4)(part_of(&t->x, x, i, u), part_of(&t->y, y, j, v));
          if (!(r.x < r.y && r.z < r.w)) continue;
          const double weight = sign * seen * clipped_integral(&g, r);
#if LOBES == 0
          const double f[1] = {1};
#else
          const double at_x = (0.5 * (r.x + r.y) - whole.x) * PER_LENGTH, at_y = (0.5 * (r.z + r.w) - whole.z) * PER_LENGTH;
          double f[COLOURS];
          for (int c = 0; c < COLOURS; ++c) {
            const float2 low = lobe_ends(t, cell, c, u, v, 0), high = lobe_ends(t, cell, c, u, v, 1);
            f[c] = (1 - at_y) * ((1 - at_x) * low.x + at_x * low.y) + at_y * ((1 - at_x) * high.x + at_x * high.y);
          }
#endif
          for (int o = 0; o < OUTS; ++o)
            sum[o].s0 += weight * f[COLOURS == 1 ? 0 : o] * pixels[(CHANNELS == 1 ? 0 : o) * plane + j * stride + i];
        }
    }
}

// One row of subtiles of a cell: x, the moments of 16 columns from `column`; `y` those of the rows of a block from `row`.
typedef struct {
  __global const float* pixels;  // of the cell's first pixel seen
  int plane, stride;
} SeenPixels;

INLINE void add_subtile_row(const TileView* t, const TileCell* cell, const Moments* x, int column, const RowMoments* y,
                            int j, int row, const SeenPixels* at, float16* sum) {
  ColumnWeights w;
  if (y->begin >= y->end || !column_weights(t, cell, x, j, &w)) return;
  add_rows(at->pixels + row * at->stride + column, at->plane, at->stride, y->begin, y->end, &w, y, sum);
}

INLINE void add_to(double8* sum, const float16* part, double sign) {
  for (int o = 0; o < OUTS; ++o) sum[o] += sign * convert_double8(part[o].lo + part[o].hi);
}

// The cells of a row of the run's grid.
INLINE void add_cell_row(const ClosedFormGeometry* geometry, const ClosedFormTiles* tiles, const TileView* t,
                         __global const ClosedFormCell* cells, int first, int last, int row, double u_y,
                         __global const float* images, const SeenAxis* columns, const Moments* kept, double8* sum) {
  const ReceiverView* view = &t->view;
  const SeenAxis y = seen_axis(&t->y, u_y, geometry->corner_y, view->level.height);
  if (y.count == 0) return;
  for (int block_y = 0; block_y < y.count; block_y += BLOCK) {
    RowMoments row_moments_of[SUBTILES];
    for (int j = 0; j < SUBTILES; ++j) {
      const Moments m = moments(&t->y, y.low + block_y, j);
      row_moments_of[j] = row_moments(&m, shown_by(&t->y, &y, j), block_y);
    }
    for (int m = first; m < last; ++m) {
      const ClosedFormCell cell = cells[m];
      const SeenAxis x = columns[cell.column];
      const double k = center_of(view, cell);
      TileCell of = {.deepest = (float)(k - view->span), .column = tiles->first_column + cell.column,
                     .row = tiles->first_row + row};
      of.sight = sight_of(t->bits, tiles->row_words, tiles->mean, of.column, of.row);
      if (x.count == 0 || !of.sight.any || k + view->span <= 0) continue;
      const SeenPixels at = {images + view->level.offset + (size_t)cell.image * geometry->plane +
                                 (size_t)y.first * view->level.stride + x.first,
                             geometry->plane, view->level.stride};
      if (k - view->span < 0) {
        if (block_y == 0) add_cut_cell(t, &of, k, &x, &y, at.pixels, at.plane, at.stride, cell.sign, sum);
        continue;
      }
      float16 part[OUTS];
      for (int o = 0; o < OUTS; ++o) part[o] = 0;
      for (int block_x = 0; block_x < x.count; block_x += BLOCK) {
        Moments made[SUBTILES];
        const Moments* of_columns = made;
        if (kept)
          of_columns = kept + cell.column * SUBTILES;
        else
          for (int i = 0; i < SUBTILES; ++i) made[i] = moments(&t->x, x.low + block_x, i);
        for (int j = 0; j < SUBTILES; ++j)
          add_subtile_row(t, &of, of_columns, block_x, row_moments_of + j, j, block_y, &at, part);
      }
      add_to(sum, part, cell.sign);
    }
  }
}

// list: receivers by themselves, and which of all they are; `bits` words of each; corners: of the run's receivers. `u`: of
// the run's columns, then of its rows; row_begin: of the cells of each row.
__kernel void closed_form_tiles(const ClosedFormGeometry geometry, __global const ClosedFormReceiver* list,
                                __global const ClosedFormCell* cells, __global const float* images,
                                __global const ClosedFormLevel* levels, __global double* sums, const ClosedFormGrid grid,
                                __global const double* u, __global const int* row_begin, const ClosedFormTiles tiles,
                                __global const int* number, __global const uint* bits, __global const float* corners) {
  const int id = tiles.first + (int)get_global_id(0);
  if (id >= tiles.receivers || !is_lit(list[id])) return;
  TileView t;
  t.view = view_of(&geometry, list[id], levels);
  t.x = tile_axis_x(&t.view.axes);
  t.y = tile_axis_y(&t.view.axes);
  t.forward = t.view.at.p_z >= geometry.separation;
  t.bits = bits + (size_t)id * tiles.row_words * tiles.rows;
  t.corner_columns = tiles.columns * NODES + 1;
  t.corner_plane = t.corner_columns * (tiles.rows * NODES + 1);
  t.corners = corners + (size_t)get_global_id(0) * COLOURS * t.corner_plane;

  SeenAxis columns[GRID_CELLS];
  int most = 0;
  for (int i = 0; i < grid.columns; ++i) {
    columns[i] = seen_axis(&t.x, u[i], geometry.corner_x, t.view.level.width);
    most = max(most, columns[i].count);
  }
  const Moments* kept = 0;
#if KEEP
  Moments all[GRID_CELLS * SUBTILES];
  if (most <= BLOCK) {
    for (int i = 0; i < grid.columns; ++i)
      for (int k = 0; columns[i].count > 0 && k < SUBTILES; ++k) all[i * SUBTILES + k] = moments(&t.x, columns[i].low, k);
    kept = all;
  }
#endif
  double8 sum[OUTS];
  for (int o = 0; o < OUTS; ++o) sum[o] = 0;
  for (int row = 0; row < grid.rows; ++row)
    add_cell_row(&geometry, &tiles, &t, cells, row_begin[row], row_begin[row + 1], row, u[grid.columns + row], images,
                 columns, kept, sum);

  const double z = t.view.at.p_z, separation = geometry.separation;
  const double factor = separation * separation * geometry.spacing_x * geometry.spacing_y / (z * z * z);
  for (int o = 0; o < OUTS; ++o) {
    const double4 four = sum[o].lo + sum[o].hi;
    sums[(size_t)number[id] * OUTS + o] += factor * ((four.x + four.y) + (four.z + four.w));
  }
}

#if LOBES > 0
// The lobes of the run's receivers at the corners of the subtiles that its cells have, a work-item for each receiver and
// row of corners. `at`: the low corner of the tiles, then the size of one, mm; `window`: first column and row of the
// corners, and how many.
__kernel void tile_lobes(const ClosedFormTiles tiles, __global const ClosedFormReceiver* list,
                         __global const GlossLobe* lobes, const double4 at, const int4 window,
                         __global float* corners) {
  const int columns = tiles.columns * NODES + 1, rows = tiles.rows * NODES + 1;
  const int item = get_global_id(0), id = tiles.first + item / window.w, row = window.y + item % window.w;
  if (id >= tiles.receivers) return;
  const ClosedFormReceiver r = list[id];
  const GlossLobe lobe = lobes[id];
  __global float* out = corners + (size_t)(item / window.w) * LOBES * rows * columns + row * columns;
  const float3 n = (float3)(r.n_x, r.n_y, r.n_z);
  const float no = towards_eye(&lobe, r.n_x, r.n_y, r.n_z);
  const double y = at.y + row * at.w / NODES - r.p_y, facing = r.n_y * y - r.n_z * r.p_z;
  const int end = window.x + window.z;
  for (int column = window.x; column < end; column += 16) {
    const double16 x = at.x + (column + LANES_D) * at.z / NODES - r.p_x;
    float16 grey, grazing;
    glossy_brdf_16(&lobe, n, no, convert_float16(x), (float)y, (float)-r.p_z, convert_float16(r.n_x * x + facing), &grey,
                   &grazing);
    const float colour[3] = {lobe.r, lobe.g, lobe.b};
    for (int c = 0; c < LOBES; ++c) {
      float values[16];
      vstore16(colour[c] * grey + (1 - colour[c]) * grazing, 0, values);
      for (int i = 0; i < min(16, end - column); ++i) out[c * columns * rows + column + i] = values[i];
    }
  }
}
#endif
