#include "renderer/study/stability.h"

#include <cmath>
#include <gtest/gtest.h>

#include "renderer/renderer.h"

namespace lumifield {
namespace {

TEST(Stability, NoMethodFailsInAnyCase) {
  if (const auto found = probe_opencl(); !found) GTEST_SKIP() << found.error().message();
  const auto rows = stability_table([](double, const std::string&) { return true; });
  ASSERT_TRUE(rows);
  int refused = 0;
  for (const StabilityRow& row : *rows) {
    EXPECT_NE(row.outcome, StabilityOutcome::failed)
        << to_string(row.method) << ", " << row.case_name << ": " << row.reason;
    EXPECT_EQ(row.outcome == StabilityOutcome::refused, std::isnan(row.rel_error)) << row.case_name;
    if (row.outcome == StabilityOutcome::refused) {
      EXPECT_FALSE(row.reason.empty()) << row.case_name;
      ++refused;
    }
    // Ours has an answer wherever the input is one, exact but for a chosen level of detail.
    const bool input = row.case_name.find("NaN") == std::string::npos && row.case_name.find("Inf") == std::string::npos;
    if (row.method == Method::closed_form && input) {
      EXPECT_EQ(row.outcome, StabilityOutcome::ok) << row.case_name;
      const bool coarse = row.case_name.starts_with("pyramid"), cut = row.case_name.starts_with("grazing");
      EXPECT_LE(row.rel_error, coarse ? 0.05 : cut ? 1e-3 : 1e-5) << row.case_name;
    }
    if (!input) {
      EXPECT_EQ(row.outcome, StabilityOutcome::refused) << row.case_name;
    }
  }
  EXPECT_EQ(rows->size(), stability_cases().size() * methods().size());
  EXPECT_GT(refused, 20);
}

TEST(Stability, CanBeStopped) {
  const auto rows = stability_table([](double, const std::string&) { return false; });
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().kind, ErrorKind::stopped);
}

}  // namespace
}  // namespace lumifield
