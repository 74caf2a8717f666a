// Tables are bounded before memory or time is taken, on the host and for the kernels.
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/device_method.h"
#include "renderer/methods/host_method.h"
#include "renderer/methods/lobe_sampling.h"
#include "renderer/methods/mis.h"
#include "renderer/methods/table_memory.h"
#include "renderer/renderer.h"
#include "renderer/study/synthetic_luminaire.h"

namespace lumifield {
namespace {

/// One cell, all of 1.
LightField flat_luminaire(const Vec2& spacing_mm, int width_px, int height_px, double pixel_mm) {
  LuminaireGeometry g;
  g.planes.separation_mm = 60;
  g.sampling = {BasisKind::bell, spacing_mm, 1, 1, {0, 0}};
  g.measurement = {width_px, height_px, {pixel_mm, pixel_mm}, {0, 0}};
  g.channels = {"Y"};
  LightField field(g);
  const std::size_t pixels = g.measurement.pixels();
  EXPECT_TRUE(field.add({0, 0}, CellImage{width_px, height_px, 1, std::vector<float>(pixels, 1.0F), {}, {}}));
  return field;
}

/// The refusals of the host's form and, where there is OpenCL, of the kernel's.
std::vector<std::string> refusals(const LightField& field, const MethodSettings& settings) {
  std::vector<std::string> all;
  const auto host = make_host_method(field, settings);
  all.push_back(host ? "taken" : host.error().what);
  if (!probe_opencl()) return all;
  const auto device = make_device_method(field.geometry(), settings).value();
  const Status set = device->set_cells(field);
  all.push_back(set ? "taken" : set.error().what);
  return all;
}

TEST(MethodBounds, ATableOfTheFarFieldIsBounded) {
  const MethodSettings settings{.method = Method::far_field};
  for (const std::string& what : refusals(flat_luminaire({1e9, 1e9}, 8, 8, 1e-3), settings))
    EXPECT_EQ(what, "its table would have more than 2^31 entries");
  for (const std::string& what : refusals(flat_luminaire({1e300, 1e300}, 8, 8, 1e-3), settings))
    EXPECT_EQ(what, "its table would have more than 2^31 entries");
  for (const std::string& what : refusals(flat_luminaire({1e6, 1}, 1000000, 1, 1), settings))
    EXPECT_EQ(what, "its table takes 2e+12 multiply-adds, more than 1e+11")
        << "a million pixels, each at two million points";
  for (const std::string& what : refusals(flat_luminaire({8, 8}, 300, 300, 1), settings)) EXPECT_EQ(what, "taken");
}

TEST(MethodBounds, TablesTakeNoMoreMemoryThanTheyMay) {
  const LightField field = make_luminaire({.name = "small", .columns = 4, .rows = 3, .pixels = 64, .pixel_mm = 2});
  for (const Method method : {Method::position_dependent, Method::position_dependent_printed,
                              Method::precomputed_lights, Method::far_field}) {
    MethodSettings settings{.method = method, .samples = 1000};
    for (const std::string& what : refusals(field, settings)) EXPECT_EQ(what, "taken") << to_string(method);
    settings.memory_bytes = 10000;
    for (const std::string& what : refusals(field, settings))
      EXPECT_TRUE(what.ends_with(" MB, more than the 0.01 MB that they may")) << to_string(method) << ": " << what;
  }
}

TEST(MethodBounds, TablesOfDirectionsCountWithTheOthers) {
  const LightField field = make_luminaire({.name = "small", .columns = 4, .rows = 3, .pixels = 64, .pixel_mm = 2});
  for (const Method method : {Method::filtered_brdf, Method::mis})
    for (const PointSequence sequence : {PointSequence::halton, PointSequence::twister}) {
      MethodSettings settings{.method = method, .samples = 1e4, .sequence = sequence, .memory_bytes = 2e7};
      for (const std::string& what : refusals(field, settings)) EXPECT_EQ(what, "taken") << to_string(method);
      settings.samples = 1e6;
      for (const std::string& what : refusals(field, settings))
        EXPECT_TRUE(what.ends_with(" MB, more than the 20 MB that they may")) << to_string(method) << ": " << what;
    }
}

TEST(MethodBounds, DirectionsTake32BytesEachAndTheTwisterHasFourTables) {
  const auto bytes = [](Method method, double samples, PointSequence sequence) {
    return lobe_table_bytes({.method = method, .samples = samples, .sequence = sequence});
  };
  EXPECT_EQ(bytes(Method::filtered_brdf, most_samples, PointSequence::halton), 640e6);
  EXPECT_EQ(bytes(Method::filtered_brdf, most_samples, PointSequence::twister), 4 * 640e6);
  EXPECT_EQ(bytes(Method::position_dependent, most_samples, PointSequence::halton), 0);
  const MisCounts counts = mis_counts(most_samples);
  EXPECT_EQ(bytes(Method::mis, most_samples, PointSequence::halton), 32.0 * counts.diffuse + 32.0 * counts.glossy);
  for (const PointSequence sequence : {PointSequence::halton, PointSequence::twister})
    for (const int n : {1, 100, 5000})
      EXPECT_EQ(lobe_points(sequence, n, 1, LobeDraws::glossy).size(), lobe_table(sequence, n));
}

TEST(MethodBounds, MoreSamplesThanThereIsMemoryForAreRefusedBeforeTheirTable) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  const LightField field = make_luminaire({.name = "small", .columns = 4, .rows = 3, .pixels = 64, .pixel_mm = 2});
  for (const Method method : {Method::filtered_brdf, Method::mis}) {
    const auto device =
        make_device_method(field.geometry(), {.method = method, .samples = 100, .memory_bytes = 2e7}).value();
    ASSERT_TRUE(device->set_cells(field));
    ASSERT_TRUE(device->set_receivers(std::vector<Receiver>{{{0, 0, 140}, {0, 0, -1}}}));
    ASSERT_TRUE(device->set_samples(1e6, 1));
    const auto refused = device->evaluate(HUGE_VAL);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().what.find("more than the 20 MB"), std::string::npos) << refused.error().what;
    EXPECT_NE(refused.error().remedy.find("fewer samples"), std::string::npos);
    ASSERT_TRUE(device->set_samples(100, 1));
    EXPECT_TRUE(device->evaluate(HUGE_VAL).value());
  }
}

TEST(MethodBounds, LightsHoldTheTablesOfOneCellAtATime) {
  const MethodSettings lights{.method = Method::precomputed_lights, .samples = 1000};
  const LuminaireGeometry geometry = flat_luminaire({8, 8}, 300, 300, 1).geometry();
  EXPECT_EQ(host_table_bytes(geometry, lights, 1), host_table_bytes(geometry, lights, 63));
  MethodSettings sampler = lights;
  sampler.method = Method::position_dependent;
  EXPECT_EQ(host_table_bytes(geometry, sampler, 63), 63 * 8.0 * (300 * 300 + 301 * 301));
}

TEST(MethodBounds, HalfOfTheMemoryIsAllowedUnlessMoreIsGiven) {
  EXPECT_TRUE(check_table_memory({}, 50, 100));
  EXPECT_FALSE(check_table_memory({}, 51, 100));
  EXPECT_TRUE(check_table_memory({.memory_bytes = 80}, 80, 100));
  EXPECT_FALSE(check_table_memory({.memory_bytes = 80}, HUGE_VAL, HUGE_VAL));
  EXPECT_GT(host_memory_bytes(), 1e8);
}

}  // namespace
}  // namespace lumifield
