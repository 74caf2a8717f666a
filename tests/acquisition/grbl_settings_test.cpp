#include <algorithm>
#include <fstream>

#include "tests/support/grbl_host.h"

namespace lumifield::virtual_bench {
namespace {

TEST_F(GrblControllerTest, AnswersBadLinesAsGrblDoes) {
  home();
  const std::pair<const char*, const char*> cases[] = {{"X", "error:2"},
                                                       {"5", "error:1"},
                                                       {"G0 X1 X2", "error:25"},
                                                       {"G0 G1 X1", "error:21"},
                                                       {"G1 X1", "error:22"},
                                                       {"G2 X1 F10", "error:20"},
                                                       {"G0 Z1", "error:20"},
                                                       {"M3", "error:20"},
                                                       {"G1 X1 F-1", "error:4"},
                                                       {"G80 X1", "error:31"},
                                                       {"G92 X1", "error:20"},
                                                       {"G10 L2 P1 X1", "error:20"},
                                                       {"G20", "error:20"},
                                                       {"G4", "error:28"},
                                                       {"G80 G53 X1", "error:30"},
                                                       {"G0 X1 P2", "error:36"},
                                                       {"$999=1", "error:3"},
                                                       {"$110=x", "error:2"},
                                                       {"$110=0", "error:4"},
                                                       {"$Q", "error:3"},
                                                       {"G0 X1e9999", "error:20"},
                                                       {"G0 X123456789012", "error:2"},
                                                       {"$110=1000000000000", "error:2"},
                                                       {"G0 Xnan", "error:2"},
                                                       {"G999999", "error:20"}};
  for (const auto& [line, answer] : cases) EXPECT_EQ(host_->answer(line), answer) << line;
  EXPECT_EQ(host_->answer(std::string(100, 'G')), "error:11");
  EXPECT_EQ(host_->answer("(a comment) ; and more"), "ok");
  EXPECT_EQ(host_->report().mpos, Vec2(0, 0));
}

TEST_F(GrblControllerTest, KnowsItsSettings) {
  const auto list = host_->command("$$");
  EXPECT_EQ(list.size(), 34u);
  EXPECT_NE(std::ranges::find(list, "$110=12000.000"), list.end());
  EXPECT_NE(std::ranges::find(list, "$120=2000.000"), list.end());
  EXPECT_NE(std::ranges::find(list, "$130=166.000"), list.end());
  EXPECT_EQ(host_->answer("$110=3000"), "ok");
  const auto changed = host_->command("$$");
  EXPECT_NE(std::ranges::find(changed, "$110=3000.000"), changed.end());
  EXPECT_TRUE(host_->command("$I")[0].starts_with("[VER:1.1h"));
  ASSERT_EQ(host_->answer("$10=0"), "ok");
  EXPECT_NE(host_->report().text.find("|WPos:0.000,0.000"), std::string::npos);
  ASSERT_EQ(host_->answer("$20=0"), "ok");
  ASSERT_EQ(host_->answer("$22=0"), "ok");
  EXPECT_EQ(host_->answer("$H"), "error:5");
  EXPECT_EQ(host_->answer("$20=1"), "error:10");
}

TEST_F(GrblControllerTest, AnotherHostMayComeAfterTheFirst) {
  home();
  host_.reset();
  host_ = std::make_unique<Host>(options_.path);
  EXPECT_EQ(host_->report().state, "Idle");
}

TEST_F(GrblControllerTest, DoesNotReplaceWhatIsThere) {
  GrblOptions taken;
  taken.path = folder_ / "taken";
  std::ofstream(taken.path) << "mine";
  const auto second = GrblController::start(taken);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().where, taken.path.string());
  EXPECT_TRUE(std::filesystem::exists(taken.path));
}

}  // namespace
}  // namespace lumifield::virtual_bench
