// Multiple importance sampling of light samples with lobe samples: renderer/methods/mis.h. One work-item per receiver.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

#ifndef BASIS
#define BASIS 2
#endif
#ifndef CHANNELS
#define CHANNELS 1
#endif

#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/sampling_shared.h"
#include "renderer/methods/lobe_sampling_shared.h"
#include "renderer/methods/ray_light_shared.h"
#include "renderer/methods/closed_form_shared.h"
#include "renderer/methods/mis_shared.h"
#include "renderer/methods/sampling_view.clh"
#include "renderer/methods/gloss.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/sampling_look.clh"
#include "renderer/methods/sampling_box.clh"
#include "renderer/methods/light_draws.clh"
#include "renderer/methods/lobe_sampling.clh"
#include "renderer/methods/ray_light.clh"

// What all samples of a receiver have in common.
typedef struct {
  const SamplingGeometry* g;
  const RayGeometry* rays;
  const View* view;
  __global const int* slots;
  __global const ClosedFormLevel* levels;
  __global const float* images;
  const SamplingLooks* looks;
  __global const uint* bits;
  int id, on_u;
  Lobe dull, glossy;
  int shines, gloss;  // whether there is a glossy lobe; lobe samples are its
  int count;          // N
  int filter;
  int split;              // lobe samples alone make gloss, and light samples alone what is diffuse
  double per_area;        // of q_m on U: by importance, 1/mm²
  double2 low, high;      // the lamp's part of U
  double even;            // K_L over its area
} Mixture;

// A ray from u and what both kinds of samples weigh it by.
typedef struct {
  double3 direction;
  double length, area;  // of U by solid angle, mm²/sr
  double facing;        // n·ω
  double gloss;         // pdf_g
  double lobes;         // b
} Ray;

INLINE double lobe_pdf(const Lobe* l, double3 i) {
  if (l->kind == LOBE_PHONG) return (l->shape + 1) / (2 * PI) * pow(fmax(dot(l->axis, i), 0.0), l->shape);
  const double3 h = unit_of(i + l->eye);
  if (!(dot(l->normal, h) > 0)) return 0;
  const double3 across = cross(l->normal, h);
  const double a2 = l->shape * l->shape, d = a2 + (1 - a2) * dot(across, across);
  return a2 / (PI * d * d) / (2 * (l->no + l->spread));
}

INLINE Ray ray_from(const Mixture* m, double2 u) {
  const SamplingReceiver at = m->view->at;
  const double3 to = (double3)(u.x - at.p_x, u.y - at.p_y, -at.p_z);
  const double d2 = dot(to, to);
  Ray ray;
  ray.length = sqrt(d2);
  ray.area = d2 * ray.length / at.p_z;
  ray.direction = to / ray.length;
  ray.facing = dot(m->dull.n, ray.direction);
  ray.gloss = m->shines ? lobe_pdf(&m->glossy, ray.direction) : 0;
  ray.lobes = m->count * (m->gloss ? ray.gloss : fmax(dot(m->dull.normal, ray.direction), 0.0) / PI);
  return ray;
}

// Share of a square about u that is on the lamp.
INLINE double on_lamp(const Mixture* m, double2 u, double width) {
  const double2 part = fmax(fmin(u + width / 2, m->high) - fmax(u - width / 2, m->low), (double2)0);
  return part.x * part.y / (width * width);
}

INLINE double lobe_width(int kind, double shape) {
  return fmin(kind == LOBE_PHONG ? 1 / sqrt(shape) : 2 * shape, 1.0);
}

// Of the square by which a lobe is told.
INLINE double lamp_shown(const Mixture* m, double3 axis, double width) {
  if (!(axis.z < 0)) return 0;
  const double length = m->view->at.p_z / -axis.z;
  const double2 u = (double2)(m->view->at.p_x, m->view->at.p_y) + length * axis.xy;
  return on_lamp(m, u, MIS_REACH * width * length / sqrt(-axis.z));
}

// Which lobe is sampled, before any is set up: most receivers show nothing of the lamp.
INLINE void choose_lobe(Mixture* m, __global const GlossLobe* lobe, const MisShares* shares) {
  const double3 n = unit_of((double3)(m->view->at.n_x, m->view->at.n_y, m->view->at.n_z));
  m->shines = m->gloss = m->split = 0;
#if LOBES > 0
  if (lobe->kind != LOBE_NONE) {
    const double3 eye = unit_of((double3)(lobe->eye_x, lobe->eye_y, lobe->eye_z));
    const double no = dot(n, eye), width = lobe_width(lobe->kind, lobe->shape);
    m->shines = no > 0;
    m->gloss = m->shines && lamp_shown(m, 2 * no * n - eye, width) >= MIS_SHOWS;
    m->split = m->gloss && m->rays->filter && width <= MIS_SPLITS;
  }
#endif
  m->count = m->gloss ? shares->glossy : lamp_shown(m, n, 1) >= MIS_SHOWS ? shares->diffuse : 0;
  m->filter = m->gloss && m->rays->filter;
}

INLINE double footprint(const Ray* ray) { return fmin(sqrt(ray->area / ray->lobes), 0.5 * ray->length); }

// q_m, by importance; filtered as if even over the lamp, averaged over the footprint.
INLINE double light_density(const Mixture* m, const Ray* ray, double importance) {
  return ray->area * m->per_area * importance;
}
INLINE double even_density(const Mixture* m, const Ray* ray, double2 u) {
  return ray->area * m->even * on_lamp(m, u, footprint(ray));
}

// The weight of a light sample; importance: its cell's, or of that on U the mean.
INLINE float light_share(const Mixture* m, double2 u, double importance) {
  const Ray ray = ray_from(m, u);
  if (!(ray.lobes > 0)) return 1;
  const double q = m->filter ? even_density(m, &ray, u) : light_density(m, &ray, importance);
  return (float)(q / (q + ray.lobes));
}

// Σ_m C Φ δ²/cos⁴θ over q_m + b by channel of the ray from u, of all cells that it meets.
INLINE void add_cells(const Mixture* m, const Ray* ray, double2 u, float* light) {
  const SamplingGeometry* g = m->g;
  const RayGeometry* rays = m->rays;
  const double2 on_s = on_s_px(g, m->view, u);
  if (!(on_s.x >= 0 && on_s.x < g->width && on_s.y >= 0 && on_s.y < g->height)) return;
  const int pixel = (int)on_s.y * g->stride + (int)on_s.x;
  const double2 at = (u - (double2)(rays->first_x, rays->first_y)) / (double2)(g->spacing_x, g->spacing_y);
  const Range columns = range_of(at.x, HALF, rays->columns), rows = range_of(at.y, HALF, rays->rows);
  const double slant = ray->length / m->view->at.p_z, slant2 = slant * slant;
  const double scale = g->separation * g->separation * slant2 * slant2;
  for (int row = rows.first; row < rows.end; ++row) {
    const float phi_y = phi((float)(at.y - row));
    for (int column = columns.first; column < columns.end; ++column) {
      const int slot = m->slots[row * rays->columns + column];
      if (slot < 0) continue;
      __global const float* image = m->images + (size_t)slot * rays->image;
      double importance = importance_at(g, image, pixel);
      if (!(importance > 0)) continue;
      if (m->on_u) {
        SamplingCell cell;
        cell.u_x = rays->first_x + column * g->spacing_x;
        cell.u_y = rays->first_y + row * g->spacing_y;
        const Box box = box_of(g, m->view, &cell);
        importance = mean_importance(g, image, &box, m->view) / (4 * HALF * HALF);
      }
      const float2 tau = (float2)((float)(at.x - column), (float)(at.y - row));
      const float factor = (float)(scale / (light_density(m, ray, importance) + ray->lobes)) * phi(tau.x) * phi_y *
                           seen_of_cell(m->looks, m->bits, m->id, column, row, tau);
      for (int c = 0; c < CHANNELS; ++c) light[c] += factor * image[c * rays->plane + pixel];
    }
  }
}

// The ray of a lobe sample, its density known from the draw.
INLINE Ray ray_of(const Mixture* m, const LobeDraw* draw) {
  const double p_z = m->view->at.p_z;
  Ray ray;
  ray.direction = draw->direction;
  ray.length = p_z / -draw->direction.z;
  ray.area = ray.length * ray.length * ray.length / p_z;
  ray.facing = dot(m->dull.n, draw->direction);
  ray.gloss = m->gloss ? draw->pdf : m->shines ? lobe_pdf(&m->glossy, draw->direction) : 0;
  ray.lobes = m->count * draw->pdf;
  return ray;
}

// Of a split receiver: they alone make its gloss.
INLINE void add_gloss_samples(const Mixture* m, int points, __global const LobePoint* table, double* sum) {
#if LOBES > 0
  const uint first = first_lobe_point(m->g, points, 2, (uint)m->id);
  const double2 turn = lobe_turn(m->g, 2, (uint)m->id);
  const SamplingReceiver at = m->view->at;
  for (int k = 0; k < m->count; ++k) {
    const uint i = first + (uint)k;
    const LobeDraw draw = lobe_draw(&m->glossy, turned(table[i < (uint)points ? i : i % (uint)points], turn));
    if (!(draw.direction.z < 0) || !(dot(m->glossy.n, draw.direction) > 0)) continue;
    const double length = at.p_z / -draw.direction.z;
    const double2 u = (double2)(at.p_x, at.p_y) + length * draw.direction.xy;
    const double width = fmin(length / sqrt(-draw.direction.z * m->count * draw.pdf), 0.5 * length);
    float light[CHANNELS];
    ray_light(m->g, m->rays, m->view, m->slots, m->levels, m->images, m->looks, m->bits, m->id, u, width, light);
    const float weight[3] = {draw.weight.x, draw.weight.y, draw.weight.z};
    for (int c = 0; c < GLOSSES; ++c)
      sum[CHANNELS + c] += weight[LOBES == 1 ? 0 : c] * light[CHANNELS == 1 ? 0 : c] / m->count;
  }
#endif
}

INLINE void add_lobe_samples(const Mixture* m, int points, __global const LobePoint* table, double* sum) {
  const Lobe* lobe = m->gloss ? &m->glossy : &m->dull;
  const uint first = first_lobe_point(m->g, points, m->gloss ? 2 : 1, (uint)m->id);
  const double2 turn = lobe_turn(m->g, m->gloss ? 2 : 1, (uint)m->id);
  const SamplingReceiver at = m->view->at;
  for (int k = 0; k < m->count; ++k) {
    const uint i = first + (uint)k;
    const LobeDraw draw = lobe_draw(lobe, turned(table[i < (uint)points ? i : i % (uint)points], turn));
    if (!(draw.direction.z < 0) || !(dot(lobe->n, draw.direction) > 0)) continue;
    const Ray ray = ray_of(m, &draw);
    if (!(ray.lobes > 0)) continue;
    const double2 u = (double2)(at.p_x, at.p_y) + ray.length * draw.direction.xy;
    float light[CHANNELS];
    for (int c = 0; c < CHANNELS; ++c) light[c] = 0;
    double scale = 1;
    if (m->filter) {
      ray_light(m->g, m->rays, m->view, m->slots, m->levels, m->images, m->looks, m->bits, m->id, u, footprint(&ray),
                light);
      scale = 1 / (ray.lobes + even_density(m, &ray, u));
    } else {
      add_cells(m, &ray, u, light);
    }
    for (int c = 0; c < CHANNELS; ++c) sum[c] += scale * ray.facing * light[c];
#if LOBES > 0
    if (!(ray.gloss > 0)) continue;
    const float3 shines = m->gloss ? draw.weight : lobe_weight(&m->glossy, draw.direction);
    const float f[3] = {shines.x, shines.y, shines.z};
    for (int c = 0; c < GLOSSES; ++c)
      sum[CHANNELS + c] += scale * ray.gloss * f[LOBES == 1 ? 0 : c] * light[CHANNELS == 1 ? 0 : c];
#endif
  }
}

// The samples of a cell. `mean`: of its importance near S.
INLINE void add_light_samples(const Mixture* m, const SamplingCell* cell, const CellDraws* draws, double mean,
                              __global const float* image, __global const double* table,
                              __global const double* columns, __global const float2* points,
                              __global const GlossLobe* lobe, int count, double* sum) {
  const SamplingGeometry* g = m->g;
  const double height = center_height(m->view, cell->u_x, cell->u_y);
  const uint first = first_point(g, (uint)cell->number, (uint)m->id);
  const CellSight sight = sight_of_cell(m->looks, m->bits, m->id, cell->number);
  for (int k = 0; k < count; ++k) {
    const float2 xi = sample_point(g, points, cell, first, k);
    const LightDraw draw = light_draw(g, m->view, cell, draws, table, columns, xi);
    if (draw.pixel < 0) continue;
    const double2 u = (double2)(cell->u_x, cell->u_y) + (double2)(g->spacing_x, g->spacing_y) * draw.tau;
    float weight = light_weight(g, m->view, height, m->on_u, image, &sight, &draw);
    if (m->split) {
      for (int c = 0; c < CHANNELS; ++c) sum[c] += weight * image[draw.pixel + c * g->plane];
      continue;
    }
    if (m->count > 0 && weight > 0) weight *= light_share(m, u, m->on_u ? mean : importance_at(g, image, draw.pixel));
    add_light(sum, weight, image + draw.pixel, g->plane, lobe, &m->view->at, u);
  }
}

__kernel void mis(const SamplingGeometry geometry, const RayGeometry rays, const MisShares shares,
                  __global const SamplingReceiver* receivers, __global const SamplingCell* cells,
                  __global const int* slots, __global const ClosedFormLevel* levels, __global const float* images,
                  __global const double* tables, __global const double* columns, __global const float2* points,
                  __global const LobePoint* diffuse_points, __global const LobePoint* glossy_points,
                  __global double* sums, const SamplingLooks looks, __global const uint* bits,
                  __global const GlossLobe* lobes, __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const View view = view_of(&geometry, receivers[id]);
  const double rates = fabs(view.rate.x * view.rate.y);
  const int on_u = draws_on_u(&view);
  double all = 0;
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    all += cell_light(&geometry, &view, &box, on_u, images + (size_t)m * rays.image,
                      tables + (size_t)m * geometry.table);
  }
  if (!(all > 0)) return;

  Mixture mix;
  mix.g = &geometry;
  mix.rays = &rays;
  mix.view = &view;
  mix.slots = slots;
  mix.levels = levels;
  mix.images = images;
  mix.looks = &looks;
  mix.bits = bits;
  mix.id = id;
  mix.on_u = on_u;
  const double2 spacing = (double2)(geometry.spacing_x, geometry.spacing_y);
  mix.low = (double2)(rays.first_x, rays.first_y) - HALF * spacing;
  mix.high = mix.low + ((double2)(rays.columns, rays.rows) + (2 * HALF - 1)) * spacing;
  choose_lobe(&mix, lobes + (LOBES > 0 ? id : 0), &shares);
  if (mix.count > 0) {
    mix.dull = mix.glossy = diffuse_lobe(&view.at);
#if LOBES > 0
    const GlossLobe own = lobes[id];
    if (mix.shines) mix.glossy = glossy_lobe(&view.at, &own);
#endif
  }
  const double samples = mix.split ? shares.light_apart : mix.gloss ? shares.light_beside : shares.light;
  mix.per_area = samples / all * (on_u ? 1 : rates) / (spacing.x * spacing.y);
  mix.even = samples / MIS_WORTH / ((mix.high.x - mix.low.x) * (mix.high.y - mix.low.y));

  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  double count = rounding_offset(geometry.seed, (uint)id);
  for (int m = 0; m < geometry.cells; ++m) {
    const SamplingCell cell = cells[m];
    const Box box = box_of(&geometry, &view, &cell);
    __global const float* image = images + (size_t)m * rays.image;
    __global const double* table = tables + (size_t)m * geometry.table;
    const double a = cell_light(&geometry, &view, &box, on_u, image, table);
    const double kappa = samples * (a / all), before = floor(count);
    count += kappa;
    const int drawn = (int)(floor(count) - before);
    if (drawn <= 0) continue;
    CellDraws draws;
    prepare_draws(&geometry, &box, on_u, a, table, &draws);
    double part[VALUES];
    for (int c = 0; c < VALUES; ++c) part[c] = 0;
    add_light_samples(&mix, &cell, &draws, a / (4 * HALF * HALF), image, table, columns + (size_t)m * geometry.columns,
                      points, lobes + (LOBES > 0 ? id : 0), drawn, part);
    const double scale = view.factor * (on_u ? 4 * HALF * HALF : a / rates) / kappa;
    for (int c = 0; c < VALUES; ++c) sum[c] += scale * part[c];
  }
  if (mix.split)
    add_gloss_samples(&mix, shares.glossy_points, glossy_points, sum);
  else
    add_lobe_samples(&mix, mix.gloss ? shares.glossy_points : shares.diffuse_points,
                     mix.gloss ? glossy_points : diffuse_points, sum);
  keep_values(sum, 1, id, sums, gloss);
}

// Sizes and offsets of the shared struct as the device lays it out, for a test.
__kernel void mis_layout(__global int* layout) {
  MisShares shares;
  layout[0] = sizeof shares;
  layout[1] = (int)((char*)&shares.diffuse - (char*)&shares);
  layout[2] = (int)((char*)&shares.glossy_points - (char*)&shares);
}
