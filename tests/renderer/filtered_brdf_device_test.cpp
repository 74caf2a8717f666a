// The kernel against its host form in double: the same directions, so the same light but for the few rays that rounding
// puts into another pixel.
#include <gtest/gtest.h>

#include "renderer/methods/lobe_sampling_shared.h"
#include "renderer/methods/ray_light_shared.h"
#include "tests/support/host_and_kernel.h"
#include "tests/support/kernel_layout.h"

namespace lumifield {
namespace {

class FilteredBrdfDevice : public test::HostAndKernel {};
INSTANTIATE_TEST_SUITE_P(All, FilteredBrdfDevice, test::host_and_kernel_cases());

TEST_P(FilteredBrdfDevice, DrawsAsItsHostFormDoes) {
  expect_as_host(Method::filtered_brdf, test::receivers_at_all_heights(200), test::random_lobes, {1e-5, 1e-5, 2});
}

TEST(RayStructs, LieAlike) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  EXPECT_EQ(test::layout_by("filtered_brdf", "ray_layout", 5),
            (std::vector<int>{sizeof(RayGeometry), offsetof(RayGeometry, columns), offsetof(RayGeometry, filter),
                              sizeof(LobePoint), offsetof(LobePoint, sin_phi)}));
}

}  // namespace
}  // namespace lumifield
