#pragma once

// What kernels that look up single rays' light know beside SamplingGeometry, shared with the host.

/// The grid of cells and how their images lie in memory: cell by cell, channel by channel, level by level.
typedef struct RayGeometry {
  double first_x, first_y;  ///< centre of cell (0, 0) on U
  double half_box;          ///< half the side of the box as broad as φ, in spacings
  int columns, rows;        ///< of the grid
  int levels;               ///< of an image, 1 where no footprint is averaged
  int plane, image;         ///< floats from channel to channel, from cell to cell
  int samples;              ///< whole, of one kind for each receiver
  int points;               ///< in the table of each kind
  int filter;               ///< a sample stands for a footprint
} RayGeometry;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(RayGeometry) == 56 && offsetof(RayGeometry, columns) == 24 && offsetof(RayGeometry, filter) == 52);
#endif
