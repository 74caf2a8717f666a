#include "app/session/beside.h"

#include <future>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>

namespace lumifield {
namespace {

using std::chrono::milliseconds;

/// For what must come: only a test that fails waits so long.
constexpr milliseconds patience(60'000);

TEST(Beside, WhatHangsHoldsUpNobodyButIsKnown) {
  std::promise<void> answer;
  auto used = std::make_shared<int>(1);
  const std::weak_ptr<int> left = used;
  run_beside(
      "reading", [used = std::move(used), waits = answer.get_future().share()] { waits.wait(); },
      [](const Error&) { ADD_FAILURE(); });
  EXPECT_FALSE(beside_ended(milliseconds(1)));
  answer.set_value();
  EXPECT_TRUE(beside_ended(patience));
  EXPECT_TRUE(left.expired()) << "what the work used is gone when it counts as ended";
}

TEST(Beside, WhatIsThrownIsTold) {
  std::promise<std::string> told;
  run_beside(
      "reading", [] { throw std::runtime_error("the disk is on fire"); },
      [&](const Error& error) {
        told.set_value(error.message());
        throw std::bad_alloc();
      });
  std::future<std::string> text = told.get_future();
  ASSERT_EQ(text.wait_for(patience), std::future_status::ready);
  EXPECT_THAT(text.get(), testing::HasSubstr("reading: failed unexpectedly: the disk is on fire"));
  EXPECT_TRUE(beside_ended(patience));
}

}  // namespace
}  // namespace lumifield
