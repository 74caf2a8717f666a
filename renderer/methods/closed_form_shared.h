#pragma once

// Structs that the host and the kernels of the closed form share: int, float, float4, and double where positions need
// it. Their layout is asserted on the host and read back from the device by a test.

/// The luminaire but its cells. Lengths in mm.
typedef struct ClosedFormGeometry {
  double separation;            ///< δ
  double spacing_x, spacing_y;  ///< a
  double corner_x, corner_y;    ///< edge of pixel (0, 0) on S
  double pixel_x, pixel_y, pixels_per_mm_x, pixels_per_mm_y;
  double lod;  ///< pixels per support and axis
  int levels;  ///< of an image, 1 where all is exact
  int plane;   ///< floats from channel to channel, all levels of one after the other
  int receivers;
  int cells;  ///< in this run
} ClosedFormGeometry;

/// One level of detail of the images.
typedef struct ClosedFormLevel {
  int width, height;
  int stride;  ///< floats from row to row; what follows a row's pixels is 0 for at least one vector
  int offset;  ///< floats from the begin of the channel
} ClosedFormLevel;

typedef struct ClosedFormReceiver {
  double p_x, p_y, p_z, n_x, n_y, n_z;
} ClosedFormReceiver;

typedef struct ClosedFormCell {
  double u_x, u_y;  ///< centre on U
  double sign;      ///< +1 adds, −1 takes away what the cell had added
  int image;        ///< its first plane, counted in planes
  int column;       ///< of the run's grid
} ClosedFormCell;

/// The rows and columns that a run over many cells spans, at most these of each.
#define GRID_CELLS 16
typedef struct ClosedFormGrid {
  int columns, rows;
} ClosedFormGrid;

/// The tiles of U (renderer/visibility/tile_grid.h), and which receivers of a list a run takes.
typedef struct ClosedFormTiles {
  int columns, rows;
  int row_words;                ///< of a receiver's bits, 0: it sees all
  int mean;                     ///< a cell's light is weighed by the mean of its tiles' bits
  int first_column, first_row;  ///< of the run's grid, in cells
  int first, receivers;         ///< of the list
} ClosedFormTiles;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(double) == 8 && sizeof(int) == 4);
static_assert(sizeof(ClosedFormGeometry) == 96 && offsetof(ClosedFormGeometry, corner_x) == 24 &&
              offsetof(ClosedFormGeometry, levels) == 80 && offsetof(ClosedFormGeometry, cells) == 92);
static_assert(sizeof(ClosedFormLevel) == 16 && offsetof(ClosedFormLevel, offset) == 12);
static_assert(sizeof(ClosedFormReceiver) == 48 && offsetof(ClosedFormReceiver, n_z) == 40);
static_assert(sizeof(ClosedFormCell) == 32 && offsetof(ClosedFormCell, sign) == 16 &&
              offsetof(ClosedFormCell, image) == 24 && offsetof(ClosedFormCell, column) == 28);
static_assert(sizeof(ClosedFormGrid) == 8 && offsetof(ClosedFormGrid, rows) == 4);
static_assert(sizeof(ClosedFormTiles) == 32 && offsetof(ClosedFormTiles, first) == 24);
#endif
