#include "renderer/visibility/tile_visibility.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

Sampling sampling_of(BasisKind basis) { return {basis, {7.5, 6}, 9, 7, {3, -2}}; }

TEST(TileGrid, SupportsAreWholeTiles) {
  for (const auto& [basis, n] :
       {std::pair(BasisKind::box, 1), {BasisKind::tent, 2}, {BasisKind::bell, 2}, {BasisKind::bspline2, 3}}) {
    const Sampling sampling = sampling_of(basis);
    const TileGrid grid(sampling);
    EXPECT_EQ(grid.per_support, n);
    EXPECT_EQ(grid.columns, 9 + n - 1);
    EXPECT_EQ(grid.rows, 7 + n - 1);
    // The middle of a cell's tiles is the cell.
    for (const CellIndex cell : {CellIndex{0, 0}, CellIndex{6, 8}, CellIndex{2, 5}}) {
      const Vec2 middle =
          (grid.center_mm(cell.column, cell.row) + grid.center_mm(cell.column + n - 1, cell.row + n - 1)) / 2;
      EXPECT_LT((middle - sampling.cell_center_mm(cell)).norm(), 1e-12);
    }
  }
}

TEST(TileVisibility, WeighsByTileOrByTheMean) {
  TileVisibility visible{.grid = TileGrid(sampling_of(BasisKind::bell)), .words = {}};
  ASSERT_EQ(visible.receiver_words(), 8U);
  visible.words.assign(3 * 8, 0);
  for (std::size_t row = 0; row < 8; ++row) visible.words[8 + row] = row < 4 ? 0b11'1111'1111 : 0;
  visible.words[8] &= ~1U;
  for (std::size_t row = 0; row < 8; ++row) visible.words[16 + row] = 0b11'1111'1111;
  EXPECT_EQ(sight_of(visible, 0), Sight::none);
  EXPECT_EQ(sight_of(visible, 1), Sight::some);
  EXPECT_EQ(sight_of(visible, 2), Sight::all);
  EXPECT_EQ(visible.share(1, {0, 0}, 0, 0), 0);
  EXPECT_EQ(visible.share(1, {0, 0}, 1, 0), 1);
  EXPECT_EQ(visible.share(1, {3, 4}, 4, 3), 1);
  EXPECT_EQ(visible.share(1, {3, 4}, 4, 4), 0);
  EXPECT_EQ(visible.mean_share(1, {3, 4}), 0.5) << "whatever its tiles are weighed by";
  visible.weighing = ShadowWeighing::mean;
  EXPECT_EQ(visible.share(1, {0, 0}, 0, 0), 0.75);
  EXPECT_EQ(visible.share(1, {3, 4}, 4, 3), 0.5);
}

TEST(TileVisibility, HasAsManyWordsAsColumnsNeed) {
  TileVisibility visible{.grid = TileGrid({BasisKind::tent, {1, 1}, 40, 3, {0, 0}}), .words = {}};
  ASSERT_EQ(visible.row_words(), 2U);
  visible.words.assign(visible.receiver_words(), 0);
  visible.set_seen(0, 40, 2);
  EXPECT_EQ(visible.words[2 * 2 + 1], 1U << 8);
  EXPECT_TRUE(visible.sees(0, 40, 2));
  EXPECT_FALSE(visible.sees(0, 40, 1));
}

}  // namespace
}  // namespace lumifield
