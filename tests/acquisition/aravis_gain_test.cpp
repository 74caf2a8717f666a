#include "acquisition/cameras/aravis_gain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/described_camera.h"

namespace lumifield {
namespace {

using testing::HasSubstr;

/// The gains of a camera, one for each value of its GainSelector, or one under all of them.
struct Gains {
  std::vector<std::string> selector;
  std::size_t selected = 0;
  std::string unit = "dB";
  double low = 0, high = 10;
  bool are_one = false;
};

class GainCamera {
 public:
  explicit GainCamera(const Gains& gains) : camera_(described(gains)) {
    for (const std::string& part : gains.selector) set(part, gains.low + 2);
    if (!gains.selector.empty()) camera_.set("GainSelector", gains.selector[gains.selected]);
  }

  Result<double> apply(double gain) {
    CameraSettings settings;
    settings.address = "Fake_1";
    settings.gain = gain;
    return set_aravis_gain(camera_.camera(), settings);
  }
  std::string refusal(double gain) {
    const Result<double> applied = apply(gain);
    return applied ? "" : applied.error().message();
  }
  std::string selected() const { return camera_.text("GainSelector"); }
  double now() const { return camera_.number("Gain"); }
  double gain(const std::string& part) {
    camera_.set("GainSelector", part);
    return now();
  }

 private:
  void set(const std::string& part, double value) {
    camera_.set("GainSelector", part);
    camera_.set("Gain", value);
  }

  static std::string described(const Gains& gains) {
    std::string added;
    if (!gains.selector.empty()) {
      added += "<Enumeration Name=\"GainSelector\">";
      for (std::size_t i = 0; i < gains.selector.size(); ++i)
        added += "<EnumEntry Name=\"" + gains.selector[i] + "\"><Value>" + std::to_string(i) + "</Value></EnumEntry>";
      added += "<pValue>Selected</pValue></Enumeration><Integer Name=\"Selected\"><Value>0</Value></Integer>";
    }
    added += "<Float Name=\"Gain\"><pValue>GainOf</pValue><Min>" + std::to_string(gains.low) + "</Min><Max>" +
             std::to_string(gains.high) + "</Max>" + (gains.unit.empty() ? "" : "<Unit>" + gains.unit + "</Unit>") +
             "</Float><FloatReg Name=\"GainOf\"><Address>0x8000</Address>";
    if (!gains.selector.empty() && !gains.are_one) added += "<pIndex Offset=\"8\">Selected</pIndex>";
    return added +
           "<Length>8</Length><AccessMode>RW</AccessMode><pPort>Device</pPort><Endianess>BigEndian</Endianess></"
           "FloatReg>";
  }

  DescribedCamera camera_;
};

TEST(AravisGain, IsThatOfTheWholePictureAndAllOthersAddNothing) {
  const struct {
    Gains gains;
    std::string measured_with;
  } cases[] = {{{{"All", "AnalogAll", "DigitalAll"}, 2}, "All"},
               {{{"DigitalAll", "AnalogAll", "Tap1"}, 0}, "AnalogAll"},
               {{{"Red", "DigitalAll", "Blue"}, 0}, "DigitalAll"},
               {{{"Tap1"}, 0}, "Tap1"}};
  for (const auto& each : cases) {
    GainCamera camera(each.gains);
    const Result<double> applied = camera.apply(3);
    ASSERT_TRUE(applied) << applied.error().message();
    EXPECT_EQ(*applied, 3);
    EXPECT_EQ(camera.selected(), each.measured_with);
    for (const std::string& part : each.gains.selector)
      EXPECT_EQ(camera.gain(part), part == each.measured_with ? 3 : 0) << part;
  }
}

TEST(AravisGain, UnderAliasesIsSetLast) {
  for (const std::vector<std::string>& names : {std::vector<std::string>{"All", "AnalogAll"}, {"Tap1", "All"}}) {
    GainCamera camera({.selector = names, .are_one = true});
    ASSERT_EQ(camera.apply(3).value_or(-1), 3);
    EXPECT_EQ(camera.now(), 3);
  }
}

TEST(AravisGain, OfPartsOnlyCanBeNone) {
  const Gains taps{{"Tap1", "Tap2", "Tap3"}, 1};
  GainCamera camera(taps);
  EXPECT_THAT(camera.refusal(3), AllOf(HasSubstr("has no gain of the whole picture, only of Tap1, Tap2, Tap3"),
                                       HasSubstr("set \"gain\": 0 in the bench file")));
  ASSERT_EQ(camera.apply(0).value_or(-1), 0);
  for (const std::string& tap : taps.selector) EXPECT_EQ(camera.gain(tap), 0);
}

TEST(AravisGain, OfFactorsOrStepsIsNoDecibels) {
  GainCamera factors({{"AnalogAll", "DigitalRed"}, 0, "", 1, 24});
  EXPECT_THAT(factors.refusal(0), HasSubstr("choose one from 1 to 24 (it counts in a unit of its own, not dB)"));
  ASSERT_EQ(factors.apply(4).value_or(-1), 0) << "gain_dn_per_e is that at this number";
  EXPECT_EQ(factors.gain("AnalogAll"), 4);
  EXPECT_EQ(factors.gain("DigitalRed"), 1);

  GainCamera steps({{"All", "Tap1"}, 0, "steps", 300, 700});
  ASSERT_EQ(steps.apply(400).value_or(-1), 0);
  EXPECT_EQ(steps.gain("All"), 400);
  EXPECT_EQ(steps.gain("Tap1"), 300);

  GainCamera from_zero({{"All", "DigitalAll"}, 0, "", 0, 63});
  ASSERT_EQ(from_zero.apply(20).value_or(-1), 0);
  EXPECT_EQ(from_zero.gain("DigitalAll"), 0) << "a step of 1 would amplify";
}

TEST(AravisGain, OutOfItsRangeIsRefused) {
  GainCamera camera({});
  EXPECT_THAT(camera.refusal(11), HasSubstr("a gain of 11 dB is out of its range; choose one from 0 to 10 dB"));
  EXPECT_THAT(camera.refusal(-1), HasSubstr("a gain of -1 dB is out of its range"));
  ASSERT_EQ(camera.apply(10).value_or(-1), 10);
}

}  // namespace
}  // namespace lumifield
