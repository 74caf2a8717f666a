// Filtered importance sampling of what receivers reflect: renderer/methods/filtered_brdf.h. One work-item per receiver.
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
#include "renderer/methods/sampling_view.clh"
#include "renderer/methods/gloss.clh"
#include "renderer/methods/tile_sight.clh"
#include "renderer/methods/sampling_look.clh"
#include "renderer/methods/lobe_sampling.clh"
#include "renderer/methods/ray_light.clh"

__kernel void filtered_brdf(const SamplingGeometry geometry, const RayGeometry rays,
                            __global const SamplingReceiver* receivers, __global const int* slots,
                            __global const ClosedFormLevel* levels, __global const float* images,
                            __global const LobePoint* diffuse_points, __global const LobePoint* glossy_points,
                            __global double* sums, const SamplingLooks looks, __global const uint* bits,
                            __global const GlossLobe* lobes, __global double* gloss) {
  const int id = geometry.first_receiver + (int)get_global_id(0);
  if (id >= geometry.receivers || unlit(receivers[id])) return;
  const View view = view_of(&geometry, receivers[id]);
  double sum[VALUES];
  for (int c = 0; c < VALUES; ++c) sum[c] = 0;
  for (int kind = 1; kind <= (LOBES > 0 ? 2 : 1); ++kind) {
    Lobe lobe;
    if (kind == 1) {
      lobe = diffuse_lobe(&view.at);
    } else {
      const GlossLobe own = lobes[id];
      if (own.kind == LOBE_NONE) break;
      lobe = glossy_lobe(&view.at, &own);
      if (!(lobe.no > 0)) break;
    }
    __global const LobePoint* points = kind == 1 ? diffuse_points : glossy_points;
    const uint first = first_lobe_point(&geometry, rays.points, (uint)kind, (uint)id);
    const double2 turn = lobe_turn(&geometry, (uint)kind, (uint)id);
    for (int k = 0; k < rays.samples; ++k) {
      const uint i = first + (uint)k;
      const LobeDraw draw = lobe_draw(&lobe, turned(points[i < (uint)rays.points ? i : i % (uint)rays.points], turn));
      if (!(draw.direction.z < 0) || !(dot(lobe.n, draw.direction) > 0)) continue;
      const double distance = -view.at.p_z / draw.direction.z;
      const double2 u = (double2)(view.at.p_x, view.at.p_y) + distance * draw.direction.xy;
      const double width = rays.filter ? distance / sqrt(-draw.direction.z * rays.samples * draw.pdf) : 0;
      float light[CHANNELS];
      ray_light(&geometry, &rays, &view, slots, levels, images, &looks, bits, id, u, width, light);
      const float weight[3] = {draw.weight.x, draw.weight.y, draw.weight.z};
      if (kind == 1)
        for (int c = 0; c < CHANNELS; ++c) sum[c] += weight[0] * light[c];
      else
        for (int c = 0; c < GLOSSES; ++c)
          sum[CHANNELS + c] += weight[LOBES == 1 ? 0 : c] * light[CHANNELS == 1 ? 0 : c];
    }
  }
  keep_values(sum, 1.0 / rays.samples, id, sums, gloss);
}

// Sizes and offsets of the shared structs as the device lays them out, for a test.
__kernel void ray_layout(__global int* layout) {
  RayGeometry geometry;
  LobePoint point;
  layout[0] = sizeof geometry;
  layout[1] = (int)((char*)&geometry.columns - (char*)&geometry);
  layout[2] = (int)((char*)&geometry.filter - (char*)&geometry);
  layout[3] = sizeof point;
  layout[4] = (int)((char*)&point.sin_phi - (char*)&point);
}
