#include "renderer/bands.h"

#include <gtest/gtest.h>
#include <vector>

namespace lumifield {
namespace {

TEST(Bands, TheFirstOfAllBandsIsFound) {
  for (const std::size_t count : {std::size_t(0), std::size_t(7), std::size_t(100'000)}) {
    std::vector<char> is(count, 0);
    const auto first = [&] { return first_where(count, [&](std::size_t k) { return is[k] != 0; }); };
    EXPECT_EQ(first(), std::nullopt);
    // From the last to the first, so that each is before all those there are; in either half.
    for (const std::size_t k : {count - 1, count * 3 / 4, count / 2, count / 3, std::size_t(0)}) {
      if (k >= count) continue;
      is[k] = 1;
      EXPECT_EQ(first(), k) << "of " << count;
    }
  }
}

}  // namespace
}  // namespace lumifield
