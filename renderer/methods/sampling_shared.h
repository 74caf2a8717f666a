#pragma once

// Structs that the host and the kernels of the sampling methods share; layout asserted below and read back from the
// device by a test.

/// The luminaire but its cells, and what is drawn. Lengths in mm, positions on S in pixels from the image's corner.
typedef struct SamplingGeometry {
  double separation;            ///< δ
  double spacing_x, spacing_y;  ///< a
  double corner_x, corner_y;    ///< edge of pixel (0, 0) on S
  double pixel_x, pixel_y;
  double samples, k_max;          ///< K; K_max, or 0
  int width, height;              ///< of an image
  int stride;                     ///< floats from row to row; also doubles from row to row of the summed-area table
  int plane;                      ///< floats from channel to channel
  int column_stride;              ///< doubles from column to column of the column sums
  int table, columns;             ///< doubles from cell to cell: summed-area table, column sums
  int cells;                      ///< in the table of cells
  int first_receiver, receivers;  ///< of this run, and the end
  int points, twister;            ///< in the sequence's table; whether each cell and receiver begins at its own place
  unsigned seed;
  int reserved;
} SamplingGeometry;

typedef struct SamplingReceiver {
  double p_x, p_y, p_z, n_x, n_y, n_z;
} SamplingReceiver;

typedef struct SamplingCell {
  double u_x, u_y;         ///< centre on U
  float shift_x, shift_y;  ///< of the sequence
  int number;              ///< in the grid
  int first_light;         ///< precomputed lights: of the cell; the next cell's is the end
} SamplingCell;

/// What the receivers' appearance is read by.
typedef struct SamplingLooks {
  int columns, rows;  ///< tiles of U
  int row_words;      ///< of a receiver's bits
  int mean;           ///< a cell's light is weighed by the mean of its tiles' bits
  int grid_columns;   ///< cells in a row of the grid
} SamplingLooks;

#ifndef __OPENCL_C_VERSION__
#include <cstddef>
static_assert(sizeof(SamplingGeometry) == 128 && offsetof(SamplingGeometry, width) == 72 &&
              offsetof(SamplingGeometry, first_receiver) == 104 && offsetof(SamplingGeometry, seed) == 120);
static_assert(sizeof(SamplingReceiver) == 48 && offsetof(SamplingReceiver, n_z) == 40);
static_assert(sizeof(SamplingCell) == 32 && offsetof(SamplingCell, shift_x) == 16 &&
              offsetof(SamplingCell, first_light) == 28);
static_assert(sizeof(SamplingLooks) == 20 && offsetof(SamplingLooks, grid_columns) == 16);
#endif
