// What comes from controllers late, or unasked.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "acquisition/stages/apt_unit.h"
#include "tests/support/apt_double.h"

namespace lumifield {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class AptLateAnswers : public AptStageTest {
 protected:
  std::uint8_t address() const { return GetParam() == Kind::pair ? apt_unit : apt_first_bay; }
  AptId answer() const { return GetParam() == Kind::stepper_rack ? AptId::get_status : AptId::get_dc_status; }
  AptMessage question() const {
    AptMessage question{GetParam() == Kind::stepper_rack ? AptId::req_status : AptId::req_dc_status, 1};
    question.destination = address();
    return question;
  }
  AptMessage order_to(std::int32_t counts) const {
    AptMessage order{AptId::move_absolute};
    order.destination = address();
    order.data = apt_position_data(counts);
    return order;
  }
  /// Of the x axis, counts.
  std::int32_t asked(AptUnit& unit) const {
    const Result<AptMessage> told = unit.ask(question(), answer());
    EXPECT_TRUE(told) << message(told);
    const auto status = told ? parse_apt_status(*told) : std::nullopt;
    EXPECT_TRUE(status);
    return status.value_or(AptStatus{.position = -1}).position;
  }
  AptMessage fault(AptId id, std::vector<std::uint8_t> data) const {
    return {id, 0, 0, apt_host, address(), std::move(data)};
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, AptLateAnswers, AptDouble::kinds(), AptDouble::name_of);

TEST_P(AptLateAnswers, PassForNoneToALaterQuestion) {
  AptDouble controllers(options_);
  { ASSERT_NE(controllers.open_homed(), nullptr); }
  const auto unit = AptUnit::open(controllers.settings().apt.serials[0]);
  ASSERT_TRUE(unit) << message(unit);
  controllers.server().delay(AptUnit::answer_time * 3 / 2);
  EXPECT_EQ(asked(**unit), 0) << "asked twice; the second answer is on its way";
  controllers.server().delay(milliseconds(0));

  const auto there = static_cast<std::int32_t>(10 * controllers.server().counts_per_mm());
  ASSERT_TRUE((*unit)->send(order_to(there)));
  while (controllers.server().true_position_mm().x() < 10) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(asked(**unit), there);
}

TEST_P(AptLateAnswers, PassForNoneAfterAQuestionThatWasGivenUp) {
  AptDouble controllers(options_);
  { ASSERT_NE(controllers.open_homed(), nullptr); }
  const auto unit = AptUnit::open(controllers.settings().apt.serials[0]);
  ASSERT_TRUE(unit) << message(unit);
  controllers.server().delay(AptUnit::answer_time * 5 / 2);
  EXPECT_THAT(message((*unit)->ask(question(), answer())), HasSubstr("no answer within 2 s"));
  controllers.server().delay(milliseconds(0));

  const auto there = static_cast<std::int32_t>(10 * controllers.server().counts_per_mm());
  ASSERT_TRUE((*unit)->send(order_to(there)));
  while (controllers.server().true_position_mm().x() < 10) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(asked(**unit), there) << "both answers were still on their way";
}

TEST_P(AptLateAnswers, AQuestionThatWasLostIsAskedAgain) {
  AptDouble controllers(options_);
  const auto stage = controllers.open_homed();
  ASSERT_NE(stage, nullptr);
  {
    controllers.server().silence(true);
    const std::jthread other([&] {
      std::this_thread::sleep_for(AptUnit::answer_time / 2);
      controllers.server().silence(false);
    });
    const Result<Vec2> at = stage->position();
    EXPECT_TRUE(at) << message(at);
  }
  EXPECT_TRUE(stage->move_to({10, 5}));
  const Result<Vec2> at = stage->position();
  ASSERT_TRUE(at) << message(at);
  EXPECT_LT((*at - Vec2(10, 5)).norm(), 2 * a_count(controllers));
}

TEST_P(AptLateAnswers, AFaultToldUnaskedEndsTheMove) {
  std::vector<std::uint8_t> text(68, 0);
  std::ranges::copy(std::string("encoder lost"), text.begin() + 4);
  for (const auto& [told, words] : {std::pair(fault(AptId::hw_rich_response, text), "reports a fault: encoder lost"),
                                    {fault(AptId::hw_response, {}), "reports a fault"}}) {
    AptDouble controllers = slow();
    const auto stage = controllers.open_homed();
    ASSERT_NE(stage, nullptr);
    {
      const auto other = on_the_way(controllers, [&] { controllers.server().say(encode(told)); });
      EXPECT_THAT(message(stage->move_to({60, 40})), HasSubstr(words));
    }
    EXPECT_LT(controllers.server().true_position_mm().x(), 40) << "it was stopped";
    EXPECT_TRUE(stage->move_to({1, 1})) << "usable again";
  }
}

}  // namespace
}  // namespace lumifield
