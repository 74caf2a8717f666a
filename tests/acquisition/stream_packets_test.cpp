#include "acquisition/cameras/stream_packets.h"

#include <gtest/gtest.h>

namespace lumifield {
namespace {

/// A network that passes packets up to a size, and loses one of the frames where they come too fast.
struct Network {
  int largest_bytes;
  double fastest_us = 0;
  int asked = 0;

  TryPackets answer() {
    return [this](const StreamPackets& packets) {
      ++asked;
      if (packets.bytes > largest_bytes) return 0;
      return packets.delay_us >= fastest_us ? frames_per_try : frames_per_try - 1;
    };
  }
};

std::optional<StreamPackets> found(Network network) { return find_packets(220, 16404, 4, network.answer()); }

TEST(StreamPackets, AreTheLargestThatPass) {
  EXPECT_EQ(found({16404}), (StreamPackets{16404, 0}));
  EXPECT_EQ(found({16403}), (StreamPackets{9000, 0}));
  EXPECT_EQ(found({1500}), (StreamPackets{1500, 0}));
  EXPECT_EQ(found({1499}), (StreamPackets{1400, 0}));
  EXPECT_EQ(found({576}), (StreamPackets{576, 0}));
  EXPECT_EQ(found({575}), std::nullopt);
}

TEST(StreamPackets, ThatTheCameraCanSend) {
  Network network{9000};
  EXPECT_EQ(find_packets(300, 8000, 100, network.answer()), (StreamPackets{8000, 0}));
  network.largest_bytes = 1500;
  EXPECT_EQ(find_packets(300, 8000, 100, network.answer()), (StreamPackets{1500, 0}));
  EXPECT_EQ(find_packets(300, 8000, 64, network.answer()), (StreamPackets{1452, 0})) << "300 and steps of 64";
  EXPECT_EQ(find_packets(1480, 8000, 1, network.answer()), (StreamPackets{1500, 0}));
}

TEST(StreamPackets, ArePausedWhereFramesAreLost) {
  EXPECT_EQ(found({9000, 30}), (StreamPackets{9000, 40}));
  EXPECT_EQ(found({9000, 160}), (StreamPackets{9000, 160}));
  EXPECT_EQ(found({9000, 1000}), (StreamPackets{9000, 0})) << "nothing helps: most frames arrive";
}

TEST(StreamPackets, OfALossyNetworkAreThoseThatMostlyPass) {
  const TryPackets lossy = [](const StreamPackets& packets) { return packets.bytes == 1500 ? 2 : 1; };
  EXPECT_EQ(find_packets(220, 16404, 4, lossy), (StreamPackets{1500, 0}));
}

TEST(StreamPackets, AreRememberedUntilForgotten) {
  EXPECT_EQ(remembered_packets("a"), std::nullopt);
  remember_packets("a", StreamPackets{1500, 10});
  remember_packets("b", StreamPackets{9000, 0});
  EXPECT_EQ(remembered_packets("a"), (StreamPackets{1500, 10}));
  remember_packets("a", std::nullopt);
  EXPECT_EQ(remembered_packets("a"), std::nullopt);
  EXPECT_EQ(remembered_packets("b"), (StreamPackets{9000, 0}));
  remember_packets("b", std::nullopt);
}

}  // namespace
}  // namespace lumifield
