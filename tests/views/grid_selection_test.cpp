#include "app/views/grid_selection.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

using Cells = std::set<CellIndex>;

TEST(GridSelection, ARangeReachesFromWhereItBegan) {
  GridSelection s;
  s.extend_to({2, 2});
  EXPECT_EQ(s.selected(), (Cells{{2, 2}}));
  s.extend_to({1, 3});
  EXPECT_EQ(s.selected(), (Cells{{1, 2}, {1, 3}, {2, 2}, {2, 3}}));
  s.extend_to({3, 2});  // from the anchor again, not from the last
  EXPECT_EQ(s.selected(), (Cells{{2, 2}, {3, 2}}));
  EXPECT_EQ(s.current(), (CellIndex{3, 2}));
}

TEST(GridSelection, SingleOnesGoInAndOut) {
  GridSelection s;
  s.choose({0, 0});
  s.toggle({0, 5});
  EXPECT_EQ(s.selected(), (Cells{{0, 0}, {0, 5}}));
  s.toggle({0, 0});
  EXPECT_EQ(s.selected(), (Cells{{0, 5}}));
  EXPECT_EQ(s.current(), (CellIndex{0, 0}));
  s.choose({1, 1});
  EXPECT_EQ(s.selected(), (Cells{{1, 1}}));
}

TEST(GridSelection, ABandAddsOrReplaces) {
  GridSelection s;
  s.choose({9, 9});
  s.span({1, 1}, {0, 0}, true);
  EXPECT_EQ(s.selected().size(), 5U);
  s.span({1, 1}, {0, 0}, false);
  EXPECT_EQ(s.selected(), (Cells{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  s.set({{4, 4}, {4, 5}});
  EXPECT_EQ(s.current(), (CellIndex{4, 4}));
}

}  // namespace
}  // namespace lumifield
