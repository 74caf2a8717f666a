#include "renderer/picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <png.h>
#include <random>
#include <sys/resource.h>

namespace lumifield {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

Picture grey(const std::vector<float>& values) {
  Picture picture{static_cast<int>(values.size()), 1, {}, {}, {}};
  for (const float v : values) {
    picture.rgb.insert(picture.rgb.end(), 3, v);
    picture.coverage.push_back(1);
  }
  return picture;
}

Picture noise(int width, int height) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-1, 100);
  Picture picture{width,
                  height,
                  std::vector<float>(static_cast<std::size_t>(3 * width * height)),
                  std::vector<float>(static_cast<std::size_t>(width * height), 1),
                  {}};
  for (float& v : picture.rgb) v = uniform(random);
  return picture;
}

TEST(ToneMap, ExactAtKnownValues) {
  // L = −ln(1 − v)·white with v the linear value of an sRGB code.
  const auto code = [](double v) { return static_cast<float>(-std::log1p(-v) * 2.5); };
  const Picture8 mapped =
      tone_map(grey({-3, 0, code(0.0003035270), code(0.2158605001), code(0.5), 1e9F}), {.exposure = 1, .white = 2.5});
  // 0.003 is code 1 in the linear part; 0.2158605 is code 128; ½ is 187.516; the shoulder ends at 255.
  const std::vector<int> expected = {0, 0, 1, 128, 188, 255};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(mapped.srgb[3 * i], expected[i]) << i;
}

TEST(ToneMap, IsTheCurveRounded) {
  const Picture picture = noise(200, 100);
  const Picture8 mapped = tone_map(picture, {.exposure = 1.25, .white = 30});
  for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
    const double v = std::max(0.0, 1 - std::exp(-1.25 * picture.rgb[i] / 30));
    const double code = 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
    // The standard's two pieces meet to 1e-5 only.
    ASSERT_LE(std::abs(mapped.srgb[i] - code), 0.5 + 1e-4) << picture.rgb[i];
  }
}

TEST(ToneMap, RisesWithTheValueAndWithTheExposure) {
  std::vector<float> values;
  for (int i = 0; i < 2000; ++i) values.push_back(static_cast<float>(i) * 0.01F);
  const Picture picture = grey(values);
  const Picture8 once = tone_map(picture, {.exposure = 1, .white = 4});
  const Picture8 twice = tone_map(picture, {.exposure = 2, .white = 4});
  for (std::size_t i = 3; i < once.srgb.size(); ++i) {
    ASSERT_GE(once.srgb[i], once.srgb[i - 3]);
    ASSERT_GE(twice.srgb[i], once.srgb[i]);
  }
  // Exposure 2 of L is exposure 1 of 2 L.
  for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(twice.srgb[3 * i], once.srgb[6 * i]);
}

TEST(ToneMap, TheAverageIsThatOfLitPixels) {
  Picture picture = grey({0, 2, 4, 0, -7});
  EXPECT_NEAR(average_luminance(picture), 3, 1e-6);
  picture.rgb = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0};
  EXPECT_NEAR(average_luminance(picture), 1.0 / 3, 1e-6);

  // A whole picture scaled looks the same, and white = average is the default.
  const Picture random = noise(31, 17);
  Picture scaled = random;
  for (float& v : scaled.rgb) v *= 1024;
  EXPECT_EQ(tone_map(random, {}).srgb, tone_map(scaled, {}).srgb);
  EXPECT_EQ(tone_map(random, {}).srgb, tone_map(random, {.exposure = 1, .white = average_luminance(random)}).srgb);
}

TEST(ToneMap, IsTheSearchAmongTheCodesThresholds) {
  // Thresholds as the curve gives them backwards, and floats at, beside and between them, of every size and kind.
  const ToneCurve curve{.exposure = 0.3, .white = 0.071};
  std::array<double, 255> thresholds{};
  for (std::size_t k = 0; k < thresholds.size(); ++k) {
    const double encoded = (static_cast<double>(k) + 0.5) / 255;
    const double v = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    thresholds[k] = -std::log1p(-v) * curve.white / curve.exposure;
  }
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> values{0.0F, -0.0F, infinity, -infinity, std::nanf(""), -std::nanf(""), 1e-45F, 3e38F};
  for (const double threshold : thresholds) {
    const float at = static_cast<float>(threshold);
    values.insert(values.end(), {std::nextafter(at, -infinity), at, std::nextafter(at, infinity)});
  }
  std::mt19937 random(3);
  for (int k = 0; k < 200000; ++k) values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
  std::uniform_real_distribution<float> uniform(0, 2);
  for (int k = 0; k < 200000; ++k) values.push_back(uniform(random));
  const Picture8 mapped = tone_map(grey(values), curve);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto code = values[i] > 0 ? std::ranges::upper_bound(thresholds, values[i]) - thresholds.begin() : 0;
    ASSERT_EQ(mapped.srgb[3 * i], code) << values[i];
  }
}

TEST(ToneMap, TheAverageOfALargePictureIsExact) {
  Picture picture = grey(std::vector<float>(300001, 0));
  double sum = 0;
  for (std::size_t i = 0; i < picture.coverage.size(); i += 3) {
    std::fill_n(&picture.rgb[3 * i], 3, static_cast<float>(i % 1000 + 1));
    sum += static_cast<double>(i % 1000 + 1);
  }
  EXPECT_NEAR(average_luminance(picture), sum / 100001, 1e-9 * sum / 100001);
}

TEST(ToneMap, NothingLitIsBlack) {
  EXPECT_EQ(average_luminance(grey({0, -1})), 0);
  EXPECT_EQ(tone_map(grey({0, -1}), {}).srgb, std::vector<std::uint8_t>(6, 0));
}

class PictureFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = (fs::temp_directory_path() / "picture_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }
  fs::path folder_;
};

TEST_F(PictureFile, PngKeepsEveryByte) {
  const Picture8 written = tone_map(noise(37, 23), {.exposure = 1, .white = 50});
  const auto status = write_png(written, folder_ / "a.png");
  ASSERT_TRUE(status) << status.error().message();
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&image, (folder_ / "a.png").c_str()));
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr));
  EXPECT_EQ(image.width, 37U);
  EXPECT_EQ(image.height, 23U);
  EXPECT_EQ(read, written.srgb);
  EXPECT_EQ(files(), 1);
}

TEST_F(PictureFile, ExrKeepsEveryFloat) {
  Picture written = noise(37, 23);
  written.note = "unshadowed";
  ASSERT_TRUE(write_exr(written, folder_ / "a.exr"));
  ASSERT_TRUE(write_exr(written, folder_ / "a.exr")) << "a second time replaces the first";
  EXPECT_EQ(files(), 1);
  Imf::InputFile file((folder_ / "a.exr").c_str());
  EXPECT_EQ(Imf::comments(file.header()), "unshadowed");
  const auto window = file.header().dataWindow();
  ASSERT_EQ(window.max.x - window.min.x + 1, 37);
  ASSERT_EQ(window.max.y - window.min.y + 1, 23);
  std::vector<float> read(written.rgb.size());
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < 3; ++c) {
    const char name[] = {"RGB"[c], 0};
    ASSERT_EQ(file.header().channels()[name].type, Imf::FLOAT);
    pixels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(read.data() + c), 12, 12 * 37));
  }
  file.setFrameBuffer(pixels);
  file.readPixels(0, 22);
  EXPECT_EQ(read, written.rgb);
}

TEST_F(PictureFile, WhatCannotBeWrittenLeavesNothing) {
  const Picture picture = noise(64, 64);
  const Picture8 mapped = tone_map(picture, {});
  EXPECT_THAT(write_png(mapped, folder_ / "absent" / "a.png").error().message(),
              HasSubstr("could not be made: No such file"));
  EXPECT_THAT(write_exr(picture, folder_ / "absent" / "a.exr").error().message(),
              HasSubstr("could not be made: No such file"));
  fs::create_directory(folder_ / "folder.png");
  EXPECT_THAT(write_png(mapped, folder_ / "folder.png").error().message(), HasSubstr("is no regular file"));
  EXPECT_THAT(write_exr(picture, "/dev/full").error().message(), HasSubstr("is no regular file"));
  EXPECT_FALSE(write_png({}, folder_ / "a.png"));
  EXPECT_FALSE(write_exr({}, folder_ / "a.exr"));
  EXPECT_EQ(files(), 1);
}

TEST_F(PictureFile, ADiskThatFillsLeavesTheOldFile) {
  const Picture picture = noise(64, 64);
  std::ofstream(folder_ / "a.exr") << "old";
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status exr = write_exr(picture, folder_ / "a.exr");
  const Status png = write_png(tone_map(picture, {}), folder_ / "a.png");
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(exr);
  ASSERT_FALSE(png);
  EXPECT_THAT(exr.error().message(), HasSubstr("a.exr: could not be written: File too large"));
  EXPECT_EQ(files(), 1);
  std::string text;
  std::ifstream(folder_ / "a.exr") >> text;
  EXPECT_EQ(text, "old");
}

}  // namespace
}  // namespace lumifield
