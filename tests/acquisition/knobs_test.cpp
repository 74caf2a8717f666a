#include "acquisition/virtual/knobs.h"

#include <atomic>
#include <cstring>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace lumifield::virtual_bench {
namespace {

class Client {
 public:
  explicit Client(const std::filesystem::path& path) : socket_(socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::strcpy(name.sun_path, path.c_str());
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void send(const std::string& text) { EXPECT_EQ(write(socket_, text.data(), text.size()), ssize_t(text.size())); }
  // One line, or "" when the other end has closed.
  std::string reply() {
    std::string line;
    for (char c = 0; read(socket_, &c, 1) == 1 && c != '\n';) line += c;
    return line;
  }
  std::string ask(const std::string& line) {
    send(line + "\n");
    return reply();
  }

 private:
  int socket_;
};

class KnobsTest : public testing::Test {
 protected:
  void SetUp() override {
    auto knobs = Knobs::start(path_, {{"gain",
                                       {"a number",
                                        [this](double value) -> Status {
                                          if (value < 0) return fail("must not be negative", "gain");
                                          gain_ = value;
                                          return {};
                                        },
                                        [this] { return std::to_string(int(gain_)); }}},
                                      {"frames", {{}, {}, [] { return std::string("7"); }}}});
    ASSERT_TRUE(knobs) << knobs.error().message();
    knobs_ = std::move(*knobs);
  }
  const std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("lumifield-knobs-" + std::to_string(getpid()));
  std::atomic<double> gain_ = 0;
  std::unique_ptr<Knobs> knobs_;
};

TEST_F(KnobsTest, SetsAndReads) {
  Client client(path_), other(path_);
  EXPECT_EQ(client.ask("gain 12"), "ok");
  EXPECT_EQ(gain_, 12);
  EXPECT_EQ(other.ask("get gain"), "12");
  EXPECT_EQ(client.ask("get frames"), "7");
}

TEST_F(KnobsTest, TakesLinesInPieces) {
  Client client(path_);
  client.send("gain ");
  usleep(50000);
  client.send("3\ngain 4\nget gain\n");
  EXPECT_EQ(client.reply(), "ok");
  EXPECT_EQ(client.reply(), "ok");
  EXPECT_EQ(client.reply(), "4");
}

TEST_F(KnobsTest, SaysWhatIsWrong) {
  Client client(path_);
  EXPECT_EQ(client.ask("gain -1"), "error: gain: must not be negative");
  EXPECT_EQ(client.ask("gain many"), "error: not a number: many");
  EXPECT_EQ(client.ask("gain inf"), "error: not a number: inf");
  EXPECT_EQ(client.ask("pain 1"), "error: no such knob: pain");
  EXPECT_EQ(client.ask("frames 1"), "error: frames can only be read");
  EXPECT_TRUE(client.ask("gain").starts_with("error: "));
  EXPECT_EQ(gain_, 0);
}

TEST_F(KnobsTest, EndsAClientWhoseLineHasNoEnd) {
  Client client(path_);
  client.send(std::string(1000, 'x'));
  EXPECT_EQ(client.reply(), "");
  Client next(path_);
  EXPECT_EQ(next.ask("gain 1"), "ok");
}

TEST_F(KnobsTest, LeavesNoSocketAndReplacesNothing) {
  EXPECT_FALSE(Knobs::start(path_, {}));
  EXPECT_TRUE(std::filesystem::exists(path_));
  knobs_.reset();
  EXPECT_FALSE(std::filesystem::exists(path_));
  EXPECT_FALSE(Knobs::start("/nonexistent/knobs", {}));
  EXPECT_FALSE(Knobs::start("/tmp/" + std::string(200, 'k'), {}));
}

}  // namespace
}  // namespace lumifield::virtual_bench
