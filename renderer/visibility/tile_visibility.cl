// Which tiles of U receivers see, by depth maps (renderer/visibility/tile_shadows.h). Built with RECEIVERS, the receivers
// of a work-item: 1, or on a processor as many as its vectors take.

#ifndef RECEIVERS
#define RECEIVERS 8
#endif

#include "renderer/visibility/tile_visibility_shared.h"

#define JOINED_(name, width) name##width
#define JOINED(name, width) JOINED_(name, width)
#if RECEIVERS == 1
#define FLOATS float
#define INTS int
#define UINTS uint
#define LANES(condition) (-(condition))
#define ANY(lanes) ((lanes) != 0)
#define TO_INTS convert_int
#define AS_UINTS as_uint
#else
#define FLOATS JOINED(float, RECEIVERS)
#define INTS JOINED(int, RECEIVERS)
#define UINTS JOINED(uint, RECEIVERS)
#define LANES(condition) (condition)
#define ANY(lanes) any(lanes)
#define TO_INTS JOINED(convert_int, RECEIVERS)
#define AS_UINTS JOINED(as_uint, RECEIVERS)
#endif
#define INLINE inline __attribute__((always_inline))

typedef struct {
  FLOATS p_x, p_y, p_z, n_x, n_y, n_z;
} Receivers;

INLINE Receivers take(__global const float4* positions, __global const float4* faces) {
  union {
    FLOATS of[6];
    float lane[6][RECEIVERS];
  } all;
#pragma unroll
  for (int k = 0; k < RECEIVERS; ++k) {
    const float4 p = positions[k], n = faces[k];
    all.lane[0][k] = p.x;
    all.lane[1][k] = p.y;
    all.lane[2][k] = p.z;
    all.lane[3][k] = n.x;
    all.lane[4][k] = n.y;
    all.lane[5][k] = n.z;
  }
  const Receivers taken = {all.of[0], all.of[1], all.of[2], all.of[3], all.of[4], all.of[5]};
  return taken;
}

INLINE FLOATS gather(__global const float* depth, INTS at) {
  union {
    FLOATS all;
    float lane[RECEIVERS];
  } values;
  union {
    INTS all;
    int lane[RECEIVERS];
  } places;
  places.all = at;
#pragma unroll
  for (int k = 0; k < RECEIVERS; ++k) values.lane[k] = depth[places.lane[k]];
  return values.all;
}

// Lanes of the receivers that the map's surfaces hide from e; height and per_height: of the receivers over e, along z.
INLINE INTS hidden(const ShadowTileMap map, int map_px, __global const float* depths, const Receivers* r,
                   FLOATS height, FLOATS per_height) {
  // Find the texel.
  const FLOATS q_x = r->p_x - map.e_x, q_y = r->p_y - map.e_y;
  const FLOATS x = (q_x * per_height - map.low_x) * map.px_x, y = (q_y * per_height - map.low_y) * map.px_y;
  const float last = map_px - 1;
  const FLOATS i = fmin(fmax(floor(x), 0.0f), last), j = fmin(fmax(floor(y), 0.0f), last);
  const INTS inside = LANES((x >= 0.0f) & (x < (float)map_px) & (y >= 0.0f) & (y < (float)map_px));
  const FLOATS depth = gather(depths, TO_INTS(j) * map_px + TO_INTS(i));

  // Compare with the receiver and with its face at the texel's centre, which is at own/across where they agree in sign.
  const FLOATS own = (r->n_x * q_x + r->n_y * q_y + r->n_z * height) * map.kept;
  const FLOATS across =
      r->n_x * (map.low_x + (i + 0.5f) * map.step_x) + r->n_y * (map.low_y + (j + 0.5f) * map.step_y) + r->n_z;
  const INTS before_receiver = LANES(depth < height * map.kept);
  const INTS before_face = LANES(depth * fabs(across) < fabs(own));
  const INTS has_face = LANES(((own > 0.0f) & (across > 0.0f)) | ((own < 0.0f) & (across < 0.0f)));
  return inside & before_receiver & (before_face | ~has_face);
}

// The tiles of a row of blocks in one word; those beyond the grid too.
INLINE UINTS word_of(const ShadowTiles* tiles, __global const ShadowTileMap* maps, __global const float* depths,
                     const Receivers* r, FLOATS height, FLOATS per_height, int word) {
  const int b = tiles->block, begin = 32 * word / b;
  const int end = min(tiles->block_columns, (32 * (word + 1) + b - 1) / b);
  const uint ones = b == 32 ? ~0u : (1u << b) - 1;
  UINTS bits = ~0u;
  for (int k = begin; k < end; ++k) {
    const ShadowTileMap map = maps[k];
    if (map.first < 0) continue;
    const int shift = k * b - 32 * word;
    const uint tile = shift < 0 ? ones >> -shift : ones << shift;
    bits &= ~(AS_UINTS(hidden(map, tiles->map_px, depths + map.first, r, height, per_height)) & tile);
  }
  return bits;
}

__kernel void tile_visibility(const ShadowTiles tiles, __global const ShadowTileMap* maps, __global const float* depths,
                              __global const float4* positions, __global const float4* faces, __global uint* words) {
  const int first = (int)get_global_id(0) * RECEIVERS;
  if (first >= tiles.receivers) return;
  const Receivers r = take(positions + first, faces + first);

  // Who sees anything, and from which maps.
  const INTS lit = LANES((r.p_z > 0.0f) & (r.n_x * r.n_x + r.n_y * r.n_y + r.n_z * r.n_z > 0.0f));
  const INTS beyond = tiles.published ? LANES(r.p_z > tiles.separation) : (INTS)0;
  const int blocks = tiles.block_columns * tiles.block_rows;
  const size_t receiver_words = (size_t)tiles.row_words * tiles.rows;

  for (int row = 0; row < tiles.block_rows; ++row)
    for (int word = 0; word < tiles.row_words; ++word) {
      UINTS bits = 0;
#pragma unroll
      for (int set = 0; set < 2; ++set) {
        const INTS lanes = lit & (set ? beyond : ~beyond);
        if (!ANY(lanes)) continue;
        const FLOATS height = set ? r.p_z - tiles.separation : r.p_z;
        bits |= AS_UINTS(lanes) & word_of(&tiles, maps + set * blocks + row * tiles.block_columns, depths, &r, height,
                                          1.0f / height, word);
      }
      const int columns = min(32, tiles.columns - 32 * word);
      bits &= columns == 32 ? ~0u : (1u << columns) - 1;
      union {
        UINTS all;
        uint lane[RECEIVERS];
      } of;
      of.all = bits;
      const int end = min(tiles.rows, (row + 1) * tiles.block);
#pragma unroll
      for (int k = 0; k < RECEIVERS; ++k)
        for (int j = row * tiles.block; j < end; ++j)
          words[(first + k) * receiver_words + j * tiles.row_words + word] = of.lane[k];
    }
}

__kernel void tile_visibility_layout(__global int* layout) {
  layout[0] = sizeof(ShadowTiles);
  layout[1] = sizeof(ShadowTileMap);
  ShadowTiles tiles;
  ShadowTileMap map;
  layout[2] = (int)((private char*)&tiles.separation - (private char*)&tiles);
  layout[3] = (int)((private char*)&map.first - (private char*)&map);
}
