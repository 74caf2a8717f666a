#include <arv.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "acquisition/cameras/aravis_settings.h"

namespace lumifield {
namespace {

/// Aravis' camera without a network, whose one gain of 0 to 10 dB stands under every value of a GainSelector: aliases.
class AliasCamera {
 public:
  AliasCamera(const std::vector<std::string>& gains, std::size_t selected)
      : description_(std::filesystem::path(testing::TempDir()) / ("aliases_" + std::to_string(getpid()) + ".xml")) {
    std::ofstream(description_) << description(gains, selected);
    arv_set_fake_camera_genicam_filename(description_.c_str());
    device_ = arv_fake_device_new("D1", nullptr);
    arv_set_fake_camera_genicam_filename(nullptr);
    camera_ = arv_camera_new_with_device(device_, nullptr);
  }
  ~AliasCamera() {
    g_clear_object(&camera_);
    g_clear_object(&device_);
    std::filesystem::remove(description_);
  }
  AliasCamera(const AliasCamera&) = delete;
  AliasCamera& operator=(const AliasCamera&) = delete;

  ArvCamera* camera() { return camera_; }

 private:
  static std::string description(const std::vector<std::string>& gains, std::size_t selected) {
    ArvFakeCamera* const plain = arv_fake_camera_new("D0");
    std::size_t size = 0;
    const char* const text = arv_fake_camera_get_genicam_xml(plain, &size);
    std::string xml(text, size);
    g_object_unref(plain);
    std::string selector = "<Enumeration Name=\"GainSelector\">";
    for (std::size_t i = 0; i < gains.size(); ++i)
      selector += "<EnumEntry Name=\"" + gains[i] + "\"><Value>" + std::to_string(i) + "</Value></EnumEntry>";
    selector += "<pValue>GainSelected</pValue></Enumeration><Integer Name=\"GainSelected\"><Value>" +
                std::to_string(selected) + "</Value></Integer>";
    return xml.insert(xml.rfind("</RegisterDescription>"), selector);
  }

  std::filesystem::path description_;
  ArvDevice* device_ = nullptr;
  ArvCamera* camera_ = nullptr;
};

TEST(AravisSelectors, TheGainOfAllIsSetLastElseOfAnalogAllElseOfTheSelected) {
  const struct {
    std::vector<std::string> gains;
    std::size_t selected;
    const char* measured_with;
  } cases[] = {{{"All", "AnalogAll", "DigitalAll"}, 2, "All"},
               {{"DigitalAll", "AnalogAll", "Tap1"}, 0, "AnalogAll"},
               {{"Tap1", "Tap2", "Tap3"}, 1, "Tap2"},
               {{"All"}, 0, "All"}};
  CameraSettings settings;
  settings.address = "Fake_1";
  settings.pixel_format = "Mono8";
  settings.gain = 3;
  for (const auto& each : cases) {
    AliasCamera aliases(each.gains, each.selected);
    ASSERT_NE(aliases.camera(), nullptr);
    const Result<AppliedSettings> applied = apply_settings(aliases.camera(), settings);
    ASSERT_TRUE(applied) << applied.error().message();
    EXPECT_EQ(applied->gain_db, 3);
    EXPECT_EQ(arv_camera_get_gain(aliases.camera(), nullptr), 3);
    EXPECT_STREQ(arv_camera_get_string(aliases.camera(), "GainSelector", nullptr), each.measured_with);
  }
}

}  // namespace
}  // namespace lumifield
