#pragma once

#include <arv.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

namespace lumifield {

/// Aravis' camera without a network, with more features than it has: `added` joins its GenICam description. Registers
/// from 0x8000 on are free.
class DescribedCamera {
 public:
  explicit DescribedCamera(const std::string& added)
      : description_(std::filesystem::path(testing::TempDir()) / ("described_" + std::to_string(getpid()) + ".xml")) {
    ArvFakeCamera* const plain = arv_fake_camera_new("D0");
    std::size_t size = 0;
    const char* const text = arv_fake_camera_get_genicam_xml(plain, &size);
    std::string xml(text, size);
    g_object_unref(plain);
    std::ofstream(description_) << xml.insert(xml.rfind("</RegisterDescription>"), added);
    arv_set_fake_camera_genicam_filename(description_.c_str());
    device_ = arv_fake_device_new("D1", nullptr);
    arv_set_fake_camera_genicam_filename(nullptr);
    camera_ = arv_camera_new_with_device(device_, nullptr);
  }
  ~DescribedCamera() {
    g_clear_object(&camera_);
    g_clear_object(&device_);
    std::filesystem::remove(description_);
  }
  DescribedCamera(const DescribedCamera&) = delete;
  DescribedCamera& operator=(const DescribedCamera&) = delete;

  ArvCamera* camera() { return camera_; }
  void set(const char* feature, const std::string& value) {
    arv_device_set_string_feature_value(device_, feature, value.c_str(), nullptr);
  }
  void set(const char* feature, double value) { arv_device_set_float_feature_value(device_, feature, value, nullptr); }
  std::string text(const char* feature) const {
    const char* const value = arv_device_get_string_feature_value(device_, feature, nullptr);
    return value == nullptr ? "" : value;
  }
  double number(const char* feature) const { return arv_device_get_float_feature_value(device_, feature, nullptr); }

 private:
  std::filesystem::path description_;
  ArvDevice* device_ = nullptr;
  ArvCamera* camera_ = nullptr;
};

/// `name` with these values, as the register at `address` says.
inline std::string described_choice(const std::string& name, std::initializer_list<std::string> values,
                                    const std::string& address) {
  std::string text = "<Enumeration Name=\"" + name + "\">";
  int number = 0;
  for (const std::string& value : values)
    text += "<EnumEntry Name=\"" + value + "\"><Value>" + std::to_string(number++) + "</Value></EnumEntry>";
  return text + "<pValue>" + name + "At</pValue></Enumeration><IntReg Name=\"" + name + "At\"><Address>" + address +
         "</Address><Length>4</Length><AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>"
         "<Endianess>BigEndian</Endianess></IntReg>";
}

}  // namespace lumifield
