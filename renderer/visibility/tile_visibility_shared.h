#pragma once

// Structs that the host and the kernel of the tiles' visibility share. Their layout is asserted on the host and read
// back from the device by a test. Lengths in mm, luminaire frame.

typedef struct ShadowTiles {
  int columns, rows;  ///< of the tiles
  int block;          ///< b×b tiles share a map
  int block_columns, block_rows;
  int row_words;     ///< of a receiver's bits
  int map_px;        ///< of a map's side
  int published;     ///< receivers beyond S have maps of their own
  int receivers;     ///< with those that fill the last work-item
  float separation;  ///< δ
} ShadowTiles;

/// The map of a block of tiles. First those from U, then those from S, each by block, row by row.
typedef struct ShadowTileMap {
  float e_x, e_y;
  float low_x, low_y;    ///< least x/z and y/z
  float step_x, step_y;  ///< a texel's
  float px_x, px_y;      ///< texels a unit
  float kept;            ///< 1 − bias
  int first;             ///< its first texel in the list of all; −1: none, the tiles are seen
} ShadowTileMap;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(int) == 4 && sizeof(float) == 4);
static_assert(sizeof(ShadowTiles) == 40 && offsetof(ShadowTiles, separation) == 36);
static_assert(sizeof(ShadowTileMap) == 40 && offsetof(ShadowTileMap, first) == 36);
#endif
