#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

#include "acquisition/scan/scan_plan.h"
#include "acquisition/virtual/world.h"
#include "tests/support/small_bench.h"

namespace lumifield {
namespace {

/// The simulated benches, askew and scaled, take the 9 × 7 plan; behind the dark target they show no light.
TEST(ScanOnTheVirtualBench, ItsPlansFit) {
  for (const char* lamp : {"bike", "headlight", "led-array"})
    for (const StageCarries carries : {StageCarries::slide, StageCarries::lamp}) {
      virtual_bench::WorldOptions options;
      options.lamp = lamp;
      options.carries = carries;
      options.noise = false;
      options.width_px = 128, options.height_px = 96;
      const auto world = virtual_bench::World::create(options);
      ASSERT_TRUE(world) << world.error().message();
      const Bench& bench = (*world)->bench();
      const auto scan = make_scan_plan(bench, test::bell_plan());
      ASSERT_TRUE(scan) << lamp << ": " << scan.error().message();

      const auto brightest_dn = [&](const Vec2& stage_mm) {
        std::vector<std::uint16_t> dn(128 * 96);
        (*world)->prepare(stage_mm);
        (*world)->expose(stage_mm, 0.032, 0, 128, 96, 0, 0, dn);
        return *std::max_element(dn.begin(), dn.end());
      };
      EXPECT_LE(brightest_dn(dark_target_mm(bench)), bench.sensor.black_level_dn + 1);
      EXPECT_GT(brightest_dn(stage_target_mm(bench, Vec2(0, 0)) + bench.filter.passes[0].offset_mm),
                bench.sensor.black_level_dn + 50);
    }
}

}  // namespace
}  // namespace lumifield
