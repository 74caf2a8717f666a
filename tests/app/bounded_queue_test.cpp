#include "app/session/bounded_queue.h"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>

namespace lumifield {
namespace {

TEST(BoundedQueue, KeepsOrderAndNeverHoldsMoreThanItsBound) {
  BoundedQueue<int> queue(3);
  std::atomic<int> pushed{0};
  std::jthread producer([&] {
    for (int k = 0; k < 1000; ++k) {
      ASSERT_TRUE(queue.push(k));
      ++pushed;
    }
    queue.close();
  });
  int taken = 0;
  while (auto value = queue.pop()) {
    EXPECT_EQ(*value, taken++);
    // At most the bound, the one in hand, and one that the producer has not counted yet.
    EXPECT_LE(pushed, taken + 4);
  }
  EXPECT_EQ(taken, 1000);
}

TEST(BoundedQueue, ClosingDrainsForTheConsumerAndTurnsProducersAway) {
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(queue.push(1));
  EXPECT_TRUE(queue.try_push(2));
  EXPECT_FALSE(queue.try_push(3));
  queue.close();
  EXPECT_FALSE(queue.push(4));
  EXPECT_FALSE(queue.try_push(5));
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(BoundedQueue, ClosingWakesWaitingThreads) {
  BoundedQueue<int> full(1), empty(1);
  ASSERT_TRUE(full.push(1));
  std::atomic<int> woken{0};
  std::jthread producer([&] { woken += full.push(2) ? 0 : 1; });
  std::jthread consumer([&] { woken += empty.pop() ? 0 : 1; });
  full.close();
  empty.close();
  producer.join();
  consumer.join();
  EXPECT_EQ(woken, 2);
}

}  // namespace
}  // namespace lumifield
