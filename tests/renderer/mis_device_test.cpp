// The kernel against its host form in double: the same draws and weights, so the same light but for the few draws that
// rounding puts into another pixel.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/mis_shared.h"
#include "tests/support/host_and_kernel.h"
#include "tests/support/kernel_layout.h"

namespace lumifield {
namespace {

/// Every other one mirrors a point of the lamp or beside it.
std::vector<GlossLobe> lobes(const std::vector<Receiver>& at, bool coloured) {
  std::vector<GlossLobe> all = test::random_lobes(at, coloured);
  for (std::size_t k = 0; k < at.size(); k += 2) {
    const Vec3 to = (Vec3(40 * std::sin(0.7 * double(k)), 30 * std::cos(1.1 * double(k)), 0) - at[k].p_mm).normalized();
    const Eigen::Vector3f eye = (2 * at[k].n.dot(to) * at[k].n - to).cast<float>();
    all[k].eye_x = eye.x();
    all[k].eye_y = eye.y();
    all[k].eye_z = eye.z();
  }
  return all;
}

class MisDevice : public test::HostAndKernel {};
INSTANTIATE_TEST_SUITE_P(All, MisDevice, test::host_and_kernel_cases());

TEST_P(MisDevice, DrawsAndWeighsAsItsHostFormDoes) {
  // Lobes of light samples are in float.
  expect_as_host(Method::mis, test::receivers_at_all_heights(150), lobes, {1e-5, 5e-5, 4});
}

TEST(MisStructs, LieAlike) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  EXPECT_EQ(test::layout_by("mis", "mis_layout", 3),
            (std::vector<int>{sizeof(MisShares), offsetof(MisShares, diffuse), offsetof(MisShares, glossy_points)}));
}

}  // namespace
}  // namespace lumifield
