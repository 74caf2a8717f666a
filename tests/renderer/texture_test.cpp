#include "renderer/scene/texture.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "renderer/scene/mesh.h"
#include "tests/support/exr_file.h"

namespace lumifield {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::FloatNear;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
namespace fs = std::filesystem;

/// sRGB, written apart from the renderer's.
double linear(double code) { return code < 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4); }

class TextureTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = (fs::temp_directory_path() / "texture_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// By libpng's classic writer, samples as they stand (16 bits: big end first).
  fs::path png(const std::string& name, unsigned width, unsigned height, int bits, int colours,
               const std::vector<unsigned char>& samples, double gamma = 0) {
    const fs::path file = folder_ / name;
    std::FILE* out = std::fopen(file.c_str(), "wb");
    png_structp writer = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(writer);
    png_init_io(writer, out);
    png_set_IHDR(writer, info, width, height, bits, colours, 0, 0, 0);
    if (gamma > 0) png_set_gAMA(writer, info, gamma);
    png_write_info(writer, info);
    for (unsigned j = 0; j < height; ++j) png_write_row(writer, samples.data() + samples.size() / height * j);
    png_write_end(writer, nullptr);
    png_destroy_write_struct(&writer, &info);
    std::fclose(out);
    return file;
  }
  fs::path exr(const std::string& name, int width, int height, const std::vector<float>& rgb) {
    const fs::path file = folder_ / name;
    Imf::Header header(width, height);
    Imf::FrameBuffer pixels;
    for (std::size_t c = 0; c < 3; ++c) {
      const char channel[] = {"RGB"[c], 0};
      header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
      char* at = reinterpret_cast<char*>(const_cast<float*>(rgb.data() + c));
      pixels.insert(channel, Imf::Slice(Imf::FLOAT, at, 12, 12 * static_cast<std::size_t>(width)));
    }
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(pixels);
    out.writePixels(height);
    return file;
  }
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  std::string bytes_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string error_of(const fs::path& file, std::size_t most = max_texture_pixels) {
    const auto texture = read_texture(file, most);
    return texture ? "" : texture.error().message();
  }
  /// A textured triangle.
  Result<Mesh> mesh(const std::string& mtl) {
    write("a.mtl", "newmtl a\n" + mtl);
    return read_mesh(write("a.obj",
                           "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 0 -1.5\nusemtl a\n"
                           "f 1/1 2/2 3/3\n"));
  }
  fs::path folder_;
};

TEST_F(TextureTest, PngOfEightBitsIsSrgbToTheCode) {
  std::vector<unsigned char> samples;
  for (int k = 0; k < 256; ++k) samples.insert(samples.end(), {static_cast<unsigned char>(k), 0, 255});
  const auto rgb = read_texture(png("rgb.png", 128, 2, 8, PNG_COLOR_TYPE_RGB, samples));
  ASSERT_TRUE(rgb) << rgb.error().message();
  EXPECT_EQ(rgb->width_px, 128);
  EXPECT_EQ(rgb->height_px, 2);
  EXPECT_EQ(rgb->note, "");
  for (std::size_t k = 0; k < 256; ++k) EXPECT_NEAR(rgb->rgb[3 * k], linear(double(k) / 255), 1e-7) << k;
  EXPECT_EQ(rgb->rgb[1], 0);
  EXPECT_EQ(rgb->rgb[2], 1);

  const auto grey = read_texture(png("grey.png", 2, 1, 8, PNG_COLOR_TYPE_GRAY, {0, 188}));
  ASSERT_TRUE(grey) << grey.error().message();
  const auto shade = FloatNear(static_cast<float>(linear(188 / 255.0)), 1e-6F);
  EXPECT_THAT(grey->rgb, ElementsAre(0, 0, 0, shade, shade, shade));

  const auto few = read_texture(png("bits.png", 8, 1, 1, PNG_COLOR_TYPE_GRAY, {0x81}));
  ASSERT_TRUE(few) << few.error().message();
  EXPECT_EQ(few->rgb[0] + few->rgb[21], 2);
  EXPECT_EQ(few->rgb[3], 0);

  const auto clear = read_texture(png("rgba.png", 1, 1, 8, PNG_COLOR_TYPE_RGBA, {255, 188, 0, 0}));
  ASSERT_TRUE(clear) << clear.error().message();
  EXPECT_THAT(clear->rgb, ElementsAre(1, shade, 0)) << "alpha changes nothing";
  EXPECT_EQ(clear->note, "its alpha is not shown");
}

TEST_F(TextureTest, PngOfSixteenBitsIsSrgbToo) {
  std::vector<unsigned char> samples;
  for (unsigned k = 0; k < 256; ++k)
    for (unsigned c = 0; c < 3; ++c) {
      samples.push_back(static_cast<unsigned char>(k));
      samples.push_back(static_cast<unsigned char>(c * 100));
    }
  const auto rgb = read_texture(png("rgb.png", 256, 1, 16, PNG_COLOR_TYPE_RGB, samples));
  ASSERT_TRUE(rgb) << rgb.error().message();
  for (std::size_t k = 0; k < 256; ++k)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(rgb->rgb[3 * k + c], linear(double(256 * k + 100 * c) / 65535), 1e-7) << k;
}

TEST_F(TextureTest, AGammaOfItsOwnCounts) {
  const auto value = [&](double gamma) {
    return read_texture(png("g.png", 1, 1, 8, PNG_COLOR_TYPE_GRAY, {51}, gamma))->rgb[0];
  };
  EXPECT_NEAR(value(1), 0.2, 1e-7);
  EXPECT_NEAR(value(0.5), 0.04, 1e-7);
  EXPECT_NEAR(value(0.45455), linear(0.2), 1e-7) << "what sRGB files give beside it";
}

TEST_F(TextureTest, ExrIsLinear) {
  const auto texture = read_texture(exr("a.exr", 2, 2, {0, 0.5F, 1, 0.25F, 2, 0, 1, 1, 1, 0.125F, 0, 0.75F}));
  ASSERT_TRUE(texture) << texture.error().message();
  EXPECT_THAT(texture->rgb, ElementsAre(0, 0.5F, 1, 0.25F, 2, 0, 1, 1, 1, 0.125F, 0, 0.75F));
  EXPECT_THAT(error_of(exr("nan.exr", 2, 1, {0, 0, 0, 0, NAN, 0})), HasSubstr("nan.exr: pixel 1 is negative or not"));
  EXPECT_THAT(error_of(exr("low.exr", 1, 1, {0, -1, 0})), HasSubstr("low.exr: pixel 0 is negative"));

  // Grey of half floats.
  {
    Imf::RgbaOutputFile out((folder_ / "y.exr").c_str(), 2, 1, Imf::WRITE_Y);
    const Imf::Rgba pixels[2] = {{0.5F, 0.5F, 0.5F}, {2, 2, 2}};
    out.setFrameBuffer(pixels, 1, 2);
    out.writePixels(1);
  }
  const auto grey = read_texture(folder_ / "y.exr");
  ASSERT_TRUE(grey) << grey.error().message();
  EXPECT_THAT(grey->rgb, ElementsAre(0.5F, 0.5F, 0.5F, 2, 2, 2));
}

TEST_F(TextureTest, AnExrIsAsLargeAsItsDisplayWindow) {
  const auto write_windows = [&](const Imath::Box2i& data, const Imath::Box2i& display, bool tiled) {
    support::ExrFile file(1, 1);
    file.data_window = data;
    file.display_window = display;
    file.tiled = tiled;
    for (const char* name : {"R", "G", "B"}) {
      file.channels[name] = Imf::FLOAT;
      for (int y = data.min.y; y <= data.max.y; ++y)
        for (int x = data.min.x; x <= data.max.x; ++x)
          file.pixels[name].push_back(static_cast<float>(100 + 10 * y + x) + (name[0] == 'G' ? 0.5F : 0));
    }
    file.write(folder_ / "a.exr");
    return folder_ / "a.exr";
  };
  const Imath::Box2i display({-1, 2}, {4, 5});
  // The same; cropped to what it shows; beyond it on all sides; both.
  for (const auto& [data, note] : {std::pair(display, ""),
                                   {Imath::Box2i({1, 3}, {3, 4}), "it is black where its data window ends before"},
                                   {Imath::Box2i({-4, 0}, {6, 9}), ""},
                                   {Imath::Box2i({2, -3}, {9, 3}), "it is black where"}})
    for (const bool tiled : {false, true}) {
      const auto texture = read_texture(write_windows(data, display, tiled));
      ASSERT_TRUE(texture) << texture.error().message();
      ASSERT_EQ(texture->width_px, 6);
      ASSERT_EQ(texture->height_px, 4);
      EXPECT_THAT(texture->note, StartsWith(note));
      EXPECT_EQ(texture->note.empty(), std::string_view(note).empty());
      for (int y = 2; y <= 5; ++y)
        for (int x = -1; x <= 4; ++x) {
          const auto at = static_cast<std::size_t>(3 * ((y - 2) * 6 + x + 1));
          const float there = data.intersects(Imath::V2i(x, y)) ? static_cast<float>(100 + 10 * y + x) : 0;
          EXPECT_EQ(texture->rgb[at], there) << x << ' ' << y;
          EXPECT_EQ(texture->rgb[at + 1], there > 0 ? there + 0.5F : 0) << x << ' ' << y;
        }
    }
  EXPECT_THAT(error_of(write_windows({{5, 2}, {6, 5}}, display, false)),
              HasSubstr("a.exr: has its data window outside of its display window"));
  EXPECT_THAT(error_of(write_windows({{0, 0}, {1, 1}}, {{0, 0}, {9, 9}}, false), 99),
              HasSubstr("a texture of 10 x 10 pixels is more than"));
  EXPECT_THAT(error_of(write_windows({{0, 0}, {9, 9}}, {{0, 0}, {1, 1}}, false), 99),
              HasSubstr("a texture of 10 x 10 pixels is more than"));
  EXPECT_THAT(error_of(write_windows({{1 << 20, 0}, {1 << 20, 1}}, {{(1 << 20) + 1, 0}, {(1 << 20) + 1, 0}}, false)),
              HasSubstr("has its display window too far"));
}

TEST_F(TextureTest, BrokenAndLargeFilesAreRefusedByName) {
  const std::string good =
      bytes_of(png("good.png", 40, 40, 8, PNG_COLOR_TYPE_GRAY, std::vector<unsigned char>(1600, 9)));
  for (const std::size_t length : {9UL, 30UL, good.size() / 2, good.size() - 14})
    EXPECT_THAT(error_of(write("cut.png", good.substr(0, length))), HasSubstr("cut.png: libpng says: ")) << length;
  const std::string linear = bytes_of(exr("good.exr", 30, 30, std::vector<float>(2700, 0.5F)));
  for (const std::size_t length : {4UL, 12UL, 200UL, linear.size() - 20})
    EXPECT_THAT(error_of(write("cut.exr", linear.substr(0, length))),
                AllOf(HasSubstr("cut.exr: "), Not(HasSubstr("(string)")), Not(HasSubstr(".;"))))
        << length;
  EXPECT_THAT(error_of(folder_ / "good.png", 1599), HasSubstr("good.png: a texture of 40 x 40 pixels is more than"));
  EXPECT_THAT(error_of(folder_ / "good.exr", 899), HasSubstr("good.exr: a texture of 30 x 30 pixels is more than"));
  EXPECT_EQ(error_of(folder_ / "good.png", 1600), "");
  EXPECT_THAT(error_of(png("long.png", 16385, 1, 1, PNG_COLOR_TYPE_GRAY, std::vector<unsigned char>(2100))),
              HasSubstr("long.png: a texture of 16385 x 1 pixels"));
  EXPECT_THAT(error_of(write("a.jpg", "\xff\xd8\xff\xe0 and so on")), HasSubstr("a.jpg: is neither PNG nor OpenEXR"));
}

TEST_F(TextureTest, MapKdIsReadOnceAndMultipliedByKd) {
  png("a.png", 1, 1, 8, PNG_COLOR_TYPE_GRAY, {188});
  auto read = mesh("Kd 0.5 0.25 1\nmap_Kd a.png\nnewmtl b\nmap_Kd a.png\nnewmtl c\nKd 0 0 0\nmap_Kd a.png\n");
  ASSERT_TRUE(read) << read.error().message();
  ASSERT_EQ(read->textures.size(), 1U);
  for (const Material& m : read->materials) EXPECT_EQ(m.texture, 0U) << m.name;
  EXPECT_THAT(read->materials[0].diffuse, ElementsAre(0.5F, 0.25F, 1));
  EXPECT_THAT(read->materials[1].diffuse, ElementsAre(1, 1, 1)) << "without a Kd";
  EXPECT_THAT(read->materials[2].diffuse, ElementsAre(1, 1, 1));
  EXPECT_THAT(read->notes, ElementsAre("material \"c\": its Kd is 0 beside a texture, which shows as it is"));
  EXPECT_EQ(read->vertices[1].uv, (std::array{2.0F, 0.0F}));
  EXPECT_EQ(read->vertices[2].uv, (std::array{0.0F, -1.5F}));
}

TEST_F(TextureTest, WhatOfMapKdIsNotShownIsNoted) {
  write("a.jpg", "\xff\xd8\xff\xe0 and so on");
  fs::create_directory(folder_ / "maps");
  png("maps/b.png", 1, 1, 8, PNG_COLOR_TYPE_RGBA, {1, 2, 3, 4});
  const auto notes = [&](const std::string& map, bool shown) {
    const auto read = mesh("Kd 0.5 0.25 1\nmap_Kd " + map + "\n");
    if (!read) return std::vector{read.error().message()};
    EXPECT_EQ(read->materials[0].texture.has_value(), shown) << map;
    EXPECT_THAT(read->materials[0].diffuse, ElementsAre(0.5F, 0.25F, 1));
    return read->notes;
  };
  EXPECT_THAT(notes("a.jpg", false), ElementsAre(HasSubstr("a.jpg (map_Kd) is neither PNG nor OpenEXR; its plain")));
  EXPECT_THAT(notes("none.png", false), ElementsAre(HasSubstr("none.png (map_Kd) is missing")));
  EXPECT_THAT(notes("../a.png", false), ElementsAre(HasSubstr("../a.png (map_Kd) is not in the mesh's folder")));
  EXPECT_THAT(notes("/etc/passwd", false), ElementsAre(HasSubstr("is not in the mesh's folder")));
  EXPECT_THAT(notes("maps\\b.png", true), ElementsAre(HasSubstr("b.png: its alpha is not shown")));
  EXPECT_THAT(notes("-s 2 2 1 maps/b.png", true), Contains(HasSubstr("the options of its texture (map_Kd)")));
  write("c.png", "\x89PNG\r\n\x1a\n and no more");
  EXPECT_THAT(notes("c.png", false), ElementsAre(HasSubstr("c.png: libpng says")));

  write("a.mtl", "newmtl a\nmap_Kd maps/b.png\n");
  const auto bare = read_mesh(write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"));
  ASSERT_TRUE(bare);
  EXPECT_THAT(bare->notes, Contains(HasSubstr("1 triangles of textured materials have no texture coordinates")));
}

}  // namespace
}  // namespace lumifield
