#include "acquisition/stages/grbl_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lumifield {
namespace {

TEST(GrblReport, ReadsStatus) {
  const auto idle = parse_grbl_status("<Idle|MPos:1.250,-2.500,0.000|FS:0,0|WCO:3.000,4.000,0.000>");
  ASSERT_TRUE(idle);
  EXPECT_EQ(idle->state, GrblState::idle);
  EXPECT_EQ(idle->position, Vec2(1.25, -2.5));
  EXPECT_TRUE(idle->machine_position);
  EXPECT_EQ(idle->work_offset, Vec2(3, 4));
  EXPECT_FALSE(idle->x_closed || idle->y_closed);

  const auto hold = parse_grbl_status("<Hold:1|WPos:1,2|Pn:XY|Ov:100,100,100>");
  ASSERT_TRUE(hold);
  EXPECT_EQ(hold->state, GrblState::hold);
  EXPECT_EQ(hold->sub_state, 1);
  EXPECT_FALSE(hold->machine_position);
  EXPECT_FALSE(hold->work_offset);
  EXPECT_TRUE(hold->x_closed && hold->y_closed);
  const auto other_pins = parse_grbl_status("<Idle|MPos:0,0,0|Pn:PYZD>");
  ASSERT_TRUE(other_pins);
  EXPECT_FALSE(other_pins->x_closed);
  EXPECT_TRUE(other_pins->y_closed);
}

TEST(GrblReport, RefusesBrokenStatus) {
  for (const char* line : {"", "<", "<>", "<Idle>", "<Idle|FS:0,0>", "<Idle|MPos:>", "<Idle|MPos:1>", "<Idle|MPos:1,>",
                           "<Idle|MPos:nan,0,0>", "<Idle|MPos:1e999,0,0>", "<Idle|MPos:1,2x,0>", "<Idel|MPos:1,2,0>",
                           "Idle|MPos:1,2,0", "<Idle|MPos:1,2,0", "<Idle|MPos:1,2,0|WCO:a,b>"})
    EXPECT_FALSE(parse_grbl_status(line)) << line;
}

TEST(GrblReport, ReadsSettingsAndCodes) {
  EXPECT_EQ(parse_grbl_setting("$110=3000.500"), std::pair(110, 3000.5));
  EXPECT_EQ(parse_grbl_setting("$0=10 (step pulse, usec)"), std::pair(0, 10.));
  for (const char* line : {"", "$", "$=", "$1", "$1=", "$x=1", "110=3000", "$1=nan"})
    EXPECT_FALSE(parse_grbl_setting(line)) << line;
  EXPECT_EQ(parse_grbl_code("ALARM:9", "ALARM:"), 9);
  EXPECT_EQ(parse_grbl_code("error:22", "error:"), 22);
  EXPECT_FALSE(parse_grbl_code("ALARM:", "ALARM:"));
  EXPECT_FALSE(parse_grbl_code("ALARM:99999999999", "ALARM:"));
}

TEST(GrblReport, EveryCodeHasARemedy) {
  for (int code = -1; code < 50; ++code) {
    EXPECT_FALSE(grbl_alarm(code, "port").remedy.empty());
    EXPECT_FALSE(grbl_error(code, "port").remedy.empty());
    EXPECT_THAT(grbl_error(code, "port").what, testing::StartsWith("error " + std::to_string(code) + ", "));
  }
}

TEST(GrblReport, ShowsUnreadableBytes) {
  EXPECT_EQ(printable("a\x81\n"), "a\\x81\\x0a");
  EXPECT_LT(printable(std::string(5000, 'x')).size(), 70u);
}

}  // namespace
}  // namespace lumifield
