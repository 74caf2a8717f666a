#include "acquisition/stages/apt_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

namespace lumifield {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAreArray;

// The examples of the protocol's document: KDC101 and TDC001 (unit 0x50), BBD and BSC (bays).
TEST(AptMessages, ShortOnes) {
  const std::pair<AptMessage, Bytes> cases[] = {
      {{AptId::hw_req_info}, {0x05, 0x00, 0x00, 0x00, 0x50, 0x01}},
      {{AptId::hw_req_info, 0, 0, apt_rack}, {0x05, 0x00, 0x00, 0x00, 0x11, 0x01}},
      {{AptId::hw_stop_updates}, {0x12, 0x00, 0x00, 0x00, 0x50, 0x01}},
      {{AptId::set_channel_enabled, 1, 1, 0x22}, {0x10, 0x02, 0x01, 0x01, 0x22, 0x01}},
      {{AptId::req_velocity, 1}, {0x14, 0x04, 0x01, 0x00, 0x50, 0x01}},
      {{AptId::req_home_params, 1}, {0x41, 0x04, 0x01, 0x00, 0x50, 0x01}},
      {{AptId::move_home, 1}, {0x43, 0x04, 0x01, 0x00, 0x50, 0x01}},
      {{AptId::move_stop, 1, 2}, {0x65, 0x04, 0x01, 0x02, 0x50, 0x01}},
      {{AptId::resume_end_of_move, 1}, {0x6c, 0x04, 0x01, 0x00, 0x50, 0x01}},
      {{AptId::req_status, 1, 0, 0x21}, {0x80, 0x04, 0x01, 0x00, 0x21, 0x01}},
      {{AptId::req_dc_status, 1}, {0x90, 0x04, 0x01, 0x00, 0x50, 0x01}},
      {{AptId::ack_status}, {0x92, 0x04, 0x00, 0x00, 0x50, 0x01}},
  };
  for (const auto& [message, bytes] : cases) EXPECT_EQ(encode(message), bytes) << int(message.id);
}

TEST(AptMessages, WithData) {
  // Position 200000 = 0x00030d40, and one below 0.
  EXPECT_THAT(encode({AptId::move_absolute, 0, 0, apt_unit, apt_host, apt_position_data(200000)}),
              ElementsAreArray({0x53, 0x04, 0x06, 0x00, 0xd0, 0x01, 0x01, 0x00, 0x40, 0x0d, 0x03, 0x00}));
  EXPECT_THAT(encode({AptId::move_absolute, 0, 0, 0x22, apt_host, apt_position_data(-2)}),
              ElementsAreArray({0x53, 0x04, 0x06, 0x00, 0xa2, 0x01, 0x01, 0x00, 0xfe, 0xff, 0xff, 0xff}));
  EXPECT_THAT(encode({AptId::set_velocity, 0, 0, apt_unit, apt_host, apt_velocity_data({0, 13744, 0x010203})}),
              ElementsAreArray({0x13, 0x04, 0x0e, 0x00, 0xd0, 0x01, 0x01, 0x00, 0x00, 0x00,
                                0x00, 0x00, 0xb0, 0x35, 0x00, 0x00, 0x03, 0x02, 0x01, 0x00}));
}

Bytes hardware_bytes() {
  Bytes bytes{0x06, 0x00, 0x54, 0x00, 0x81, 0x50, 0xc1, 0xfc, 0x9b, 0x01};  // serial 27000001
  for (const char c : std::string("KDC101")) bytes.push_back(std::uint8_t(c));
  bytes.insert(bytes.end(), {0, 0, 0x10, 0, 5, 1, 2, 0});
  bytes.resize(6 + 82);
  bytes.insert(bytes.end(), {3, 0});
  return bytes;
}

TEST(AptReader, PutsMessagesTogetherWhereverTheyAreCut) {
  Bytes bytes = hardware_bytes();
  const Bytes homed{0x44, 0x04, 0x01, 0x00, 0x01, 0x22};
  bytes.insert(bytes.end(), homed.begin(), homed.end());
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    AptReader reader;
    std::vector<AptMessage> messages;
    for (const Bytes& part : {Bytes(bytes.begin(), bytes.begin() + cut), Bytes(bytes.begin() + cut, bytes.end())}) {
      reader.append(part);
      while (const auto message = reader.next()) messages.push_back(*message);
    }
    ASSERT_EQ(messages.size(), 2u) << cut;
    EXPECT_EQ(messages[0].source, apt_unit);
    const auto hardware = parse_apt_hardware(messages[0]);
    ASSERT_TRUE(hardware);
    EXPECT_EQ(hardware->serial, 27000001u);
    EXPECT_EQ(hardware->model, "KDC101");
    EXPECT_EQ(hardware->firmware, "2.1.5");
    EXPECT_EQ(hardware->channels, 3);
    EXPECT_EQ(messages[1].id, AptId::homed);
    EXPECT_EQ(messages[1].param1, 1);
    EXPECT_EQ(messages[1].source, 0x22);
    EXPECT_EQ(reader.bytes_dropped(), 0u);
  }
}

TEST(AptReader, DropsWhatCannotBeginAMessage) {
  AptReader reader;
  Bytes bytes{0x00, 0xff, 0x13};  // the end of one that came before
  const Bytes homed{0x44, 0x04, 0x01, 0x00, 0x01, 0x50};
  bytes.insert(bytes.end(), homed.begin(), homed.end());
  reader.append(bytes);
  const auto message = reader.next();
  ASSERT_TRUE(message);
  EXPECT_EQ(message->id, AptId::homed);
  EXPECT_EQ(reader.bytes_dropped(), 3u);
  EXPECT_FALSE(reader.next());
}

TEST(AptReader, TakesAnything) {
  std::mt19937 random(1);
  AptReader reader;
  std::size_t given = 0, taken = 0;
  for (int part = 0; part < 5000; ++part) {
    Bytes bytes(random() % 40);
    for (std::uint8_t& byte : bytes) byte = std::uint8_t(random());
    // Every other part looks like a message up to its data.
    if (part % 2 == 0 && bytes.size() >= 6) bytes[3] = 0, bytes[4] = random() % 2 ? 0x81 : 0x01, bytes[5] = apt_unit;
    given += bytes.size();
    reader.append(bytes);
    while (const auto message = reader.next()) {
      taken += 6 + message->data.size();
      for (const AptId id :
           {message->id, AptId::hw_get_info, AptId::get_velocity, AptId::get_home_params, AptId::move_completed}) {
        AptMessage other = *message;
        other.id = id;
        parse_apt_hardware(other), parse_apt_status(other), parse_apt_velocity(other), parse_apt_home_velocity(other);
      }
    }
  }
  EXPECT_GT(taken, 1000u);
  EXPECT_LE(taken + reader.bytes_dropped(), given);
  EXPECT_GE(taken + reader.bytes_dropped() + 6 + 255, given) << "only an unfinished message is kept";
}

AptMessage read(const Bytes& bytes) {
  AptReader reader;
  reader.append(bytes);
  return reader.next().value();
}

TEST(AptMessages, StatusOfServosAndSteppers) {
  // Position 0x00012345; velocity and a reserve, or the encoder's count; homed, settled, enabled.
  const Bytes servo{0x91, 0x04, 0x0e, 0x00, 0x81, 0x50, 0x01, 0x00, 0x45, 0x23,
                    0x01, 0x00, 0x34, 0x12, 0x00, 0x00, 0x00, 0x24, 0x00, 0x80};
  Bytes stepper = servo, completed = servo;
  stepper[0] = 0x81, stepper[5] = 0x21, completed[0] = 0x64;
  for (const Bytes& bytes : {servo, stepper, completed}) {
    const auto status = parse_apt_status(read(bytes));
    ASSERT_TRUE(status);
    EXPECT_EQ(status->position, 0x12345);
    EXPECT_TRUE(status->homed() && status->enabled());
    EXPECT_FALSE(status->moving() || status->at_limit() || status->motion_error() || status->over_current());
  }
}

TEST(AptMessages, EachBitOfAStatus) {
  const auto with = [](std::uint32_t bits) { return AptStatus{0, bits}; };
  for (const std::uint32_t bit : {0x1, 0x2, 0x4, 0x8}) EXPECT_TRUE(with(bit).at_limit());
  for (const std::uint32_t bit : {0x10, 0x20, 0x40, 0x80, 0x200}) EXPECT_TRUE(with(bit).moving());
  EXPECT_FALSE(with(0x100).moving());
  EXPECT_TRUE(with(0x400).homed());
  EXPECT_TRUE(with(0x4000).motion_error());
  EXPECT_TRUE(with(0x1000000).over_current());
  EXPECT_TRUE(with(0x80000000).enabled());
}

TEST(AptMessages, VelocitiesThatAreTold) {
  const Bytes velocity{0x15, 0x04, 0x0e, 0x00, 0x81, 0x50, 0x01, 0x00, 0x01, 0x00,
                       0x00, 0x00, 0xb0, 0x35, 0x00, 0x00, 0xcd, 0xcc, 0xcc, 0x00};
  const auto told = parse_apt_velocity(read(velocity));
  ASSERT_TRUE(told);
  EXPECT_EQ(told->least, 1);
  EXPECT_EQ(told->acceleration, 13744);
  EXPECT_EQ(told->most, 0xcccccd);
  // Channel, direction, switch, velocity, offset.
  const Bytes home{0x42, 0x04, 0x0e, 0x00, 0x81, 0x50, 0x01, 0x00, 0x02, 0x00,
                   0x01, 0x00, 0x40, 0x0d, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00};
  EXPECT_EQ(parse_apt_home_velocity(read(home)), 200000);
  EXPECT_FALSE(parse_apt_velocity(read(home)));
}

// The document's tables of scales: MTS25-Z8 on a KDC101, DDS220 on a BBD, LTS150 on a stepper controller.
TEST(AptMessages, ScalesOfTheFamilies) {
  const AptScale kdc = apt_scale("kdc101").value(), bbd = apt_scale("bbd30x").value(),
                 bsc = apt_scale("bsc20x").value();
  EXPECT_NEAR(34304 * kdc.velocity, 767367.49, 0.01);
  EXPECT_NEAR(34304 * kdc.acceleration, 261.93, 0.01);
  EXPECT_NEAR(20000 * bbd.velocity, 134217.73, 0.01);
  EXPECT_NEAR(20000 * bbd.acceleration, 13.744, 0.001);
  EXPECT_NEAR(409600 * bsc.velocity, 21987328, 1);
  EXPECT_NEAR(409600 * bsc.acceleration, 4506.1, 0.1);
  EXPECT_FALSE(apt_scale("pzt"));
}

}  // namespace
}  // namespace lumifield
