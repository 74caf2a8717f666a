#include "acquisition/links/serial_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "tests/support/pty.h"

namespace lumifield {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
constexpr milliseconds soon(2000);

std::unique_ptr<SerialLink> open(const Pty& pty) {
  auto link = SerialLink::open(pty.path(), 115200);
  EXPECT_TRUE(link) << link.error().message();
  return std::move(link).value();
}

TEST(SerialLink, CarriesBytesBothWaysUnchanged) {
  Pty pty;
  const auto link = open(pty);
  std::string all;
  for (int value = 1; value < 256; ++value) all += char(value);
  ASSERT_TRUE(link->write(all));
  std::string received;
  while (received.size() < all.size()) {
    const std::string part = pty.receive(1000);
    ASSERT_FALSE(part.empty());
    received += part;
  }
  EXPECT_EQ(received, all);

  std::string line = all;
  std::erase(line, '\n');
  pty.send(line + "\n");
  EXPECT_EQ(link->read_line(soon), line);
}

TEST(SerialLink, SplitsLinesHoweverTheyArrive) {
  Pty pty;
  const auto link = open(pty);
  pty.send("one\r\ntwo\nthr");
  EXPECT_EQ(link->read_line(soon), "one");
  EXPECT_EQ(link->read_line(soon), "two");
  EXPECT_EQ(link->read_line(milliseconds(5)).error(), LinkFault::timeout);
  pty.send("ee\r\n\n");
  EXPECT_EQ(link->read_line(soon), "three");
  EXPECT_EQ(link->read_line(soon), "");
}

TEST(SerialLink, DiscardsWhatCameBefore) {
  Pty pty;
  const auto link = open(pty);
  pty.send("old\nhal");
  EXPECT_EQ(link->read_line(soon), "old");
  link->discard_input();
  pty.send("new\n");
  EXPECT_EQ(link->read_line(soon), "new");
}

TEST(SerialLink, BytesWithoutLineEndAreAFault) {
  Pty pty;
  const auto link = open(pty);
  pty.send(std::string(3000, 'U'));
  EXPECT_EQ(link->read_line(soon).error(), LinkFault::overlong);
}

TEST(SerialLink, HangUpComesAfterTheLastLine) {
  Pty pty;
  const auto link = open(pty);
  std::jthread unplugging([&] {
    std::this_thread::sleep_for(milliseconds(30));
    pty.unplug();
  });
  EXPECT_EQ(link->read_line(soon).error(), LinkFault::hang_up);
  EXPECT_EQ(link->read_line(soon).error(), LinkFault::hang_up);
  EXPECT_EQ(link->write("?").error(), LinkFault::hang_up);
}

TEST(SerialLink, WriteTimesOutWhenTheFarSideTakesNothing) {
  Pty pty;
  const auto link = open(pty);
  const std::string much(1 << 20, 'x');
  EXPECT_EQ(link->write(much, milliseconds(20)).error(), LinkFault::timeout);
}

TEST(SerialLink, HasOneOwnerAtATime) {
  Pty pty;
  {
    const auto link = open(pty);
    const auto second = SerialLink::open(pty.path(), 115200);
    ASSERT_FALSE(second);
    EXPECT_THAT(second.error().message(), HasSubstr("in use by another program"));
    EXPECT_EQ(second.error().where, pty.path());
  }
  EXPECT_TRUE(SerialLink::open(pty.path(), 115200)) << "free again once closed";
}

TEST(SerialLink, RefusesWhatIsNoSerialLine) {
  const auto what = [](const std::string& path, int baud) {
    const auto link = SerialLink::open(path, baud);
    return link ? std::string("opened") : link.error().what;
  };
  EXPECT_EQ(what("/dev/no-such-port", 115200), "there is no such device");
  EXPECT_EQ(what("/dev/null", 115200), "not a serial line");
  EXPECT_EQ(what("/dev", 115200), "not a serial line");
  EXPECT_EQ(what("", 115200), "there is no such device");
  Pty pty;
  EXPECT_THAT(what(pty.path(), 12345), HasSubstr("12345 baud"));
}

}  // namespace
}  // namespace lumifield
